"""Sweeps that improve a plan without a proof: windows put in their best order, and layers of the most promising
states."""

from __future__ import annotations

from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from math import ceil, isinf
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem

from .lattice import (
    THREADS,
    SweptLayer,
    SweptStretch,
    TooLarge,
    Width,
    sweep_layers,
    sweep_through,
    sweeping,
    walk_back,
)
from .prove import MOST_SITES_BOUND, Apart, Proof, applies, bound_by_walks, held_by, rests_of
from .stretch import ConditionsByContour, Local, chain_orders, localise, series
from .stretch_bounds import LeastIn, least_rest
from .stretch_tables import FAR, HOME, add_settled, dearest, entrance_of, make_moves, never, travel_between

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion


# Windows of consecutive contours put in their best order, with their best sites, between what stays as it is.
#
# The sweep over ideals does it exactly, for whatever a state can hold (a neighbourhood of exponential size that is
# searched whole, as in Balas and Simonetti 2001).

WIDTH, STEP = 12, 4
"""Contours in a window, and from one window to the next."""
SETTING_UP = 1e6
"""Additions that it takes as long as to set a window up."""


@dataclass(frozen=True, slots=True)
class Polished:
    """A route after the windows, and the work they took, in deterministic seconds."""

    incumbent: Incumbent
    work: float


def polish(problem: Problem, incumbent: Incumbent, deadline: Deadline) -> Polished:
    """Improve a route window by window, until no window has a better order or the work is spent.

    The tables of a window take no more than the bytes of the deadline. What comes back is never dearer, and lawful if
    the route was. Where a state cannot hold what is asked, nothing is tried.
    """
    if not applies(problem) or problem.n == 0:
        return Polished(incumbent, 0.0)
    deadline.engine = "windows"
    deadline("windows", incumbent.cost, None)
    work = sweeping(deadline, deadline.work)
    with ThreadPoolExecutor(1) as thread:
        windows = _Windows(problem, work, thread)
        last = max(0, problem.n - WIDTH)
        starts = [*range(0, last, STEP), last]
        waiting = set(starts)
        try:
            while waiting:
                for start in sorted(waiting):
                    waiting.discard(start)
                    better = windows.best(incumbent, start)
                    if better is not None:
                        incumbent = better
                        deadline("windows", better.cost, None)
                        waiting |= {s for s in starts if abs(s - start) < WIDTH and s != start}
        except TooLarge:
            pass
    return Polished(incumbent, work.work - max(0.0, work.left))


