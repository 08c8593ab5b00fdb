"""Moves over parts that are out, as crossings between pieces and as conditions on what a piece moves over."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.encoder.ranges import laid_out
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings, in_order
from kerfwise.models.problem.problem import Problem

from .asked import ABOUT
from .pieces import Pieces


class CrossedBy:
    """The crossings of one problem."""

    def __init__(self, problem: Problem) -> None:
        rows = problem.crossings
        self._m = problem.m
        by_move = in_order(rows.moves(problem.m))
        self._rows = rows if by_move is None else rows.only(by_move)
        self._move = self._rows.moves(problem.m)
        self._from = np.searchsorted(self._rows.leave, np.arange(problem.m + 2))

    def between(self, pieces: Pieces) -> Crossings:
        """Crossings of the moves from piece to piece."""
        if not len(self._rows):
            return self._rows
        leaves = np.append(pieces.tails, self._m)
        chosen = laid_out(self._from[leaves], self._from[leaves + 1] - self._from[leaves])
        chosen = chosen[pieces.new_site[self._rows.reach[chosen]] >= 0]
        rows = self._rows.only(chosen)
        found = Crossings(
            pieces.new_tail[rows.leave],
            pieces.new_site[rows.reach],
            pieces.of_contour[rows.over],
            rows.cost,
            rows.statement,
        )
        piece = np.append(pieces.site_piece, -1)
        return found.only((piece[found.leave] != piece[found.reach]) | (piece[found.leave] < 0))

    def within(self, pieces: Pieces, before: Bools) -> list[Condition]:
        """What the moves within pieces cost for what may be out before: conditions on the piece."""
        if not len(self._rows):
            return []
        route = pieces.whole_route
        piece = pieces.of_contour[pieces.order]
        inner = np.flatnonzero(piece[1:] == piece[:-1])
        move = route[inner] * (self._m + 1) + route[inner + 1]
        low, high = (np.searchsorted(self._move, move, side=side) for side in ("left", "right"))
        here, rows = np.repeat(piece[inner], high - low), laid_out(low, high - low)
        other, cost = pieces.of_contour[self._rows.over[rows]], self._rows.cost[rows]
        unsure = (other != here) & ~before[other, here] & ~before[here, other]
        return [
            Condition(p, (q,), (-1,), 0, ABOUT, cost=None if c == FORBIDDEN else c)
            for p, q, c in zip(here[unsure].tolist(), other[unsure].tolist(), cost[unsure].tolist(), strict=True)
        ]
