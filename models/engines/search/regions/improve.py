"""Region after region of a route is searched, two halves of the route at a time."""

from __future__ import annotations

from concurrent.futures import Executor

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.engines.search.annealing_walker import AnnealingWalker
from kerfwise.models.engines.search.structs import for_kernels
from kerfwise.models.engines.search.tables import SearchTables, make_tables
from kerfwise.models.problem.problem import Problem

from .contract import Contractor
from .nearby import Nearby

LEAST_CONTOURS = 150
"""Contours from which on a route is searched by regions."""
FREE = 40
"""Contours of a region, and a few more, as blocks are whole."""
EACH = 300_000
"""Operations for each piece of a region."""
SETTING_UP, PER_SITE = 2_000_000, 1_000
"""Operations that it takes as long as to make a region's problem, and for each site of the whole."""
HOT, COLD = 2.0, 0.05
"""Temperatures, as shares of what a move from contour to contour costs about."""
MIDDLE = 0.3, 0.7
"""Where a route is parted: between these shares of it."""


def regional(problem: Problem) -> bool:
    """Whether regions of it can be told apart: it is large, and nothing counts cuts, seconds or pieces of groups.

    Contours that must follow each other are free together, so no block may be as large as a region.
    """
    large = problem.n >= LEAST_CONTOURS and int(np.unique(problem.block, return_counts=True)[1].max()) <= FREE
    return large and separable(problem)


def separable(problem: Problem) -> bool:
    """Whether what is asked of a part of a route does not depend on how many cuts lie between."""
    return problem.matrix is None and problem.looks_one_back and not problem.soft_groups


class Regions:
    """Regions of routes through one problem; equal seeds and routes are improved in equal ways."""

    def __init__(self, problem: Problem, fields: SearchTables, seed: int) -> None:
        self._problem, self._seed = problem, seed
        self._contractor = Contractor(problem, fields)
        self._nearby = Nearby(problem)
        self._rounds = 0

    def step(self, threads: Executor, route: Ints, operations: int) -> tuple[Ints, int]:
        """A route no dearer than a lawful one, after about so many operations in each half; and how many they were."""
        self._rounds += 1
        random = np.random.default_rng((self._seed, self._rounds))
        parted = self._part(route, random)
        seeds = [int(random.integers(1 << 30)) for _ in range(2)]
        jobs = [
            threads.submit(self._half, route, parted, latter, operations, seed)
            for latter, seed in zip((False, True), seeds, strict=True)
        ]
        (former, first_work), (latter, last_work) = (job.result() for job in jobs)
        return np.concatenate([former[:parted], latter[parted:]]), max(first_work, last_work)

    def _part(self, route: Ints, random: np.random.Generator) -> int:
        """A place about the middle of a route, between two blocks."""
        block = self._problem.block[self._problem.site_contour[route]]
        low, high = (int(share * len(route)) for share in MIDDLE)
        at = int(random.integers(low, high))
        while at < len(route) and block[at] == block[at - 1]:
            at += 1
        return at

    def _half(self, route: Ints, parted: int, latter: bool, operations: int, seed: int) -> tuple[Ints, int]:
        """The route with one half of it improved; what stands just before the parting stays."""
        problem, random = self._problem, np.random.default_rng(seed)
        order = problem.site_contour[route]
        movable = np.zeros(problem.n, dtype=np.bool_)
        movable[order[parted:] if latter else order[:parted]] = True
        movable &= problem.block != problem.block[order[parted - 1]]
        centres = random.permutation(np.flatnonzero(movable))
        work = 0
        for centre in centres.tolist():
            free = self._nearby.around(centre, movable, FREE)
            route, taken = self._search(route, free, latter, not latter, seed + centre)
            work += taken
            if work >= operations:
                break
        return route, work

    def _search(self, route: Ints, free: Bools, starts: bool, ends: bool, seed: int) -> tuple[Ints, int]:
        """The best route found with some contours free, and the operations that took."""
        region = self._contractor.region(route, free, starts, ends)
        fields = make_tables(region.problem)
        walker = AnnealingWalker(for_kernels(fields), fields, (self._seed, seed))
        walker.stand_on(region.route)
        walker.start()
        before, operations = walker.cost, EACH * region.problem.n
        travel_um = self._nearby.travel_um
        walker.go(operations, HOT * travel_um, COLD * travel_um)
        best = walker.best
        work = operations + SETTING_UP + PER_SITE * self._problem.m
        if best is None or before is None or best.cost >= before:
            return route, work
        return region.whole(best.route), work
