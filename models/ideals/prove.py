"""Proves the best plan wherever the sets that can occur are few, stretch after stretch."""

from __future__ import annotations

import time
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from ..bounds import Completion, complete
from ..problem import Problem
from ..solution import Incumbent, Progress
from .budget import Budget, TooLarge
from .count import ADDITIONS_PER_S
from .crossed import HOME
from .lattice import THREADS, Layer, Stretch, sweep_layers, walk_back
from .local import localise
from .prune import least_in, least_rest, walked_rest
from .series import series
from .stretches import dearest, entrance_of, make_moves, never, way_home

BOUND = 0.4
"""Share of the work, or the time, for the bound by walks."""
MOST_SITES, MOST_SITES_BOUND = 4000, 1500
"""Sites of a stretch: with more the table of moves is too large; sites altogether: the bound takes too long."""


@dataclass(frozen=True, slots=True)
class Proof:
    """The best route there is; `incumbent` is None where no lawful route exists at all.

    `work` is what the proof took, in deterministic seconds (`ADDITIONS_PER_S` additions each).
    """

    incumbent: Incumbent | None
    work: float = field(default=0.0, compare=False)


def applies(problem: Problem) -> bool:
    """Whether the cost of a step depends on nothing but the set already cut and the last site."""
    short = all(lag.cuts <= 1 and lag.seconds == 0 for lag in problem.lags)
    one_price = len(np.unique(problem.crossings.cost)) <= 1
    return short and one_price and not problem.general


def fits(problem: Problem) -> bool:
    """Whether a proof is worth a try: it applies, and the moves of every stretch fit in a table."""
    size = np.diff(problem.first)
    return applies(problem) and 0 < max((int(size[list(g)].sum()) for g in series(problem)), default=0) <= MOST_SITES


def prove(
    problem: Problem,
    incumbent: Incumbent | None,
    work: float,
    progress: Progress | None = None,
    bounded: bool = True,
    time_s: float | None = None,
) -> Proof | None:
    """Solve exactly, or return None if the budget does not suffice.

    Parameters
    ----------
    problem
        Anything; where a state cannot hold what is asked, the answer is None.
    incumbent
        Makes it faster, never different: states that cannot lead to a plan as cheap are dropped.
    work
        Deterministic limit, in seconds or so.
    progress
        Asked now and then whether to go on.
    bounded
        Whether to look for a bound by walks beforehand, which drops far more states and takes its time.
    time_s
        Wall-clock time, s, of which the bound takes no more than its share.
    """
    if not fits(problem):
        return None
    known = incumbent.cost if incumbent else None
    began_s = time.monotonic()

    def go() -> bool:
        return progress is None or progress("ideals", known, None)

    def pricing(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        return go() and (time_s is None or time.monotonic() - began_s < BOUND * time_s)

    bound, spent = None, 0.0
    if bounded and known is not None and problem.m <= MOST_SITES_BOUND:
        bound = complete(problem, float(known), work * BOUND, pricing)
        spent = bound.work
    with ThreadPoolExecutor(THREADS) as threads:
        return _attempt(problem, known, bound, Budget.of(max(0.0, work - spent), go), threads, work)


def _attempt(
    problem: Problem, known: int | None, bound: Completion | None, budget: Budget, threads: Executor, work: float
) -> Proof | None:
    limit = dearest(problem) if known is None else known
    least = least_in(problem) if bound is None else []
    swept: list[tuple[Stretch, list[Layer]]] = []
    ways, costs, earlier = np.array([HOME]), entrance_of([0], limit), frozenset[int]()
    total = None
    try:
        for group in series(problem):
            local = localise(problem, group, earlier)
            moves = make_moves(problem, local, earlier, ways, limit)
            rests = least_rest(local, earlier, least) if bound is None else walked_rest(local, earlier, bound)
            stretch = Stretch(local, moves, rests, limit, never(limit))
            layers = sweep_layers(stretch, costs, budget, threads)
            swept.append((stretch, layers))
            earlier |= frozenset(group)
            last, costs = layers[-1].contour, layers[-1].values
            if not (costs < stretch.never).any():
                break
            ways = np.concatenate([local.sites[local.first[c] : local.first[c + 1]] for c in last])
        else:
            total = costs + way_home(problem, ways)
    except TooLarge:
        return None
    spent = work - budget.additions / ADDITIONS_PER_S
    if total is None or total.min() > limit:
        return Proof(None, spent)
    best = int(np.argmin(total))
    return Proof(Incumbent(_route(swept, best), int(total[best])), spent)


def _route(swept: list[tuple[Stretch, list[Layer]]], state: int) -> tuple[int, ...]:
    route: list[int] = []
    for stretch, layers in reversed(swept):
        columns, state = walk_back(stretch, layers, state)
        route = [int(stretch.local.sites[c]) for c in columns] + route
    return tuple(route)
