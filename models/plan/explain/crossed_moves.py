"""Idle travel over parts that are out, in any order with the entries of a plan: a move is looked up when first met."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.tolerances import GRAZE_UM, UM_PER_MM, cost_um
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About, Crossing

_UNKNOWN, _OVER_NONE, _OVER_SOME = range(3)
"""What is known of a move."""
TIPPED = "no idle travel leads over parts that are out"


class _Rows(NamedTuple):
    """Moves of the plan that lead over a part, a row for each part."""

    leave: Ints
    reach: Ints
    over: Ints
    cost: Ints


class CrossedMoves:
    """What moves between the contours of a plan lead over, hard orders or not.

    `site` has the site of each contour and, last, home; `tipped` is how a plan says what they lead over.
    """

    def __init__(self, problem: Problem, crossing: Sequence[Crossing], site: Ints, order: Sequence[int]) -> None:
        self._crossing = crossing
        self._site, self._home, self._links = site, problem.n, problem.links
        self._over: dict[int, list[tuple[int, int]]] = defaultdict(list)
        known = _UNKNOWN if self._crossing else _OVER_NONE
        self._known = np.full((self._home + 1) ** 2, known, dtype=np.int8)
        self._now: int | None = 0
        self.tipped = About(self._crossing[0].about.rule if self._crossing else "", (), TIPPED)
        if self._crossing:
            self._left, self._reached = problem.ends()[site] / UM_PER_MM, problem.pierces()[site] / UM_PER_MM
            self._areas = shapely.STRtree(shapely.buffer([s.area for s in self._crossing], -GRAZE_UM / UM_PER_MM))
            self._of_plan = np.zeros(len(self._known), dtype=np.bool_)
            self._rows = _Rows(*np.zeros((4, 0), dtype=np.int64))
            along = np.array([self._home, *order, self._home])
            rows = [(along[k], along[k + 1], over, cost) for k, over, cost in self.over(order)]
            self._now = self._cost(order)
            self._rows = _Rows(*np.array(rows, dtype=np.int64).reshape(-1, 4).T)
            self._of_plan[along[:-1] * (self._home + 1) + along[1:]] = True

    def over(self, order: Sequence[int]) -> Iterator[tuple[int, int, int]]:
        """Each move of an order that leads over a part: its place, from 0, the part, cut or not as yet, and the price.

        A part that is out from the start has the number -1. The last move leads home.
        """
        yield from self._over_moves(np.array([self._home, *order, self._home]), np.arange(self._home + 1))

    def _over_moves(self, along: Ints, places: Ints) -> Iterator[tuple[int, int, int]]:
        """The same of some moves of an order that is framed by home."""
        moves = along[places] * (self._home + 1) + along[places + 1]
        if len(new := np.unique(moves[self._known[moves] == _UNKNOWN])):
            self._look_up(new)
        for k in np.flatnonzero(self._known[moves] == _OVER_SOME).tolist():
            for over, cost in self._over[int(moves[k])]:
                yield int(places[k]), over, cost

    def _look_up(self, moves: Ints) -> None:
        """What moves lead over, by number: that of the contour left times those of all, and home, plus the other's."""
        self._known[moves] = _OVER_NONE
        leave, reach = np.divmod(moves, self._home + 1)
        if len(links := self._links):
            idle = np.flatnonzero(links.rows_of(self._site[leave], self._site[reach]) < 0)
            moves, leave, reach = moves[idle], leave[idle], reach[idle]
        lines = shapely.linestrings(np.stack([self._left[leave], self._reached[reach]], axis=1))
        for line, area in self._areas.query(lines, predicate="intersects").T.tolist():
            s = self._crossing[area]
            cost = FORBIDDEN if s.weight is None else cost_um(s.weight)
            self._over[int(moves[line])].append((-1 if s.over is None else s.over, cost))
            self._known[moves[line]] = _OVER_SOME

    def more(self, order: Sequence[int]) -> int | None:
        """What is crossed more than in the plan, µm; None where it may not be."""
        there = self._cost(order) if self._crossing else 0
        return None if there is None else there - (self._now or 0)

    def _cost(self, order: Sequence[int]) -> int | None:
        """What an order crosses: most of its moves are those of the plan, whose rows lie in arrays."""
        home, along = self._home, np.array([self._home, *order, self._home])
        place = np.full(home + 1, -1)  # of what is left
        place[along[1:-1]] = np.arange(home)
        reached = np.append(place[:-1], home)
        at = reached[self._rows.reach]
        paid = (at == place[self._rows.leave] + 1) & ((self._rows.over < 0) | (place[self._rows.over] < at))
        costs = self._rows.cost[paid].tolist()
        new = np.flatnonzero(~self._of_plan[along[:-1] * (home + 1) + along[1:]])
        costs += [cost for k, over, cost in self._over_moves(along, new) if over < 0 or place[over] < k]
        return None if FORBIDDEN in costs else sum(costs)
