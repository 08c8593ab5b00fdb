"""Several torches in the simulation: what they burn at one time is burnt one after the other, in every order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from kerfwise.tests.metal.program import Path, Program, UnreadableProgram


def every_order(program: Program, torches: Sequence[tuple[float, float]]) -> Iterator[Program]:
    """The program as if one torch made all: the places of each torch's path among those of one time change.

    `torches` is where each stands, as the first sees it, mm; the first burns always.

    Raises
    ------
    UnreadableProgram
        If it selects a torch that is not there, or marks with one that is selected.
    """
    for path in program.paths:
        if any(torch > len(torches) for torch in path.torches) or (path.torches and not path.burns):
            raise UnreadableProgram(f"line {path.line}: torches {sorted(path.torches)} are selected")
    most = max(len(path.torches) for path in program.paths) + 1
    for order in permutations(range(most)):
        yield replace(program, paths=tuple(one for path in program.paths for one in _paths(path, torches, order)))


def _paths(path: Path, torches: Sequence[tuple[float, float]], order: Sequence[int]) -> Iterator[Path]:
    lit = [1, *sorted(path.torches)]
    for place in order:
        if place < len(lit):
            points = path.points + np.array(torches[lit[place] - 1])
            label = path.label if place == 0 else ""
            yield replace(path, points=points, label=label, torches=frozenset())
