"""Anneal several times anew, merge the tours that were found (Cook and Seymour 2003), keep the best and begin again."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial

import numpy as np

from kerfwise.models.engines.search.anneal import AnnealingWalker
from kerfwise.models.engines.search.region_problem import Contractor
from kerfwise.models.engines.search.state.route_state import SearchTables, make_tables
from kerfwise.models.engines.search.walker import CoolingPart, Elite, Pool, Walker
from kerfwise.models.engines.tuning import ANNEALINGS, EACH, MATRIX_SITES
from kerfwise.models.engines.tuning import MERGING_LEAST as LEAST
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .lin_kernighan import ChainedWalker
from .lin_kernighan_tables import chained

__all__ = ["ChainedWalker", "chained"]


class TourMerging:
    """What walkers over one problem find in one annealing after another, and what is bred from it.

    Parameters
    ----------
    problem
        One that is `mergeable`.
    fields
        The same for kernels.
    walkers
        Who anneals; each makes a child at a time.
    seed
        Equal seeds give equal children.
    """

    def __init__(self, problem: Problem, fields: SearchTables, walkers: list[Walker], seed: int) -> None:
        self._problem, self._walkers, self._seed = problem, walkers, seed
        self._contractor = Contractor(problem, fields)
        self._pool = Pool(seed)
        self._children = 0
        self._at = (-1, -1)  # the turn of the generation, and which of its annealings goes on

    def step(
        self, threads: Executor, chunk: int, part: CoolingPart, most: int, anneal: Callable[[int, CoolingPart], None]
    ) -> int:
        """Go on through a part of a generation; answers by how many operations each walker did.

        `anneal` walks through `chunk` operations of an annealing; a child may take `most` operations.
        """
        now = part.annealing(ANNEALINGS)
        at = (part.turn, -1 if now is None else now[0])
        if at != self._at:
            self._take_in(at)
        if now is not None:
            anneal(chunk, now[1])
            return chunk
        if not self._pool.members:  # bans on moves have left no lawful route so far
            anneal(chunk, part)
            self._take_in(at)
            return chunk
        return self._merge(threads, most)

    def _take_in(self, at: tuple[int, int]) -> None:
        """End an annealing, and the generation if another one begins."""
        for walker in self._walkers:
            elite = walker.take()
            if elite is not None:
                self._pool.add(elite)
        if at[0] != self._at[0]:
            self._pool.keep_best()
        self._at = at

    def _merge(self, threads: Executor, most: int) -> int:
        """A child for each walker, all at a time."""
        parents = [self._pool.pair() for _ in self._walkers]
        numbers = range(self._children, self._children + len(parents))
        self._children += len(parents)
        seeds = [(self._seed, len(self._walkers) + number) for number in numbers]
        children = list(
            threads.map(partial(merge_tours, self._problem, self._contractor, most=most), self._walkers, parents, seeds)
        )
        for walker, (_, elder), (child, _) in zip(self._walkers, parents, children, strict=True):
            self._pool.succeed(elder, child)
            if walker.cost is None or child.cost < walker.cost:
                walker.stand_on(child.route)
        return max(1, *(work for _, work in children))


# A child of two routes: an annealing of what they do not agree about.


def merge_tours(
    problem: Problem,
    contractor: Contractor,
    walker: Walker,
    parents: tuple[Elite, Elite],
    seed: tuple[int, ...],
    most: int,
) -> tuple[Elite, int]:
    """The best route found between two, in about `most` operations at the most, and how many it took.

    If they hardly differ, the walker goes on from the better one through the whole problem.

    The walker's temperatures are taken; equal seeds and parents give equal children.
    """
    better, other = parents
    merged = contractor.merged(better.route, other.route)
    if merged.problem.n < LEAST:
        walker.stand_on(better.route)
        walker.forget()
        operations = min(most, EACH * problem.n)
        walker.cool(operations)
        found = walker.take()
        return better if found is None else found, operations
    fields = make_tables(merged.problem)
    child = make_walker_like(walker, fields, seed)
    child.stand_on(merged.route)
    operations = min(most, EACH * merged.problem.n)
    child.cool(operations)
    found = child.take()
    if found is None:
        return better, operations
    route = np.ascontiguousarray(merged.whole(found.route))
    return Elite(route_cost(problem, route.tolist()), route), operations


def mergeable(problem: Problem) -> bool:
    """Whether nothing but orders says which contour may stand where, and a table of travel fits into memory."""
    return (
        problem.n > 1
        and (problem.matrix is not None or problem.m <= MATRIX_SITES)
        and len(np.unique(problem.block)) == problem.n
        and not (problem.conditions or problem.soft_groups or problem.lags or problem.general)
        and not len(problem.crossings)
    )


# Which walkers suit a problem.


def make_walkers(fields: SearchTables, seed: int, count: int, chains: bool = True) -> list[Walker]:
    """So many walkers over a problem, each with random numbers of its own; they go by chains if asked and suited."""
    if chains and chained(fields):
        return [ChainedWalker(fields, (seed, k)) for k in range(count)]
    tables = kernel_argument(fields)
    return [AnnealingWalker(tables, fields, (seed, k)) for k in range(count)]


def make_walker_like(like: Walker, fields: SearchTables, seed: tuple[int, ...]) -> Walker:
    """A walker of the same kind over another problem, with the same temperatures."""
    if isinstance(like, ChainedWalker):
        return ChainedWalker(fields, seed, like)
    return AnnealingWalker(kernel_argument(fields), fields, seed, like)
