"""By how much the bounds of stretches apart are too low at least, so that a sweep of all of them drops more.

In a stretch a plan may cost more than the bound before it promised, less what the bound behind it promises. The least
of that over all ways through the stretch is found by a sweep of it alone, from wherever it may be entered. What is
missed so in all stretches adds up (the bounds are potentials, as in the shortest paths of Johnson 1977), and a sweep of
one stretch has room for its own share alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from itertools import pairwise

import numpy as np

from kerfwise.models.problem.problem import Problem

from .ahead import Ahead
from .alone import FAR
from .budget import SweepBudget, TooLarge
from .by_contour import ByContour
from .lattice import SweptStretch, sweep_layers
from .local import Local, in_line, localise
from .rest_bound import RestBound
from .stretches import entrance_of, make_moves, never

SHARES = 0.25, 0.5, 0.75, 1.0
"""Shares of what a known plan misses in a stretch, within which the cheapest way through it is looked for."""


def missed_in(
    problem: Problem, ahead: Sequence[Ahead], route: Sequence[int], known: int, budget: SweepBudget, threads: Executor
) -> list[int]:
    """What every stretch costs more than its bound says, at least, µm: 0 for the first, which nothing comes before.

    `route` is a lawful one, which costs `known`; what it misses in a stretch is the most that is looked for. Where it
    costs as much as bounds are cut off at, nothing is said to be missed.

    Raises
    ------
    TooLarge
        If there is no work left.
    """
    if known >= FAR:
        return [0] * len(ahead)
    parts, earlier, at = ByContour(problem), frozenset[int](), 0
    missed = [0]
    for before, here in pairwise(ahead):
        at, earlier = at + len(before.group), earlier | frozenset(before.group)
        inside, order = parts.of(here.group), problem.site_contour[list(route[at : at + len(here.group)])]
        stays = localise(inside, tuple(order.tolist()), earlier)
        stays = replace(stays, orders=in_line(stays.orders))
        promised = int(before.onward[before.onward < FAR].max())
        through = _Through(inside, before, here, earlier, promised, budget, threads)
        most = through.least(stays, _nothing(stays), promised + known)
        local = localise(inside, here.group, earlier)
        missed.append(max(0, through.rising(local, here.rests(local, 0), most) - promised))
    return missed


class _Through:
    """Ways through one stretch, priced by what the bound before it `promised` and the bound behind it."""

    def __init__(
        self, problem: Problem, before: Ahead, here: Ahead, earlier: frozenset[int], promised: int,
        budget: SweepBudget, threads: Executor,
    ) -> None:  # fmt: skip
        passable = before.onward < FAR
        self._ways, self._entrance = before.out_of[passable], (promised - before.onward[passable]).tolist()
        self._promised = promised
        self._problem, self._here, self._earlier = problem, here, earlier
        self._budget, self._threads = budget, threads

    def rising(self, local: Local, rests: Callable[[int], RestBound], most: int) -> int:
        """What the cheapest of them costs at least, `most` at the most: little more than promised is tried first.

        Raises
        ------
        TooLarge
            If there is no work left.
        """
        above = self._promised
        try:
            for share in SHARES:
                limit = self._promised + int(share * (most - self._promised))
                if (found := self.least(local, rests, limit)) <= limit:
                    return found
                above = limit + 1
        except TooLarge:
            self._budget.check()
            if self._budget.work.left < 0:
                raise
        return above

    def least(self, local: Local, rests: Callable[[int], RestBound], limit: int) -> int:
        """What the cheapest of them costs, of those up to `limit`; more than that where there is none."""
        moves, over = make_moves(self._problem, local, self._earlier, self._ways, limit)
        stretch = SweptStretch(local, moves, over, rests, limit, never(limit))
        budget = replace(self._budget)  # nothing is kept of the layers
        end = sweep_layers(stretch, entrance_of(self._entrance, limit), budget, self._threads)[-1]
        at = np.searchsorted(self._here.out_of, local.sites_of(end.contour))
        whole = end.values + self._here.onward[at]
        return int(whole.min(initial=stretch.never))


def _nothing(local: Local) -> Callable[[int], RestBound]:
    """A bound that says nothing."""
    count = len(local.contours)
    rest = RestBound(np.zeros((1, len(local.sites))), np.zeros((count, 0), dtype=np.int64), np.zeros(count), 0.0)
    return lambda _: rest
