"""A search that can be run, looked at, handed a better route, and run on."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from ..evaluate import broken, route_cost
from ..problem import Problem
from ..solution import Incumbent, Progress
from .anneal import GO_ON, MAKE_ROUTE, TAKE_ROUTE, walk
from .state import BEST, CLIMBS, COST, LENGTH, PRICE, WORK, new_state
from .structs import for_kernels
from .tables import make_tables

WORK_PER_S = 450_000_000  # elementary operations that a second of work stands for
CHUNK = 20_000_000  # operations between two looks at the clock and at whether to stop
FIRST_DESCENT = 200_000  # operations a contour before the first annealing
HOT, COLD = 1.0, 0.01  # temperatures, in typical rises of the cost


class Searcher:
    """Ruin and recreate over one problem.

    Parameters
    ----------
    problem
        What to search.
    seed
        Equal seeds and equal work give equal routes.
    """

    def __init__(self, problem: Problem, seed: int = 1) -> None:
        self._problem = problem
        tables = make_tables(problem)
        self._arrays = new_state(tables, seed)
        self._tables, self._state = for_kernels(tables), for_kernels(self._arrays)
        self._arrays.number[PRICE] = 1
        self._rise = 0.0  # typical rise of the cost by a trial that makes it worse, µm

    @property
    def best(self) -> Incumbent | None:
        """The best lawful route so far, if one is known."""
        if self._problem.n == 0:
            return Incumbent((), route_cost(self._problem, ()))
        cost = int(self._arrays.number[BEST])
        if cost < 0:
            return None
        found = Incumbent(tuple(self._arrays.best.tolist()), cost)
        assert cost == route_cost(self._problem, found.route)
        return found

    def run(
        self, work: float, time_s: float | None = None, progress: Progress | None = None, heat: float = 1.0
    ) -> bool:
        """Anneal once, from the route it stands on.

        Parameters
        ----------
        work
            How long, in seconds of a machine like the one this was measured on, counted in operations.
        time_s
            Wall-clock limit, s; the cooling then follows whichever of the two runs out first.
        progress
            Asked now and then; the search stops when it answers False.
        heat
            Factor on the first temperature: 1 starts afresh from almost anywhere, 0.1 keeps near where it stands.

        Returns
        -------
        bool
            False if it was asked to stop, by `progress` or by an interrupt from the keyboard.
        """
        if self._problem.n == 0:
            return True
        number = self._arrays.number
        started_s, start = time.monotonic(), int(number[WORK])
        budget = max(1, int(work * WORK_PER_S))
        try:
            if self._rise == 0.0:
                self._begin(budget // 4)
            while (spent := int(number[WORK]) - start) < budget:
                if progress is not None and not progress("search", self._best_cost(), None):
                    return False
                speed = 1 / budget
                if time_s is not None:
                    speed = max(speed, (time.monotonic() - started_s) / max(time_s, 1e-9) / max(spent, 1))
                done = speed * spent
                if done >= 1.0:
                    break
                chunk = min(CHUNK, budget - spent)
                self._walk(int(number[WORK]) + chunk, heat, done, min(1.0, done + speed * chunk))
        except KeyboardInterrupt:
            return False
        return True

    def stand_on(self, route: Sequence[int]) -> None:
        """Go on from a lawful route (sites in cutting order) that another engine found.

        Raises
        ------
        ValueError
            If the route breaks a hard statement.
        """
        faults = broken(self._problem, route)
        if faults:
            raise ValueError(f"not a lawful route: {faults[0].sentence}")
        state = self._arrays
        sites = np.asarray(route, dtype=np.int64)
        state.order[:] = self._problem.site_contour[sites]
        state.position[state.order] = np.arange(self._problem.n)
        state.site[state.order] = sites
        walk(self._tables, self._state, TAKE_ROUTE, 0, 1.0, 1.0)

    def _best_cost(self) -> int | None:
        cost = int(self._arrays.number[BEST])
        return cost if cost >= 0 else None

    def _begin(self, most: int) -> None:
        """A first route, improved without going uphill for at most `most` operations, and the scale of its costs."""
        number, n = self._arrays.number, self._problem.n
        if number[LENGTH] == 0:
            walk(self._tables, self._state, MAKE_ROUTE, 0, 1.0, 1.0)
        number[PRICE] = 1 + 10 * int(number[COST]) // n
        until = int(number[WORK]) + min(most, FIRST_DESCENT * n)
        walk(self._tables, self._state, GO_ON, until, 1.0, 1.0)
        rises = self._arrays.climb[: number[CLIMBS]]
        self._rise = max(1.0, float(np.median(rises))) if len(rises) else 1.0

    def _walk(self, until: int, heat: float, done: float, ahead: float) -> None:
        """Walk on while the cooling goes from `done` to `ahead` (shares of the whole)."""
        hot, cold = heat * HOT * self._rise, COLD * self._rise
        fall = min(1.0, cold / hot)
        walk(self._tables, self._state, GO_ON, until, hot * fall**done, hot * fall**ahead)
