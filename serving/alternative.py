"""One plan of a session's history, with all that it was made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .packed import Packed
from .wanted import Wanted


@dataclass(frozen=True, slots=True)
class Alternative:
    """A plan that was made, and what it was made of.

    `sha256` is that of the nest's file. `files` are the plan's files by name, as `kerfwise solve` writes them; those
    of the plan and the program are called `plan_file` and `program_file`. `page` is what the page shows of it, as JSON;
    `figures` what a list of plans says of it. `stopped` says that the engines were asked to end: then the command line
    may come further. `options` are those of the command line beside what is wanted.
    """

    number: int
    wanted: Wanted
    sha256: str
    files: Mapping[str, Packed]
    plan_file: str
    program_file: str
    page: Packed
    figures: Mapping[str, Any]
    summary: str
    ok: bool
    broken: tuple[str, ...] = ()
    stopped: bool = False
    options: str = ""
    notes: tuple[str, ...] = field(default=())

    @property
    def plan(self) -> str:
        """The plan, as JSON."""
        return self.files[self.plan_file].text()

    @property
    def program(self) -> str:
        """The NC text."""
        return self.files[self.program_file].text()

    @property
    def command(self) -> str:
        """The command line that makes the same files, once its job file is saved."""
        return self.wanted.command(self.options)

    def as_json(self, locks: tuple[str, ...] = ()) -> dict[str, Any]:
        """What a page shows of it in the list of plans."""
        return {
            "number": self.number,
            "figures": dict(self.figures),
            "summary": self.summary,
            "ok": self.ok,
            "broken": list(self.broken),
            "stopped": self.stopped,
            "command": self.command,
            "notes": list(self.notes),
            "locked": list(locks),
            "upto": self.wanted.upto,
        }
