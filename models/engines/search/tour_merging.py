"""Anneal several times anew, merge the tours that were found (Cook and Seymour 2003), keep the best and begin again."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial

from kerfwise.models.problem.problem import Problem

from .merge_tours import merge_tours
from .pool import Pool
from .schedule import CoolingPart
from .walker import Walker

ANNEALINGS = 2  # of each walker in a generation
CHILD = 0.02  # the most of a run that a child may take


class TourMerging:
    """What walkers over one problem find in one annealing after another, and what is bred from it.

    Parameters
    ----------
    problem
        One that is `mergeable`.
    walkers
        Who anneals; each makes a child at a time.
    seed
        Equal seeds give equal children.
    """

    def __init__(self, problem: Problem, walkers: list[Walker], seed: int) -> None:
        self._problem, self._walkers, self._seed = problem, walkers, seed
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
        children = list(threads.map(partial(merge_tours, self._problem, most=most), self._walkers, parents, seeds))
        for walker, (_, elder), (child, _) in zip(self._walkers, parents, children, strict=True):
            self._pool.succeed(elder, child)
            if walker.cost is None or child.cost < walker.cost:
                walker.stand_on(child.route)
        return max(1, *(work for _, work in children))
