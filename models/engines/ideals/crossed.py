"""Moves over parts that may be out, as the sweep needs them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.problem.bits import words
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem

from .local import Local
from .over import Over, nothing_over

HOME = -1
UNLAWFUL = 1 << 48
"""What an unlawful move costs: more than any plan, and sums of it still fit."""


def cross(problem: Problem, local: Local, earlier: frozenset[int], rows: Ints, travel: Ints) -> Over:
    """What moves of a stretch cost for those of its contours that are out and that they cross.

    What parts cut `earlier` cost, and the contour that a move leaves, is settled, and added to `travel` at once. `rows`
    are the sites of the rows of `travel` (`HOME` for home), its columns the sites of the stretch.
    """
    crossings, width = problem.crossings, words(len(local.contours))
    if not len(crossings):
        return nothing_over(width)
    add_settled(problem, earlier, rows, local.sites, travel)
    number = np.full(problem.n, -1, dtype=np.int64)
    number[list(local.contours)] = np.arange(len(local.contours))
    row, column, chosen = _places(problem, rows, local.sites)
    place = number[crossings.over[chosen]]
    inside = (place >= 0) & ~_left_from(problem, chosen)
    place = place[inside]
    moves, at = np.unique(row[inside] * travel.shape[1] + column[inside], return_inverse=True)
    mask = np.zeros((len(moves), width), dtype=np.uint64)
    np.bitwise_or.at(mask, (at, place // 64), np.uint64(1) << (place % 64).astype(np.uint64))
    begin = np.searchsorted(moves, np.arange(travel.size + 1)).astype(np.int64)
    return Over(begin, np.zeros(len(moves), dtype=np.int64), mask, travel.shape[1], crossing_price(problem))


def add_settled(problem: Problem, out: frozenset[int], rows: Ints, columns: Ints, travel: Ints) -> None:
    """Add to `travel` what moves cost for the contours of `out`, cut before all of them, and those that they leave."""
    if not len(problem.crossings):
        return
    is_out = np.zeros(problem.n, dtype=np.bool_)
    is_out[list(out)] = True
    row, column, chosen = _places(problem, rows, columns)
    settled = is_out[problem.crossings.over[chosen]] | _left_from(problem, chosen)
    np.add.at(travel, (row[settled], column[settled]), crossing_price(problem))


def one_price(problem: Problem) -> bool:
    """Whether a move pays the same for every contour that it crosses: not twice where two statements are of one."""
    rows = problem.crossings
    if not len(rows):
        return True
    if not (rows.cost == rows.cost[0]).all():
        return False
    if rows.cost[0] == FORBIDDEN:
        return True
    chosen = np.flatnonzero(~_left_from(problem, np.arange(len(rows))))
    over, statement = rows.over[chosen], rows.statement[chosen]
    of_contour = np.full(problem.n, -1, dtype=np.int64)
    of_contour[over] = statement
    return bool((of_contour[over] == statement).all())


def _left_from(problem: Problem, chosen: Ints) -> NDArray[np.bool_]:
    """Which crossings are over a contour that the move itself leaves, as what was out from the start is said."""
    rows = problem.crossings
    owner = np.append(problem.site_contour, problem.n)
    return np.asarray(owner[rows.leave[chosen]] == rows.over[chosen])


def crossing_price(problem: Problem) -> int:
    """What crossing one contour costs."""
    if not len(problem.crossings):
        return 0
    cost = int(problem.crossings.cost[0])
    return UNLAWFUL if cost == FORBIDDEN else cost


def _places(problem: Problem, rows: Ints, columns: Ints) -> tuple[Ints, Ints, Ints]:
    """Row, column and number of every crossing between sites that are there."""
    row_of = np.full(problem.m + 1, -1, dtype=np.int64)
    column_of = row_of.copy()
    row_of[np.where(rows == HOME, problem.m, rows)] = np.arange(len(rows))
    column_of[np.where(columns == HOME, problem.m, columns)] = np.arange(len(columns))
    row, column = row_of[problem.crossings.leave], column_of[problem.crossings.reach]
    chosen = np.flatnonzero((row >= 0) & (column >= 0))
    return row[chosen], column[chosen], chosen
