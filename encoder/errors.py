"""The one family of errors that kerfwise raises on purpose.

The command line turns an `InputError` into one message and exit code 2, a `RulesConflict` into exit code 1, and
whatever else is raised into a report and exit code 70.
"""

from __future__ import annotations

from pathlib import Path

from .shown import shown

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
        place = ":".join(shown(str(p)) or "''" for p in (self.file, self.line, self.column) if p is not None)
        head = f"{place}: {shown(self.message)}" if place else shown(self.message)
        listed = [f"  - {shown(d)}" for d in self.details[:MOST_DETAILS]]
        rest = len(self.details) - len(listed)
        return "\n".join([head, *listed, *([f"  … and {rest} more"] if rest else [])])


class RulesConflict(KerfwiseError):
    """The hard rules cannot all hold; `reasons` names the statements that clash, a sentence each."""

    def __init__(self, message: str, reasons: tuple[str, ...] = ()) -> None:
        self.message, self.reasons = message, reasons
        super().__init__("\n".join([shown(message), *(f"  - {shown(r)}" for r in reasons)]))


class Advice(UserWarning):
    """Something a user should know that changes no result; the command line shows it as a note."""
