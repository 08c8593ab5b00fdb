"""A search that can be run, looked at, handed a better route, and run on."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial
from math import inf
from operator import methodcaller

import numpy as np

from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.kernels import running_s
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem

from .merge import mergeable
from .regions import Regions, regional
from .schedule import CoolingPart, Schedule
from .tables import make_tables
from .tour_merging import CHILD, TourMerging
from .walkers import make_walkers

WORK_PER_S = 450_000_000  # elementary operations that a second of work stands for
CHUNK = 20_000_000  # operations between two looks at the clock and at whether to stop
WALKERS = 2
FIRST = 0.25  # share of the first run that may go into the descent from the first route, and
FIRST_DESCENT = 200_000  # the most operations a contour
REGIONS = 100_000_000  # operations in each half of a route between two such looks, where it goes by regions
WHOLE = 0.5  # share for an annealing of the whole route, where the rest can go region by region, and
WHOLE_MOST = 400_000  # the most operations for it, times n^1.5
FEW, HOTTER = 30, 4.0  # contours up to which annealings are hotter, and how many times: fewer are caught then
LONGER = 1.5  # how much longer than those before it is, or there is none: the rest is better spent on regions


class Searcher:
    """Walkers over one problem, a thread each, with random numbers of their own; the best of what they find.

    Parameters
    ----------
    problem
        What to search.
    seed
        Equal seeds and equal work give equal routes.
    chains
        Whether chains of exchanges are tried where they suit the problem.
    """

    def __init__(self, problem: Problem, seed: int = 1, chains: bool = True) -> None:
        self._problem = problem
        fields = make_tables(problem)
        self._walkers = make_walkers(fields, seed, WALKERS, chains)
        self._merging = TourMerging(problem, self._walkers, seed) if mergeable(problem) else None
        self._regions = Regions(problem, fields, seed) if regional(problem) else None
        self._heat = HOTTER if problem.n <= FEW else 1.0
        self._longest = 0  # annealing of the whole route, in operations

    @property
    def best(self) -> Incumbent | None:
        """The best lawful route so far, if one is known."""
        if self._problem.n == 0:
            return Incumbent((), route_cost(self._problem, ()))
        cost = self._best_cost()
        if cost is None:
            return None
        elite = next(walker.best for walker in self._walkers if walker.cost == cost)
        assert elite is not None
        found = Incumbent(tuple(elite.route.tolist()), cost)
        assert cost == route_cost(self._problem, found.route)
        return found

    def run(self, work: float, time_s: float | None = None, progress: Progress | None = None) -> bool:
        """Anneal, from the routes it stands on, the longer the later; just once where there is little time.

        Parameters
        ----------
        work
            How long, in seconds of a machine like the one this was measured on, counted in each walker's operations.
        time_s
            Wall-clock limit, s; the cooling then follows whichever of the two runs out first.
        progress
            Asked now and then; the search stops when it answers False.

        Returns
        -------
        bool
            False if it was asked to stop, by `progress` or by an interrupt from the keyboard.
        """
        if self._problem.n == 0:
            return True
        try:
            with ThreadPoolExecutor(WALKERS) as pool:
                return self._run(pool, max(1, int(work * WORK_PER_S)), time_s, progress)
        except KeyboardInterrupt:
            return False

    def _run(self, pool: Executor, budget: int, time_s: float | None, progress: Progress | None) -> bool:
        """See `run`; `budget` is in operations."""
        if self._regions is None:
            return self._by_annealing(pool, budget, time_s, progress)
        ends_s = inf if time_s is None else running_s() + time_s
        whole = min(int(WHOLE * _likely(budget, time_s)), int(WHOLE_MOST * self._problem.n**1.5))
        enough = whole <= LONGER * self._longest and self.best is not None
        if enough:
            whole = 0
        if budget - whole < REGIONS:  # too little for a look by regions
            self._longest = max(self._longest, budget)
            return self._by_annealing(pool, budget, time_s, progress)
        if not enough and not self._by_annealing(pool, whole, time_s and WHOLE * time_s, progress):
            return False
        self._longest = max(self._longest, whole)
        return self._by_regions(self._regions, pool, budget - whole, ends_s, progress)

    def _by_regions(
        self, regions: Regions, pool: Executor, budget: int, ends_s: float, progress: Progress | None
    ) -> bool:
        """Improve the best route region by region until `ends_s`, by `running_s`; answers as `run` does."""
        spent, best = 0, self.best
        if best is None:
            return True
        route = np.array(best.route, dtype=np.int64)
        while spent + REGIONS <= budget and running_s() < ends_s:
            if progress is not None and not progress("search", self._best_cost(), None):
                return False
            better, work = regions.step(pool, route, REGIONS, budget - spent, ends_s)
            spent += work
            if not np.array_equal(better, route):
                route = better
                self._walkers[0].stand_on(route)
        return True

    def _by_annealing(self, pool: Executor, budget: int, time_s: float | None, progress: Progress | None) -> bool:
        """Anneal the whole route; answers as `run` does."""
        started_s, spent = running_s(), 0
        likely = _likely(budget, time_s)
        schedule = Schedule.of(self._problem.n, likely)
        if not self._walkers[0].ready:
            end_s = None if time_s is None else started_s + FIRST * time_s
            if not self._begin(pool, int(FIRST * likely), end_s, progress):
                return False
            spent = self._walkers[0].work
        while spent < budget:
            if progress is not None and not progress("search", self._best_cost(), None):
                return False
            pace = 1 / likely  # share of the whole that an operation takes
            if time_s is not None and spent > 0:
                pace = max(1 / budget, (running_s() - started_s) / max(time_s, 1e-9) / spent)
            if (done := pace * spent) >= 1.0:
                break
            chunk = min(CHUNK, budget - spent)
            part = schedule.part(done, done + pace * chunk)
            if self._merging is None or schedule.short:
                self._anneal(pool, chunk, part)
                spent += chunk
            else:
                most = max(CHUNK, min(budget - spent, int(CHILD / pace)))
                spent += self._merging.step(pool, chunk, part, most, partial(self._anneal, pool))
        return True

    def _anneal(self, pool: Executor, chunk: int, part: CoolingPart) -> None:
        """Walk on through part of an annealing; one walker is hotter than the other."""
        heats = [self._heat * part.heat(k) for k in range(WALKERS)]
        list(pool.map(lambda walker, heat: walker.anneal(chunk, part, heat), self._walkers, heats))

    def _begin(self, pool: Executor, most: int, end_s: float | None, progress: Progress | None) -> bool:
        """First routes, improved without going uphill; answers as `run` does."""
        list(pool.map(methodcaller("start"), self._walkers))
        left = min(most, FIRST_DESCENT * self._problem.n)
        while left > 0 and (end_s is None or running_s() < end_s):
            if progress is not None and not progress("search", self._best_cost(), None):
                return False
            list(pool.map(methodcaller("descend", min(CHUNK, left)), self._walkers))
            left -= CHUNK
        list(pool.map(methodcaller("measure", most), self._walkers))
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
        for walker in self._walkers:
            walker.stand_on(np.asarray(route, dtype=np.int64))

    def _best_cost(self) -> int | None:
        return min((walker.cost for walker in self._walkers if walker.cost is not None), default=None)


def _likely(budget: int, time_s: float | None) -> int:
    """Operations that are likely to be done of a budget, as there is so much time."""
    return budget if time_s is None else max(1, min(budget, int(time_s * WORK_PER_S)))
