"""One sweep through all stretches, and the way back."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

import numpy as np

from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.problem import Problem

from .budget import SweepBudget
from .by_contour import ByContour
from .crossed import HOME
from .lattice import SweptLayer, SweptStretch, sweep_layers, walk_back
from .local import Local, localise
from .rest_bound import RestBound
from .series import series
from .stretches import NARROW, dearest, entrance_of, home_from, make_moves, never

Rests = Callable[[int, Local, frozenset[int]], Callable[[int], RestBound]]
"""Of a stretch, by its number, what it is and what comes before it: what plans still cost after so many cuts of it."""


def sweep_through(
    problem: Problem, known: int | None, rests: Rests, budget: SweepBudget, threads: Executor
) -> Incumbent | None:
    """The best route of all that cost no more than `known`, None where there is none; `TooLarge` over the budget.

    Where nothing is known, routes whose costs fit in narrow numbers are looked for first: most plans need no excuse.
    """
    most = dearest(problem) if known is None else known
    if known is None and most >= NARROW:
        found = _sweep(problem, NARROW - 1, rests, budget, threads)
        if found is not None:
            return found
    return _sweep(problem, most, rests, budget, threads)


def _sweep(problem: Problem, limit: int, rests: Rests, budget: SweepBudget, threads: Executor) -> Incumbent | None:
    swept: list[tuple[SweptStretch, list[SweptLayer]]] = []
    ways, costs, earlier = np.array([HOME]), entrance_of([0], limit), frozenset[int]()
    total = None
    parts = ByContour(problem)
    for number, group in enumerate(series(problem)):
        inside = parts.of(group)
        local = localise(inside, group, earlier)
        moves, over = make_moves(inside, local, earlier, ways, limit)
        stretch = SweptStretch(local, moves, over, rests(number, local, earlier), limit, never(limit))
        layers = sweep_layers(stretch, costs, budget, threads)
        swept.append((stretch, layers))
        earlier |= frozenset(group)
        last, costs = layers[-1].contour, layers[-1].values
        if not (costs < stretch.never).any():
            break
        ways = local.sites_of(last)
    else:
        total = costs + home_from(problem, ways)
    if total is None or total.min() > limit:
        return None
    best = int(np.argmin(total))
    return Incumbent(_route(swept, best), int(total[best]))


def _route(swept: list[tuple[SweptStretch, list[SweptLayer]]], state: int) -> tuple[int, ...]:
    route: list[int] = []
    for stretch, layers in reversed(swept):
        columns, state = walk_back(stretch, layers, state)
        route = [int(stretch.local.sites[c]) for c in columns] + route
    return tuple(route)
