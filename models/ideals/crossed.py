"""Moves over parts that may be out, as the sweep needs them: a mask of contours for every move of a stretch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..crossings import FORBIDDEN
from ..problem import Problem
from .local import Floats, Ints, Local, Masks

HOME = -1


@dataclass(frozen=True, eq=False, slots=True)
class Crossed:
    """`mask[r, c]`: the contours of the stretch that the move from row r to column c crosses; each costs `price`.

    No rows at all where nothing is crossed.
    """

    mask: Masks
    price: float

    def cost(self, rows: Ints, column: int, ideal: int) -> Floats:
        """What the moves from `rows` to `column` cost when the contours of `ideal` are out."""
        if not len(self.mask):
            return np.zeros(len(rows))
        out = self.mask[rows, column] & np.uint64(ideal)
        count: Floats = np.bitwise_count(out).astype(np.float64)
        count[count > 0] *= self.price
        return count


def cross(problem: Problem, local: Local, earlier: frozenset[int], rows: Ints, travel: Floats) -> Crossed:
    """The masks of a stretch; what parts cut `earlier` cost is settled, and added to `travel` at once.

    `rows` are the sites of the rows of `travel` (`HOME` for home), its columns the sites of the stretch.
    """
    crossings = problem.crossings
    if not len(crossings):
        return Crossed(np.zeros((0, 0), dtype=np.uint64), 0.0)
    add_settled(problem, earlier, rows, local.sites, travel)
    mask = np.zeros(travel.shape, dtype=np.uint64)
    number = np.full(problem.n, -1, dtype=np.int64)
    number[list(local.contours)] = np.arange(len(local.contours))
    row, column, chosen = _places(problem, rows, local.sites)
    bit = number[crossings.over[chosen]]
    inside = bit >= 0
    np.bitwise_or.at(mask, (row[inside], column[inside]), np.uint64(1) << bit[inside].astype(np.uint64))
    return Crossed(mask, _price(problem))


def add_settled(problem: Problem, out: frozenset[int], rows: Ints, columns: Ints, travel: Floats) -> None:
    """Add to `travel` what the moves cost for the contours of `out`, which are cut before all of them."""
    if not len(problem.crossings):
        return
    is_out = np.zeros(problem.n, dtype=np.bool_)
    is_out[list(out)] = True
    row, column, chosen = _places(problem, rows, columns)
    settled = is_out[problem.crossings.over[chosen]]
    np.add.at(travel, (row[settled], column[settled]), _price(problem))


def _price(problem: Problem) -> float:
    cost = int(problem.crossings.cost[0])
    return np.inf if cost == FORBIDDEN else float(cost)


def _places(problem: Problem, rows: Ints, columns: Ints) -> tuple[Ints, Ints, Ints]:
    """Row, column and number of every crossing between sites that are there."""
    row_of = np.full(problem.m + 1, -1, dtype=np.int64)
    column_of = row_of.copy()
    row_of[np.where(rows == HOME, problem.m, rows)] = np.arange(len(rows))
    column_of[np.where(columns == HOME, problem.m, columns)] = np.arange(len(columns))
    row, column = row_of[problem.crossings.leave], column_of[problem.crossings.reach]
    chosen = np.flatnonzero((row >= 0) & (column >= 0))
    return row[chosen], column[chosen], chosen
