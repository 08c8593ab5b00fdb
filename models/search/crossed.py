"""Idle moves over parts that are out, as the search reads them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem
from .compiled import compiled

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class Crossed(NamedTuple):
    """Rows sorted by move: those of moves that leave site a lie at `first[a]` … `first[a + 1] - 1`, sorted by `reach`.

    Such a move costs `cost` (unlawful if negative) once contour `over` is cut; `is_over[i]` says that some move
    crosses contour i.
    """

    first: Ints
    reach: Ints
    over: Ints
    cost: Ints
    is_over: Bools


def make_crossed(problem: Problem) -> Crossed:
    """The crossings of a problem."""
    rows = problem.crossings
    by_move = np.lexsort((rows.over, rows.reach, rows.leave))
    leave = rows.leave[by_move]
    first = np.searchsorted(leave, np.arange(problem.m + 2)).astype(np.int64)
    is_over = np.zeros(problem.n, dtype=np.bool_)
    is_over[rows.over] = True
    return Crossed(first, rows.reach[by_move], rows.over[by_move], rows.cost[by_move], is_over)


@compiled
def crossing(crossed: Crossed, a: int, b: int, position: Ints, at: int) -> tuple[int, int]:
    """Cost, and number of unlawful crossings, of the move from site a to site b made just before position `at`."""
    cost, broken = 0, 0
    for e in range(row_of(crossed, a, b), crossed.first[a + 1]):
        if crossed.reach[e] != b:
            break
        if 0 <= position[crossed.over[e]] < at:
            if crossed.cost[e] < 0:
                broken += 1
            else:
                cost += crossed.cost[e]
    return cost, broken


@compiled
def row_of(crossed: Crossed, a: int, b: int) -> int:
    """The first row of moves from site a to site b, or to a later site if there is none."""
    lo, hi = crossed.first[a], crossed.first[a + 1]
    while lo < hi:
        middle = (lo + hi) // 2
        if crossed.reach[middle] < b:
            lo = middle + 1
        else:
            hi = middle
    return int(lo)
