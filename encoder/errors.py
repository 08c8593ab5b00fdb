"""The errors that kerfwise raises on purpose, and whose fault an exception in a rule is."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import wraps
from pathlib import Path
from types import GeneratorType, TracebackType
from typing import Any

from .escape import escape_text

# The command line turns an `InputError` into one message and exit code 2, a `RulesConflict` into exit code 1, and
# whatever else is raised into a report and exit code 70.

REPAIR = "--repair (in Python: repair=True)"
"""The option that mends drawings, as the command line and as Python have it."""
MOST_DETAILS = 20
"""Lines of a list that are shown; one cause makes hundreds of the same."""


class KerfwiseError(Exception):
    """Base class of every error that kerfwise raises on purpose."""


class InputError(KerfwiseError):
    """Something a person gave (a nest, a profile, an option) cannot be used.

    Parameters
    ----------
    message
        What was given, what was expected and what to do, in one or two sentences.
    file, line, column
        Where it stands, where known (line and column count from 1).
    details
        One line each, for lists such as every open end of a drawing; the message shows the first `MOST_DETAILS`.

    Examples
    --------
    >>> str(InputError("unknown rule 'levelahead'", file="plant.yaml", line=7, column=3))
    "plant.yaml:7:3: unknown rule 'levelahead'"
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        column: int | None = None,
        details: tuple[str, ...] = (),
    ) -> None:
        self.message, self.file, self.line, self.column, self.details = message, file, line, column, details
        super().__init__(self._text())

    def _text(self) -> str:
        place = ":".join(escape_text(str(p)) or "''" for p in (self.file, self.line, self.column) if p is not None)
        head = f"{place}: {escape_text(self.message)}" if place else escape_text(self.message)
        listed = [f"  - {escape_text(d)}" for d in self.details[:MOST_DETAILS]]
        rest = len(self.details) - len(listed)
        return "\n".join([head, *listed, *([f"  … and {rest} more"] if rest else [])])


class RulesConflict(KerfwiseError):
    """The hard rules cannot all hold; `reasons` names the statements that clash, a sentence each.

    It is `proven` where an engine has shown that no plan exists.
    """

    def __init__(self, message: str, reasons: tuple[str, ...] = (), *, proven: bool = False) -> None:
        self.message, self.reasons, self.proven = message, reasons, proven
        super().__init__("\n".join([escape_text(message), *(f"  - {escape_text(r)}" for r in reasons)]))


class Advice(UserWarning):
    """Something a user should know that changes no result; the command line shows it as a note."""


# Whose fault an exception is, where that is known: an exception in a rule carries the rule's name and its line.

IN_RULE = "in rule "
LONGEST = 300
"""Characters that are shown of what an exception says."""


class RuleFault(InputError):
    """A rule that a plant has brought has gone wrong: its author is to mend it. The exception itself is the cause."""


class ToolFault(InputError):
    """A program that kerfwise calls is missing or does not work, whatever the nest is."""


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
            message = f"rule {self.rule}{brought_by(self.brought)} fails in {self.hook}: {exception_text(error)}"
            raise RuleFault(message, file=self.file or None, line=line) from error
        if isinstance(error, Exception) and rule_of(error) is None:
            error.add_note(f"{IN_RULE}{self.rule}{f' ({Path(self.file).name}, line {line})' if line else ''}")


def brought_by(brought: str) -> str:
    """Who has brought a rule, for a message that names its file already."""
    return "" if brought.startswith("file ") else f" ({brought})"


def exception_text(error: BaseException) -> str:
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
            result = hook(self, *args, **options)
        except BaseException:  # asked for a million times, and mostly well
            with rule_hook(self, hook.__name__):
                raise
        return _watched(result, rule_hook(self, hook.__name__)) if isinstance(result, GeneratorType) else result

    return named


def rule_hook(rule: Any, hook: str) -> Naming:
    """The block for something that a rule does."""
    return Naming(rule.id, rule.brought, file_of(type(rule)), hook)


def file_of(cls: type) -> str:
    """The file that a class stands in; "" where it has none."""
    return getattr(sys.modules.get(cls.__module__), "__file__", None) or ""


def _watched(iterator: Iterator[Any], naming: Naming) -> Iterator[Any]:
    with naming:
        yield from iterator


def rule_of(error: BaseException) -> str | None:
    """The rule that was at work when an exception was raised, and the line; None where none was."""
    found = (note.removeprefix(IN_RULE) for note in getattr(error, "__notes__", ()) if note.startswith(IN_RULE))
    return next(found, None)
