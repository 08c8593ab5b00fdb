"""Region after region of a route is searched, two halves of the route at a time."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.engines.search.annealing_walker import AnnealingWalker
from kerfwise.models.engines.search.structs import for_kernels
from kerfwise.models.engines.search.tables import SearchTables, make_tables
from kerfwise.models.kernels import running_s
from kerfwise.models.problem.problem import Problem

from .contract import Contractor
from .nearby import Nearby

LEAST_CONTOURS = 150
"""Contours from which on a route is searched by regions."""
LARGEST_BLOCK = 40
"""Contours that must follow each other, at the most: they are free together."""


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


CHUNK = 20_000_000
"""Operations between two looks at the clock."""
STAGES = (
    Stage(4.0, 40, 300_000, 2.0),
    Stage(16.0, 120, 500_000, 4.0),
    Stage(28.0, 120, 1_000_000, 4.0),
    Stage(40.0, 120, 2_000_000, 4.0),
    Stage(inf, 120, 4_000_000, 4.0),
)
"""What little searches leave is soon found by small regions. The rest asks for large ones, laid out anew from above."""
COLD = 0.05
"""The last temperature, as a share of the same."""
SETTING_UP, PER_SITE, PER_MOVE = 2_000_000, 1_000, 8
"""Operations that it takes as long as to make a region's problem, and for each site of the whole, and for each move
between two sites of the region."""
MIDDLE = 0.3, 0.7
"""Where a route is parted: between these shares of it."""


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
        self._contractor = Contractor(problem, fields)
        self._nearby = Nearby(problem)
        self._rounds = self._freed = 0

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
        return next(stage for stage in STAGES if self._freed < stage.passes * self._problem.n)

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
        region = self._contractor.region(route, free, starts=latter, ends=not latter)
        fields = make_tables(region.problem)
        walker = AnnealingWalker(for_kernels(fields), fields, (self._seed, seed))
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
