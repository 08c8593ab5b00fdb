"""Programs in the folder of a batch that earlier runs wrote and that this one does not name."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.contents import is_file

from .files import file_of
from .store import Store


@dataclass(frozen=True, slots=True)
class Left:
    """The program of a nest on a machine; `program` is its path from the index.

    `given` says whether the nest is in this batch, on other machines; `there` whether its file is still there.
    """

    nest: str
    source: str
    machine: str
    program: str
    given: bool
    there: bool

    @property
    def why(self) -> str:
        """Why it is in no row, in a few words."""
        if self.given:
            return "it is not planned on this machine here"
        return "its drawing is not among those that are given" if self.there else "its drawing is gone"


def left_in(store: Store, pieces: Collection[tuple[str, str]]) -> tuple[Left, ...]:
    """What is left, machine by machine; `pieces` are the (machine, nest) of this batch."""
    return tuple(_left(store, pieces))


def _left(store: Store, pieces: Collection[tuple[str, str]]) -> Iterator[Left]:
    nests = {nest for _, nest in pieces}
    for row in store.rows():
        program = file_of(row, ".nc")
        if (row.machine, row.nest) not in pieces and program and is_file(store.out / program):
            there = is_file(Path(row.source))
            yield Left(row.nest, row.source, row.machine, program, row.nest in nests, there)


def tidy(store: Store, pieces: Collection[tuple[str, str]]) -> int:
    """Remove what earlier runs wrote of nests that are not in this batch; how many programs that were.

    A file that somebody has changed since stays, and so do programs of nests that are in it, for other machines.

    Raises
    ------
    InputError
        If a file cannot be removed.
    """
    nests = {nest for _, nest in pieces}
    return sum(store.forget(row) for row in store.rows() if row.nest not in nests)
