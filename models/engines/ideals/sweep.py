"""One sweep through all stretches, and the way back."""

from __future__ import annotations

from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.problem import Problem

from .budget import SweepBudget
from .by_contour import ByContour
from .crossed import HOME
from .lattice import SweptLayer, SweptStretch, sweep_layers, walk_back
from .local import localise
from .prune import least_in, least_rest, walked_rest
from .series import series
from .stretches import dearest, entrance_of, home_from, make_moves, never

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion


def sweep_through(
    problem: Problem, known: int | None, bound: Completion | None, budget: SweepBudget, threads: Executor
) -> Incumbent | None:
    """The best route of all that cost no more than `known`, None where there is none; `TooLarge` over the budget."""
    limit = dearest(problem) if known is None else known
    least = least_in(problem) if bound is None else []
    swept: list[tuple[SweptStretch, list[SweptLayer]]] = []
    ways, costs, earlier = np.array([HOME]), entrance_of([0], limit), frozenset[int]()
    total = None
    parts = ByContour(problem)
    for group in series(problem):
        inside = parts.of(group)
        local = localise(inside, group, earlier)
        moves = make_moves(inside, local, earlier, ways, limit)
        rests = least_rest(local, earlier, least) if bound is None else walked_rest(local, earlier, bound)
        stretch = SweptStretch(local, moves, rests, limit, never(limit))
        layers = sweep_layers(stretch, costs, budget, threads)
        swept.append((stretch, layers))
        earlier |= frozenset(group)
        last, costs = layers[-1].contour, layers[-1].values
        if not (costs < stretch.never).any():
            break
        ways = np.concatenate([local.sites[local.first[c] : local.first[c + 1]] for c in last])
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
