"""A search that can be run, looked at, handed a better route, and run on; large routes region after region."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import inf, isinf
from operator import methodcaller

import numpy as np

from kerfwise.arrays import Bools, Ints, point_tree
from kerfwise.models.engines.deadline import Deadline, Progress
from kerfwise.models.engines.search.moves.tour_merging import TourMerging, make_walkers, merge_tours, mergeable
from kerfwise.models.engines.search.state.route_state import SearchTables, TablesOf, make_tables
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import (
    CHILD,
    CHUNK,
    EACH,
    FIRST_DESCENT,
    FIRST_ROUTE,
    HOTTER,
    LARGEST_BLOCK,
    LATER_ROUTES,
    LEAST_CONTOURS,
    LONGER,
    MIDDLE,
    NEIGHBOURS,
    PER_MOVE,
    PER_SITE,
    REGIONS,
    SEEDS_APART,
    SETTING_UP,
    WALKERS,
    WHOLE,
    WHOLE_MOST,
    WORK_PER_S,
)
from kerfwise.models.engines.tuning import SEARCHER_COLD as COLD
from kerfwise.models.engines.tuning import SEARCHER_FEW as FEW
from kerfwise.models.engines.tuning import SEARCHER_FIRST as FIRST
from kerfwise.models.jit import running_s
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem

from .anneal import AnnealingWalker
from .region_problem import Contractor
from .walker import CoolingPart, Elite, Schedule

__all__ = ["Contractor", "Regions", "regional"]


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
    fields
        The tables of the problem, where they are made.
    earlier
        The tables of a problem with other statements, of which what is the same is taken.
    """

    def __init__(
        self,
        problem: Problem,
        seed: int = 1,
        chains: bool = True,
        fields: SearchTables | None = None,
        earlier: TablesOf | None = None,
    ) -> None:
        self._problem, self._seed = problem, seed
        self._fields = fields = make_tables(problem, earlier) if fields is None else fields
        self._walkers = make_walkers(fields, seed, WALKERS, chains)
        self._merging = TourMerging(problem, fields, self._walkers, seed) if mergeable(problem) else None
        self._regional = regional(problem)
        self._heat = HOTTER if problem.n <= FEW else 1.0
        self._longest = 0  # annealing of the whole route, in operations
        self._merged = 0  # routes from nothing that were merged into the best one

    @cached_property
    def _regions(self) -> Regions:
        """Made where there is work for a look by regions: it loads a library."""
        return Regions(self._problem, self._fields, self._seed)

    @property
    def tables(self) -> TablesOf:
        """What it reads of its problem."""
        return TablesOf(self._problem, self._fields)

    @property
    def best(self) -> Incumbent | None:
        """The best lawful route so far, if one is known."""
        if self._problem.n == 0:
            return Incumbent((), route_cost(self._problem, ()))
        if (elite := self._elite()) is None:
            return None
        found = Incumbent(tuple(elite.route.tolist()), elite.cost)
        assert found.cost == route_cost(self._problem, found.route)
        return found

    def run(self, deadline: Deadline) -> bool:
        """Anneal, from the routes it stands on, the longer the later; just once where there is little time.

        Parameters
        ----------
        deadline
            Its work is counted in each walker's operations; the cooling follows whichever of work and seconds runs out
            first. Asked now and then whether to go on.

        Returns
        -------
        bool
            False if it was asked to stop, by the deadline or by an interrupt from the keyboard.
        """
        if self._problem.n == 0:
            return True
        try:
            with ThreadPoolExecutor(WALKERS) as pool:
                return self._run(pool, max(1, int(deadline.work * WORK_PER_S)), deadline.time_s, deadline)
        except KeyboardInterrupt:
            return False

    def _run(self, pool: Executor, budget: int, time_s: float | None, progress: Progress) -> bool:
        """See `run`; `budget` is in operations."""
        if not self._regional:
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
        first, later = (int(operations * self._problem.n**1.5) for operations in (FIRST_ROUTE, LATER_ROUTES))
        merging = budget >= first + later
        if not self._by_regions(self._regions, pool, (first if merging else budget) - whole, ends_s, progress):
            return False
        return not merging or self._by_merging(pool, budget - first, later, ends_s, progress)

    def _by_merging(self, pool: Executor, budget: int, each: int, ends_s: float, progress: Progress) -> bool:
        """Search for other routes from nothing, and merge them into the best one; answers as `run` does.

        Small regions hardly find anything where they have been gone through for long: large ones come by turns.
        """

        def heard(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
            return progress(engine, self._best_cost(), bound_um)

        left, self._regions.late = budget, True
        others: Elite | None = None  # those that came of the others alone
        while left >= each and (now_s := running_s()) < ends_s:
            self._merged += 1
            other = Searcher(self._problem, self._seed + SEEDS_APART * self._merged, fields=self._fields)
            time_s = None if isinf(ends_s) else min(ends_s - now_s, each / WORK_PER_S)
            going = other._run(pool, each, time_s, heard)
            others, work = self._merged_of(others, other._elite())
            best, more = self._merged_of(mine := self._elite(), others)
            if best is not None and best is not mine:
                self._walkers[0].stand_on(best.route)
                others = None if others is not None and best.same(others) else others  # to stay apart
            left -= each + work + more
            if not (going and self._by_regions(self._regions, pool, min(each, left), ends_s, progress)):
                return False
            left -= each
        return self._by_regions(self._regions, pool, left, ends_s, progress)

    def _merged_of(self, one: Elite | None, other: Elite | None) -> tuple[Elite | None, int]:
        """The best of two routes and of what they are merged into, and the operations that it took."""
        if one is None or other is None or one.same(other):
            return one or other, 0
        better, worse = sorted((one, other), key=lambda elite: elite.cost)
        seed = self._seed, WALKERS + self._merged
        contractor, most = self._regions.contractor, EACH * self._problem.n
        child, work = merge_tours(self._problem, contractor, self._walkers[1], (better, worse), seed, most)
        return min(child, better, key=lambda elite: elite.cost), work

    def _elite(self) -> Elite | None:
        """The best lawful route so far, as walkers have it."""
        found = [elite for walker in self._walkers if (elite := walker.best) is not None]
        return min(found, key=lambda elite: elite.cost, default=None)

    def _by_regions(self, regions: Regions, pool: Executor, budget: int, ends_s: float, progress: Progress) -> bool:
        """Improve the best route region by region until `ends_s`, by `running_s`; answers as `run` does."""
        spent, best = 0, self.best
        if best is None:
            return True
        route = np.array(best.route, dtype=np.int64)
        while spent + REGIONS <= budget and running_s() < ends_s:
            if not progress("search", self._best_cost(), None):
                return False
            better, work = regions.step(pool, route, REGIONS, budget - spent, ends_s)
            spent += work
            if not np.array_equal(better, route):
                route = better
                self._walkers[0].stand_on(route)
        return True

    def _by_annealing(self, pool: Executor, budget: int, time_s: float | None, progress: Progress) -> bool:
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
            if not progress("search", self._best_cost(), None):
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

    def _begin(self, pool: Executor, most: int, end_s: float | None, progress: Progress) -> bool:
        """First routes, improved without going uphill; answers as `run` does."""
        list(pool.map(methodcaller("start"), self._walkers))
        left = min(most, FIRST_DESCENT * self._problem.n)
        while left > 0 and (end_s is None or running_s() < end_s):
            if not progress("search", self._best_cost(), None):
                return False
            list(pool.map(methodcaller("descend", min(CHUNK, left)), self._walkers))
            left -= CHUNK
        list(pool.map(methodcaller("measure", most), self._walkers))
        return True

    def stand_on(self, route: Sequence[int]) -> None:
        """Go on from a lawful route (sites in cutting order) that another engine found.

        Raises ValueError if the route breaks a hard statement.
        """
        faults = broken(self._problem, route)
        if faults:
            raise ValueError(f"not a lawful route: {faults[0].sentence}")
        self.stand_near(route)

    def stand_near(self, route: Sequence[int]) -> None:
        """The same from a route that may break hard statements, of a problem that is not plain."""
        for walker in self._walkers:
            walker.stand_on(np.asarray(route, dtype=np.int64))

    def _best_cost(self) -> int | None:
        return min((walker.cost for walker in self._walkers if walker.cost is not None), default=None)


def _likely(budget: int, time_s: float | None) -> int:
    """Operations that are likely to be done of a budget, as there is so much time."""
    return budget if time_s is None else max(1, min(budget, int(time_s * WORK_PER_S)))


# Region after region of a route is searched, two halves of the route at a time.


@dataclass(frozen=True, slots=True)
class Stage:
    """How regions are searched until every contour was free about `passes` times, earlier stages counted.

    `free` contours of a region, and a few more, as blocks are whole; `each` operations for each of its pieces; `hot` is
    the first temperature, as a share of what a move from contour to contour costs about.
    """

    passes: float
    free: int
    each: int
    hot: float


STAGES = (
    Stage(4.0, 40, 300_000, 2.0),
    Stage(16.0, 120, 500_000, 4.0),
    Stage(28.0, 120, 1_000_000, 4.0),
    Stage(40.0, 120, 2_000_000, 4.0),
    Stage(inf, 200, 4_000_000, 8.0),
)
"""What little searches leave is soon found by small regions. The rest asks for large ones, laid out anew from above."""


def regional(problem: Problem) -> bool:
    """Whether regions of it can be told apart: it is large, and nothing counts cuts, seconds or pieces of groups.

    Contours that must follow each other are free together, so no block may be nearly as large as a region.
    """
    large = problem.n >= LEAST_CONTOURS and int(np.unique(problem.block, return_counts=True)[1].max()) <= LARGEST_BLOCK
    return large and separable(problem)


def separable(problem: Problem) -> bool:
    """Whether what is asked of a part of a route does not depend on how many cuts lie between."""
    return problem.matrix is None and problem.looks_one_back and not problem.soft_groups


class Regions:
    """Regions of routes through one problem; equal seeds and routes are improved in equal ways.

    The way goes on where it was, so that more steps from one route never end in a dearer one.
    """

    def __init__(self, problem: Problem, fields: SearchTables, seed: int) -> None:
        self._problem, self._seed = problem, seed
        self.contractor = Contractor(problem, fields)
        self._nearby = Nearby(problem)
        self._rounds = self._freed = 0
        self.late = False  # whether the last stage comes next, wherever it has come to

    def step(
        self, threads: Executor, route: Ints, operations: int, most: int | None = None, ends_s: float = inf
    ) -> tuple[Ints, int]:
        """A route no dearer than a lawful one, after about so many operations in each half; and how many they were.

        A region that is begun is searched to its end, which may take more; but not much more than `most`, if given, and
        not beyond `ends_s`, by `running_s`.
        """
        stage = self._stage()
        if most is not None:
            stage = replace(stage, each=max(1, min(stage.each, most // (2 * stage.free))))
        self._rounds += 1
        random = np.random.default_rng((self._seed, self._rounds))
        parted = self._part(route, random)
        seeds = [int(random.integers(1 << 30)) for _ in range(2)]
        jobs = [
            threads.submit(self._half, route, parted, latter, operations, stage, seed, ends_s)
            for latter, seed in zip((False, True), seeds, strict=True)
        ]
        (former, first_work, freed), (latter, last_work, more) = (job.result() for job in jobs)
        self._freed += freed + more
        return np.concatenate([former[:parted], latter[parted:]]), max(first_work, last_work)

    def _stage(self) -> Stage:
        """The stage that it has come to."""
        come_to = (stage for stage in STAGES if self._freed < stage.passes * self._problem.n)
        return STAGES[-1] if self.late else next(come_to)

    def _part(self, route: Ints, random: np.random.Generator) -> int:
        """A place about the middle of a route, between two blocks."""
        block = self._problem.block[self._problem.site_contour[route]]
        low, high = (int(share * len(route)) for share in MIDDLE)
        at = int(random.integers(low, high))
        while at < len(route) and block[at] == block[at - 1]:
            at += 1
        return at

    def _half(
        self, route: Ints, parted: int, latter: bool, operations: int, stage: Stage, seed: int, ends_s: float
    ) -> tuple[Ints, int, int]:
        """The route with one half of it improved, the operations that took, and how many contours were free.

        What stands just before the parting stays.
        """
        problem, random = self._problem, np.random.default_rng(seed)
        order = problem.site_contour[route]
        movable = np.zeros(problem.n, dtype=np.bool_)
        movable[order[parted:] if latter else order[:parted]] = True
        movable &= problem.block != problem.block[order[parted - 1]]
        centres = random.permutation(np.flatnonzero(movable))
        work = freed = 0
        for centre in centres.tolist():
            free = self._nearby.around(centre, movable, stage.free)
            route, taken = self._search(route, free, latter, stage, seed + centre, ends_s)
            work, freed = work + taken, freed + int(free.sum())
            if work >= operations or running_s() >= ends_s:
                break
        return route, work, freed

    def _search(
        self, route: Ints, free: Bools, latter: bool, stage: Stage, seed: int, ends_s: float
    ) -> tuple[Ints, int]:
        """The best route found with some contours of one half free, and the operations that took."""
        region = self.contractor.region(route, free, starts=latter, ends=not latter)
        fields = make_tables(region.problem)
        walker = AnnealingWalker(kernel_argument(fields), fields, (self._seed, seed))
        walker.stand_on(region.route)
        walker.start()
        before, operations = walker.cost, stage.each * region.problem.n
        travel_um = self._nearby.travel_um
        done, fall = 0, COLD / stage.hot
        while done < operations and running_s() < ends_s:
            ahead = min(operations, done + CHUNK)
            heats = (stage.hot * travel_um * fall ** (at / operations) for at in (done, ahead))
            walker.go(ahead - done, *heats)
            done = ahead
        best = walker.best
        work = operations + SETTING_UP + PER_SITE * self._problem.m + PER_MOVE * region.problem.m**2
        if best is None or before is None or best.cost >= before:
            return route, work
        return region.whole(best.route), work


# Which contours lie near each other on the sheet.


class Nearby:
    """The contours of a problem by where they are pierced. `travel_um` is what a move to the nearest costs about."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        starts = problem.first[:-1]
        centre = np.add.reduceat(problem.pierce_um.astype(np.float64), starts) / np.diff(problem.first)[:, None]
        away, self._near = point_tree(centre, leafsize=10).query(centre, k=min(NEIGHBOURS, problem.n))
        self.travel_um = max(1.0, float(problem.travel_weight) * float(np.median(away[:, 1])))

    def around(self, centre: int, movable: Bools, count: int) -> Bools:
        """About so many movable contours nearest to one, whole blocks, (n,)."""
        near = self._near[centre]
        near = near[movable[near]][:count]
        free = np.isin(self._problem.block, self._problem.block[near])
        return free & movable
