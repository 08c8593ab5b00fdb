"""What every move of a network costs: a table that is worked out some rows at a time, narrow where it is large."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from kerfwise.arrays import Bools, Float32s, Floats, Ints
from kerfwise.models.kernels import cores
from kerfwise.models.problem.problem import Problem

from .moves import Moves
from .passages import Passage, cheapest, through

WIDE = 2000
"""With more sites what moves cost is kept in half the bytes, rounded down."""
ROWS = 100
"""Sites from which all moves are worked out at once."""
TURNS = 4
"""Turns of every thread from one question whether to go on to the next."""


def costs_of(
    problem: Problem, sites: Ints, split: Problem, sooner: Bools, later: Bools, inside: Inside, go: Callable[[], bool]
) -> Floats | Float32s:  # fmt: skip
    """What every move costs, as `Network` says.

    `sites` are those of the problem that the sites of the `split` one stand for. Where these are of the last contour of
    a block with ways `inside`, a move leads to some site of it. `go` is asked now and then.
    """
    m, moves = split.m, Moves(problem)
    cost = empty_costs(m)
    ends, charged = np.append(sites, problem.m), np.append(split.site_cost, 0)
    lawful, kind = _lawful(split.site_contour, sooner, later)

    def work_out(start: int) -> None:
        rows = np.arange(start, min(start + ROWS, m + 1))
        part = moves.between(ends[rows], ends) + charged
        inside.come_through(moves.between(ends[rows], inside.inner), part)
        part[~lawful[kind[rows]][:, kind]] = np.inf
        cost[rows] = part
        if cost.dtype != part.dtype and (above := cost[rows] > part).any():
            cost[rows] = np.where(above, np.nextafter(cost[rows], np.float32(-np.inf)), cost[rows])

    by_threads(work_out, range(0, m + 1, ROWS), go)
    return cost


class Inside:
    """Ways through the blocks that their last contours stand for, to the sites of these.

    `inner` (k,) are the sites of all the contours before the last ones. `ways` are of every such block: where its own
    are in `inner`, which sites its last contour has, and what it costs from the cut at the ones to that at the others.
    """

    def __init__(self, problem: Problem, sites: Ints, charged: Ints, passages: Sequence[Passage]) -> None:
        moves, owner = Moves(problem), problem.site_contour[sites]
        self.inner: Ints = np.zeros(0, dtype=np.int64)
        if passages:
            self.inner = problem.sites_of(np.concatenate([passage.inner for passage in passages]))
        self.ways: list[tuple[slice, Ints, Floats]] = []
        began = 0
        for passage in passages:
            here = np.flatnonzero(owner == passage.last)
            way = through(problem, passage, moves, sites[here], charged[here].astype(np.float64))
            self.ways.append((slice(began, began + len(way)), here, way))
            began += len(way)

    def come_through(self, entered: Floats, part: Floats) -> None:
        """Put into `part` (rows, sites) what it costs to come to last contours; `entered` (rows, k) to those inside."""
        for some, here, way in self.ways:
            part[:, here] = cheapest(entered[:, some], way)


class Stopped(Exception):
    """There is no time left for what was begun."""


def by_threads(work_out: Callable[[int], None], starts: Sequence[int], go: Callable[[], bool]) -> None:
    """Call it for all of these, on all cores.

    Raises
    ------
    Stopped
        If `go`, asked now and then, says no before the end.
    """
    at_once = TURNS * cores()
    with ThreadPoolExecutor(cores()) as threads:
        for first in range(0, len(starts), at_once):
            if not go():
                raise Stopped
            list(threads.map(work_out, starts[first : first + at_once]))


def empty_costs(m: int) -> Floats | Float32s:
    """A table (m + 1, m + 1) to fill."""
    if m > WIDE:
        return np.empty((m + 1, m + 1), dtype=np.float32)
    return np.empty((m + 1, m + 1), dtype=np.float64)


def _lawful(contours: Ints, sooner: Bools, later: Bools) -> tuple[Bools, Ints]:
    """Which site may follow some: none that is to be out before, or after something that is to be between them.

    Most sites of a contour want the same: the table is that of the kinds of sites, and the kind of each, home last.
    """
    n = sooner.shape[1]
    owner = np.append(contours, n)
    asked = np.concatenate([owner[:, None].view(np.uint8), np.packbits(np.hstack([sooner, later]), axis=1)], axis=1)
    _, of_kind, kind = np.unique(asked, axis=0, return_index=True, return_inverse=True)
    owner, sooner, later = owner[of_kind], sooner[of_kind], later[of_kind]
    home, inside = np.flatnonzero(owner == n), np.flatnonzero(owner < n)
    never: Bools = np.asarray(later.astype(np.float32) @ sooner.astype(np.float32).T > 0.5)
    never[home] = np.asarray(sooner.any(axis=1))
    never[:, home] = np.asarray(later.any(axis=1)).reshape(-1, 1)
    never[:, inside] |= sooner[:, owner[inside]]
    never[inside] |= later[:, owner[inside]].T
    return ~never, kind.reshape(-1)
