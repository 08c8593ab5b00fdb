"""Building an order step by step, always knowing what may lawfully be cut next."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import EXEMPTION_MM

_EXCUSE_UM = round(EXEMPTION_MM * UM_PER_MM)


class Walk:
    """A route that grows; `options` are the sites that keep every hard statement which the sets cut so far decide.

    A walk may end where nothing lawful is left though contours are: then it must begin again.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.route: list[int] = []
        self._done: set[int] = set()
        self._waits = problem.before.sum(axis=0).astype(np.int64)
        self._of: dict[int, list[Condition]] = defaultdict(list)
        for condition in problem.conditions:
            if condition.cost is None or condition.cost >= _EXCUSE_UM:
                self._of[condition.contour].append(condition)
        self._apart = {frozenset((lag.first, lag.second)) for lag in problem.lags if lag.weight is None and lag.cuts}

    @property
    def finished(self) -> bool:
        """Whether every contour has its place."""
        return len(self.route) == self.problem.n

    def options(self) -> list[int]:
        """Sites that may come next; those that need an excuse only where there are no others."""
        free: list[int] = []
        excused: list[int] = []
        for contour in self._ready():
            for site in self.problem.sites(contour):
                unmet = [c for c in self._of[contour] if c.when in (None, site) and not c.met(self._done)]
                if any(c.cost is None for c in unmet):
                    continue
                (excused if unmet or self.problem.site_cost[site] >= _EXCUSE_UM else free).append(site)
        return free or excused

    def take(self, site: int) -> None:
        """Cut this one next."""
        contour = int(self.problem.site_contour[site])
        self.route.append(site)
        self._done.add(contour)
        self._waits -= self.problem.before[contour]

    def _ready(self) -> list[int]:
        """Contours whose turn the orders, blocks and lags allow."""
        problem = self.problem
        last = int(problem.site_contour[self.route[-1]]) if self.route else None
        ready = [c for c in range(problem.n) if c not in self._done and self._waits[c] == 0]
        if last is not None:
            block = problem.block[last]
            if any(problem.block[c] == block for c in range(problem.n) if c not in self._done):
                ready = [c for c in ready if problem.block[c] == block]
            ready = [c for c in ready if frozenset((last, c)) not in self._apart]
        return ready
