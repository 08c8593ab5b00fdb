"""Prices on sites, so that a model of contours alone knows something of sites.

Taking the cheapest arc between every two contours allows a route to come to a contour at one site and leave it from
another. A price that is paid for coming to a site and given back for leaving from it changes the cost of no real
route, but makes that dear. Good prices are found by subgradients (Held and Karp 1971) on the cheapest assignment of
a successor to every contour, whose cost is a lower bound already.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from kerfwise.arrays import Ints
from kerfwise.models.problem.problem import Problem

from .arcs import ArcLiterals
from .in_time import GoOn, always

ROUNDS = 200
EFFORT = 100_000_000
"""Numbers to look at in all rounds together: large nests get fewer rounds."""
PATIENCE = 8
"""Rounds without a better bound after which the steps become shorter."""
NEVER = 1e15
"""Cost of an arc that there is not, µm: more than any route."""


@dataclass(frozen=True, eq=False, slots=True)
class PricedArcs:
    """One arc between every two contours, which no route undercuts, and what every route costs at least, µm.

    In these arcs a site is a contour; what using a site costs is in the arcs that reach it.
    """

    arcs: ArcLiterals
    bound: int


def price_sites(
    problem: Problem, arcs: ArcLiterals, target_um: int | None, rounds: int = ROUNDS, go_on: GoOn = always
) -> PricedArcs:
    """Look for prices that make the bound as high as can be; `target_um` is the cost of a known route.

    `go_on` is asked every round.
    """
    costs = arcs.cost + np.append(problem.site_cost, 0)[arcs.head]
    prices = best = np.zeros(problem.m + 1, dtype=np.int64)
    bound, step, waited = 0.0, 1.0, 0
    for _ in range(min(rounds, EFFORT // (len(costs) + (problem.n + 1) ** 2))):
        go_on()
        least, reached = _assigned(problem.n, arcs, costs + prices[arcs.head] - prices[arcs.tail])
        if least > bound:
            bound, best, waited = least, prices, 0
        else:
            waited += 1
        if waited == PATIENCE:
            prices, step, waited = best, step * 0.7, 0
            continue
        uneven = np.bincount(arcs.head[reached], minlength=problem.m + 1)
        uneven -= np.bincount(arcs.tail[reached], minlength=problem.m + 1)
        uneven[problem.m] = 0
        if not uneven.any() or bound >= NEVER:
            break
        missing = max(0.0, (1.1 * bound if target_um is None else target_um) - least)
        prices = prices + np.rint(step * missing / (uneven @ uneven) * uneven).astype(np.int64)
    cost = np.minimum.reduceat(costs + best[arcs.head] - best[arcs.tail], arcs.first[:-1])
    contours = ArcLiterals(arcs.groups, np.arange(len(cost) + 1), arcs.groups[:, 0], arcs.groups[:, 1], cost)
    return PricedArcs(contours, int(bound))


def _assigned(n: int, arcs: ArcLiterals, costs: Ints) -> tuple[float, Ints]:
    """The cheapest assignment of a successor to every contour and to home, and its arcs."""
    least = np.minimum.reduceat(costs, arcs.first[:-1])
    matrix = np.full((n + 1, n + 1), NEVER)
    matrix[arcs.groups[:, 0], arcs.groups[:, 1]] = least
    rows, columns = linear_sum_assignment(matrix)
    chosen = np.zeros((n + 1, n + 1), dtype=np.bool_)
    chosen[rows, columns] = True
    sizes = np.diff(arcs.first)
    in_chosen = np.repeat(chosen[arcs.groups[:, 0], arcs.groups[:, 1]], sizes)
    cheapest = np.flatnonzero(in_chosen & (costs == np.repeat(least, sizes)))
    _, one_each = np.unique(np.repeat(np.arange(len(sizes)), sizes)[cheapest], return_index=True)
    return float(matrix[rows, columns].sum()), cheapest[one_each]
