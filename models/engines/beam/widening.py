"""Runs beams one after the other, each twice as wide as the last, at first from both ends."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from kerfwise.models.engines.budget import Budget
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .bound import Bound, least_in_and_out
from .grower import Grower, Spent
from .history import History
from .layer import root
from .reversed_problem import can_reverse, reversed_problem
from .tables import make_beam_tables, travel_table
from .walks import MOST_ROUNDS, priced_walks, walk_operations

OPERATIONS_PER_S = 3e8
WORTH_A_RUN = 1.3
"""A run that can only be so much wider than the last is not begun."""
WORTH_PRICING = 128
"""Width from which on a better bound is worth its price."""
PRICING = 0.1
"""Share of what is left that the better bound may take, from each end."""
SCOUTING = 0.25
"""Share of the work after which only the end of the better bound is gone on with."""
ROUNDING = 1e-3
"""Bounds are sums of doubles, costs whole: what is under the next whole number by less is taken for it."""


class Empty(Exception):
    """A limit is reached."""


class _End:
    """The problem from one end."""

    def __init__(self, problem: Problem, backwards: bool) -> None:
        self.problem, self.backwards = problem, backwards
        self.travel = travel_table(problem)
        self.tables = make_beam_tables(problem, self.travel)
        self.bound = least_in_and_out(problem, self.travel)
        self.priced = False
        self.reached = -math.inf  # bound that its last run has proven

    def price(self, target: int, operations: float, pay: Callable[[int], None]) -> None:
        """Better bounds, aiming at the cost of a plan, for no more than so many operations."""
        self.priced = True
        rounds = int(operations / walk_operations(self.problem, self.travel))
        if rounds >= MOST_ROUNDS // 10:
            better = priced_walks(self.problem, self.travel, self.bound, target, rounds, pay)
            self.bound = Bound(
                np.concatenate([self.bound.to_go, better.to_go]), np.concatenate([self.bound.price, better.price])
            )


class Widening:
    """One run after another, each twice as wide as the last."""

    def __init__(
        self, problem: Problem, incumbent: Incumbent | None, budget: Budget, progress: Progress | None
    ) -> None:
        self._problem, self._budget, self._progress = problem, budget, progress
        self._ends = [_End(problem, False)]
        if can_reverse(problem):
            self._ends.append(_End(reversed_problem(problem), True))
        self.incumbent = incumbent
        self.bound: int | None = None
        self.proven = False
        self.width = 0

    def run(self, width: int, most: int) -> None:
        """Until proven, or the next run would not be worth it; `Empty` when a limit is reached on the way."""
        with ThreadPoolExecutor(max_workers=1) as threads:
            while not self.proven and self.width < most:
                width, before = min(width, most), self._budget.mark()
                for end in self._ends:
                    if width >= WORTH_PRICING and self.incumbent is not None and not end.priced:
                        share = PRICING * max(0.0, 1.0 - self._budget.share_spent)
                        end.price(self.incumbent.cost, share * self._budget.operations, self._pay)
                        before = self._budget.mark()
                    self._one(end, width, threads)
                    if self.proven:
                        break
                self.width = width
                if self._budget.share_spent > SCOUTING:
                    self._ends = [max(self._ends, key=lambda end: end.reached)]
                room = self._budget.times(before)
                if room < WORTH_A_RUN:
                    break
                width = math.ceil(width * min(2.0, room))

    def _one(self, end: _End, width: int, threads: ThreadPoolExecutor) -> None:
        """One run: better routes and bounds are noted, and whether all is proven."""
        n = self._problem.n
        limit = math.inf if self.incumbent is None else self.incumbent.cost - 1 + ROUNDING
        grower, spent, history = Grower(end.tables, end.bound, width, threads), Spent(), History()
        layer = root(end.tables, end.bound)
        while layer.depth < n and len(layer.site):
            paid = spent.operations
            layer, parent = grower.grow(layer, limit, spent)
            history.note(parent, layer.site)
            self._pay(spent.operations - paid, self.incumbent, self.bound)
        if len(layer.site):
            total = layer.value + end.bound.to_go[0, n, layer.site]
            best = int(np.argmin(total))
            if math.isfinite(total[best]):
                route = history.route(best)
                self.incumbent = Incumbent(route[::-1] if end.backwards else route, int(total[best]))
                assert self.incumbent.cost == route_cost(self._problem, self.incumbent.route)
        end.reached = spent.dropped
        self._learn(spent.dropped)

    def _pay(self, operations: int, incumbent: Incumbent | None = None, bound: int | None = None) -> None:
        """Count, tell the listener, and raise `Empty` at a limit."""
        self._budget.spend(operations)
        cost = None if incumbent is None else incumbent.cost
        heard = self._progress is None or self._progress("beam", cost, bound)
        if not heard or self._budget.share_spent >= 1.0:
            raise Empty

    def _learn(self, dropped: float) -> None:
        """`dropped` bounds every route that the run could have missed."""
        best = math.inf if self.incumbent is None else self.incumbent.cost
        self.proven = math.isinf(dropped) or dropped > best - 1 + ROUNDING
        lower = min(best, dropped)
        if math.isfinite(lower):
            self.bound = max(math.ceil(lower - ROUNDING), self.bound or 0)
