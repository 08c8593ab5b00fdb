"""Whose fault an exception is, where that is known: an exception in a rule carries the rule's name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from functools import wraps
from types import TracebackType
from typing import Any

from .errors import KerfwiseError

IN_RULE = "in rule "


class Naming:
    """A block whose exceptions, but those raised on purpose, say in a note that a rule was at work."""

    def __init__(self, rule: str) -> None:
        self.rule = rule

    def __enter__(self) -> None:
        """Nothing is to be made ready."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if isinstance(error, Exception) and not isinstance(error, KerfwiseError) and rule_of(error) is None:
            error.add_note(f"{IN_RULE}{self.rule}")


def naming_the_rule(hook: Callable[..., Any]) -> Callable[..., Any]:
    """The method of a rule, with the rule's `id` in whatever it, or the iterator that it gives, raises unforeseen."""

    @wraps(hook)
    def named(self: Any, *args: Any, **options: Any) -> Any:
        with Naming(self.id):
            given = hook(self, *args, **options)
        return _watched(given, self.id) if inspect.isgenerator(given) else given

    return named


def _watched(given: Iterator[Any], rule: str) -> Iterator[Any]:
    with Naming(rule):
        yield from given


def rule_of(error: BaseException) -> str | None:
    """The rule that was at work when an exception was raised; None where none was."""
    found = (note.removeprefix(IN_RULE) for note in getattr(error, "__notes__", ()) if note.startswith(IN_RULE))
    return next(found, None)