class _Windows:
    """What all windows of a problem share."""

    def __init__(self, problem: Problem, work: Deadline, thread: Executor) -> None:
        self._problem, self._work, self._thread = problem, work, thread
        self._least, self._dearest = LeastIn(problem), dearest(problem)
        self._parts = ConditionsByContour(problem)

    def best(self, incumbent: Incumbent, start: int) -> Incumbent | None:
        """The route with the window from position `start` in its best order, if that is better."""
        route, problem = incumbent.route, self._problem
        stop = min(start + WIDTH, problem.n)
        order = problem.site_contour[list(route)].tolist()
        earlier, group = frozenset(order[:start]), tuple(order[start:stop])
        inside = self._parts.of(group)
        local = localise(inside, group, earlier)
        before = np.array([route[start - 1] if start else HOME])
        after = np.array([route[stop] if stop < problem.n else HOME])
        stays = replace(local, orders=chain_orders(local.orders))
        known = self._sweep(inside, stays, earlier, before, after, self._dearest)
        if known is None:
            return None
        found = self._sweep(inside, local, earlier, before, after, known[0] - 1)
        if found is None:
            return None
        better = (*route[:start], *local.sites[found[1]].tolist(), *route[stop:])
        # groups and blocks that reach beyond the window are judged here, on the whole route
        cost = route_cost(problem, better)
        return Incumbent(better, cost) if cost < incumbent.cost and not broken(problem, better) else None

    def _sweep(
        self, problem: Problem, local: Local, earlier: frozenset[int], before: Ints, after: Ints, limit: int
    ) -> tuple[int, list[int]] | None:
        """The cheapest way through a window from one site to another, and its cost; None if it is over the limit."""
        everything = frozenset(range(problem.n))
        self._work.spend(SETTING_UP)
        moves, over = make_moves(problem, local, earlier, before, limit)
        rests = least_rest(local, everything - frozenset(local.contours), self._least)
        stretch = SweptStretch(local, moves, over, rests, limit, never(limit))
        allowed = self._work.part(1.0)
        layers = sweep_layers(stretch, entrance_of([0], limit), allowed, self._thread)
        self._work.spend(allowed.operations_spent)
        if not len(layers[-1].contour):
            return None
        total = layers[-1].values + self._onward(local, earlier, layers[-1], after)
        best = int(np.argmin(total))
        if total[best] > limit:
            return None
        return int(total[best]), walk_back(stretch, layers, best)[0]

    def _onward(self, local: Local, earlier: frozenset[int], end: SweptLayer, after: Ints) -> Ints:
        """What it costs to leave a window to the site `after` it, from every state at its end."""
        ways = local.sites_of(end.contour)
        onward = travel_between(self._problem, ways, after)
        add_settled(self._problem, earlier | frozenset(local.contours), ways, after, onward)
        return onward[:, 0]


# Sweeps that keep the most promising states of every layer, each sweep wider than the last (Libralesso et al. 2020).
#
# Where the sets are too many for a sweep of all, one of few finds a plan soon. What it drops bounds all plans that it
# could have missed, and where nothing is dropped that a better plan could be in, the plan is proven.

FIRST_WIDTH, WIDER = 256, 2
"""States of a layer that the first sweep keeps, and how many times as many the next."""
BOUND = 0.15
"""Share of the work that a bound by walks may take."""
ROUNDING = 1e-3
"""Bounds are sums of doubles, costs whole: what is under the next whole number by less is taken for it."""


def widen(
    problem: Problem,
    incumbent: Incumbent | None,
    deadline: Deadline,
    width: int = FIRST_WIDTH,
) -> Proof:
    """The best plan of sweeps of so many states and more, until it is proven or the work is spent.

    Parameters
    ----------
    problem
        One that the ideals are fit for (`prove.unfit`).
    incumbent
        A lawful plan: states that cannot lead to a cheaper one are dropped without a loss.
    """
    best, least, work = incumbent, 0, deadline.work
    deadline.engine = "ideals"
    deadline("ideals", None if best is None else best.cost, None)
    bound: Completion | Apart | None = None
    if incumbent is not None and incumbent.cost < FAR and (len(series(problem)) > 1 or problem.m <= MOST_SITES_BOUND):
        with suppress(bounds.TooMuch):
            bound = bound_by_walks(problem, incumbent, deadline.counting(BOUND * work), work)
    spent = 0.0 if bound is None else bound.work
    swept = sweeping(deadline, work - spent, held_by(bound))
    with ThreadPoolExecutor(THREADS) as threads, suppress(TooLarge):
        rests, root = rests_of(problem, bound, swept, threads)
        least = 0 if isinf(root) else max(0, ceil(root - ROUNDING))
        while True:
            had, kept = swept.left, Width(width)
            limit = None if best is None else best.cost - 1
            found = sweep_through(problem, limit, rests, swept, threads, kept)
            if found is not None:
                best = found
                deadline("ideals", best.cost, None)
            if isinf(kept.dropped) or (best is not None and kept.dropped > best.cost - 1 + ROUNDING):
                return Proof(best, work - swept.left)
            least = max(least, ceil(kept.dropped - ROUNDING))
            if swept.left < WIDER * (had - swept.left):
                break
            width *= WIDER
    return Proof(None, work - max(0.0, swept.left), least, better=best)
