"""Whose fault an exception is, where that is known: an exception in a rule carries the rule's name and its line."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import wraps
from pathlib import Path
from types import GeneratorType, TracebackType
from typing import Any

from .errors import InputError, KerfwiseError

IN_RULE = "in rule "
LONGEST = 300
"""Characters that are shown of what an exception says."""


class RuleFault(InputError):
    """A rule that a plant has brought has gone wrong: its author is to mend it. The exception itself is the cause."""


class Naming:
    """A block in which a rule is at work: exceptions that nobody foresaw say which, and where in its file.

    An exception in a rule of the catalogue is left as it is, with a note. One in a rule `brought` from
    outside becomes a `RuleFault`.
    """

    def __init__(self, rule: str, brought: str, file: str, hook: str) -> None:
        self.rule, self.brought, self.file, self.hook = rule, brought, file, hook

    def __enter__(self) -> None:
        """Nothing is to be made ready."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if not isinstance(error, Exception | SystemExit) or isinstance(error, KerfwiseError):
            return
        line = line_in(self.file, at)
        if self.brought:
            message = f"rule {self.rule}{by(self.brought)} fails in {self.hook}: {said(error)}"
            raise RuleFault(message, file=self.file or None, line=line) from error
        if isinstance(error, Exception) and rule_of(error) is None:
            error.add_note(f"{IN_RULE}{self.rule}{f' ({Path(self.file).name}, line {line})' if line else ''}")


def by(brought: str) -> str:
    """Who has brought a rule, for a message that names its file already."""
    return "" if brought.startswith("file ") else f" ({brought})"


def said(error: BaseException) -> str:
    """The kind of an exception and what it says, in one line."""
    text = " ".join(str(error).split())
    return type(error).__name__ + (f": {text[:LONGEST]}" if text else "")


def line_in(file: str, at: TracebackType | None) -> int | None:
    """The line of a file where an exception left it for the last time; None where it was never there."""
    line = None
    while at is not None:
        if at.tb_frame.f_code.co_filename == file:
            line = at.tb_lineno
        at = at.tb_next
    return line


def naming_the_rule(hook: Callable[..., Any]) -> Callable[..., Any]:
    """The method of a rule, with the rule's `id` in whatever it, or the iterator that it gives, raises unforeseen."""

    @wraps(hook)
    def named(self: Any, *args: Any, **options: Any) -> Any:
        try:
            given = hook(self, *args, **options)
        except BaseException:  # asked for a million times, and mostly well
            with at_work(self, hook.__name__):
                raise
        return _watched(given, at_work(self, hook.__name__)) if isinstance(given, GeneratorType) else given

    return named


def at_work(rule: Any, hook: str) -> Naming:
    """The block for something that a rule does."""
    return Naming(rule.id, rule.brought, file_of(type(rule)), hook)


def file_of(cls: type) -> str:
    """The file that a class stands in; "" where it has none."""
    return getattr(sys.modules.get(cls.__module__), "__file__", None) or ""


def _watched(given: Iterator[Any], naming: Naming) -> Iterator[Any]:
    with naming:
        yield from given


def rule_of(error: BaseException) -> str | None:
    """The rule that was at work when an exception was raised, and the line; None where none was."""
    found = (note.removeprefix(IN_RULE) for note in getattr(error, "__notes__", ()) if note.startswith(IN_RULE))
    return next(found, None)
