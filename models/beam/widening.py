"""Runs beams one after the other, each twice as wide as the last."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ..evaluate import route_cost
from ..problem import Problem
from ..solution import Incumbent
from .bound import Bound, least_moves
from .grower import Grower, Spent
from .history import History
from .layer import root
from .purse import Purse
from .tables import Tables, make_tables, travel_table

WORTH_A_RUN = 1.3
"""A run that can only be so much wider than the last is not begun."""
ROUNDING = 1e-3
"""Bounds are sums of doubles, costs whole: what is under the next whole number by less is taken for it."""


class Widening:
    """One run after another, each twice as wide as the last."""

    def __init__(self, problem: Problem, incumbent: Incumbent | None, purse: Purse) -> None:
        self._problem, self._purse = problem, purse
        travel = travel_table(problem)
        self._tables: Tables = make_tables(problem, travel)
        self._bounds: Bound = least_moves(problem, travel)
        self.incumbent = incumbent
        self.bound: int | None = None
        self.proven = False
        self.width = 0

    def run(self, width: int, most: int) -> None:
        """Until proven, or the next run would not be worth it; `Empty` when a limit is reached on the way."""
        with ThreadPoolExecutor(max_workers=1) as threads:
            while not self.proven and self.width < most:
                width, before = min(width, most), self._purse.mark()
                self._one(width, threads)
                self.width = width
                room = self._purse.times(before)
                if room < WORTH_A_RUN:
                    break
                width = math.ceil(width * min(2.0, room))

    def _one(self, width: int, threads: ThreadPoolExecutor) -> None:
        """One run: better routes and bounds are noted, and whether all is proven."""
        tables, n = self._tables, self._problem.n
        limit = math.inf if self.incumbent is None else self.incumbent.cost - 1 + ROUNDING
        grower, spent, history = Grower(tables, self._bounds, width, threads), Spent(), History()
        layer = root(tables, self._bounds)
        while layer.depth < n and len(layer.site):
            paid = spent.operations
            layer, parent = grower.grow(layer, limit, spent)
            history.note(parent, layer.site)
            self._purse.pay(spent.operations - paid, self.incumbent, self.bound)
        if len(layer.site):
            total = layer.value + self._bounds.to_go[0, n, layer.site]
            best = int(np.argmin(total))
            if math.isfinite(total[best]):
                self.incumbent = Incumbent(history.route(best), int(total[best]))
                assert self.incumbent.cost == route_cost(self._problem, self.incumbent.route)
        self._learn(spent.dropped)

    def _learn(self, dropped: float) -> None:
        """`dropped` bounds every route that the run could have missed."""
        best = math.inf if self.incumbent is None else self.incumbent.cost
        self.proven = math.isinf(dropped) or dropped > best - 1 + ROUNDING
        lower = min(best, dropped)
        if math.isfinite(lower):
            self.bound = max(math.ceil(lower - ROUNDING), self.bound or 0)
