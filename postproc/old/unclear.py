"""Burns of which nobody can say what they cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Unclear:
    """A burn of which nobody can say what it cuts: the line, and why."""

    line: int
    why: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.why}"


class NoNest(Exception):
    """The burns of a program make no nest; `unclear` are those at fault."""

    def __init__(self, unclear: Sequence[Unclear]) -> None:
        self.unclear = tuple(unclear)
        super().__init__("; ".join(map(str, unclear)))
