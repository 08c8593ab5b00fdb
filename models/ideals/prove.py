"""Proves the best plan wherever the sets that can occur are few, stretch after stretch."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..bounds import Completion, complete
from ..problem import Problem
from ..solution import Incumbent, Progress
from .crossed import Crossed, add_settled, cross
from .lattice import Budget, Layer, TooLarge, sweep_layers, walk_back
from .local import MOST_CONTOURS, Floats, Ints, Local, localise
from .prune import Pruner
from .series import series

ADDITIONS_PER_S = 4e8
MOST_STATES = 350_000_000
PLAIN, BOUND = 0.05, 0.4
"""Shares of the work for a try without the bound by walks, which most proofs do not need, and for that bound."""
MOST_SITES = 1500
"""With more, the bound takes too long."""
HOME = -1


@dataclass(frozen=True, slots=True)
class Proof:
    """The best route there is; `incumbent` is None where no lawful route exists at all.

    `work` is what the proof took, in deterministic seconds (`ADDITIONS_PER_S` additions each).
    """

    incumbent: Incumbent | None
    work: float = field(default=0.0, compare=False)


@dataclass(frozen=True, eq=False, slots=True)
class _Stretch:
    local: Local
    entrance: Ints
    travel: Floats
    crossed: Crossed
    layers: list[Layer]


def applies(problem: Problem) -> bool:
    """Whether the cost of a step depends on nothing but the set already cut and the last site."""
    short = all(lag.cuts <= 1 and lag.seconds == 0 for lag in problem.lags)
    one_price = len(np.unique(problem.crossings.cost)) <= 1
    return short and one_price and not problem.general


def fits(problem: Problem) -> bool:
    """Whether a proof is worth a try: it applies, and no stretch has more contours than a mask has bits."""
    return applies(problem) and 0 < max(map(len, series(problem)), default=0) <= MOST_CONTOURS


def prove(problem: Problem, incumbent: Incumbent | None, work: float, progress: Progress | None = None) -> Proof | None:
    """Solve exactly, or return None if the budget (`work`, seconds or so) does not suffice.

    An incumbent makes it faster, never different: states that cannot lead to a plan as cheap are dropped.
    """
    if not fits(problem):
        return None
    known = incumbent.cost if incumbent else None

    def go() -> bool:
        return progress is None or progress("ideals", known, None)

    bounded = known is not None and problem.m <= MOST_SITES
    plain = work * PLAIN if bounded else work
    proof = _attempt(problem, known, None, Budget(plain * ADDITIONS_PER_S, MOST_STATES, go), plain)
    if proof is not None or known is None or not bounded or not go():
        return proof
    bound = complete(problem, float(known), work * BOUND)
    left = max(0.0, work - plain - bound.work)
    proof = _attempt(problem, known, bound, Budget(left * ADDITIONS_PER_S, MOST_STATES, go), left)
    return None if proof is None else Proof(proof.incumbent, plain + bound.work + proof.work)


def _attempt(
    problem: Problem, known: int | None, bound: Completion | None, budget: Budget, work: float
) -> Proof | None:
    limit = np.inf if known is None else float(known)
    least = _least_in(problem)
    stretches: list[_Stretch] = []
    ways, costs, earlier = np.array([HOME]), np.zeros(1), frozenset[int]()
    try:
        for group in series(problem):
            local = localise(problem, group, earlier)
            rows = np.concatenate([ways, local.sites])
            travel = _travel(problem, rows, local.sites)
            crossed = cross(problem, local, earlier, rows, travel)
            pruner = None if bound is None else Pruner.of(bound, local, earlier)
            earlier |= frozenset(group)
            later = sum(least[c] for c in range(problem.n) if c not in earlier)
            rest = np.array([*(least[c] for c in group), later])
            layers = sweep_layers(local, travel, crossed, costs, limit, rest, pruner, budget)
            stretches.append(_Stretch(local, ways, travel, crossed, layers))
            end = layers[-1]
            if not len(end.contour) or not np.isfinite(end.values).any():
                return Proof(None, work - budget.additions / ADDITIONS_PER_S)
            ways = np.concatenate([local.sites[local.first[c] : local.first[c + 1]] for c in end.contour])
            costs = end.values
    except TooLarge:
        return None
    total = costs + _way_home(problem, ways)
    best = int(np.argmin(total))
    if not np.isfinite(total[best]):
        return Proof(None, work - budget.additions / ADDITIONS_PER_S)
    route = Incumbent(_route(stretches, best), round(float(total[best])))
    return Proof(route, work - budget.additions / ADDITIONS_PER_S)


def _route(stretches: list[_Stretch], state: int) -> tuple[int, ...]:
    route: list[int] = []
    for stretch in reversed(stretches):
        columns, state = walk_back(stretch.local, stretch.layers, stretch.travel, stretch.crossed, state)
        route = [int(stretch.local.sites[c]) for c in columns] + route
    return tuple(route)


def _travel(problem: Problem, rows: Ints, columns: Ints) -> Floats:
    """Cost of going from the end of each row's site to the pierce of each column's, `HOME` for the machine's home."""
    travel = problem.travel(*(np.where(sites == HOME, problem.m, sites) for sites in (rows, columns))).astype(
        np.float64
    )
    for lag in problem.lags:
        cost = np.inf if lag.weight is None else float(round(lag.weight * 1000))
        for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
            left = np.flatnonzero((rows != HOME) & (problem.site_contour[rows] == i))
            right = np.flatnonzero((columns != HOME) & (problem.site_contour[columns] == j))
            if lag.cuts == 1:
                travel[np.ix_(left, right)] += cost
    return travel


def _way_home(problem: Problem, ways: Ints) -> Floats:
    """Cost of the last move, with all parts out."""
    home = _travel(problem, ways, np.array([HOME]))
    everything = frozenset(range(problem.n))
    add_settled(problem, everything, ways, np.array([HOME]), home)
    return home[:, 0]


def _least_in(problem: Problem) -> list[float]:
    """For every contour a lower bound on the travel that leads to it."""
    least = []
    for contour in range(problem.n):
        sites = np.array(problem.sites(contour))
        others = np.flatnonzero(~problem.before[contour][problem.site_contour] & (problem.site_contour != contour))
        least.append(float(problem.travel(np.append(others, problem.m), sites).min()))
    return least
