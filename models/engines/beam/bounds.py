"""What every plan still costs after a state: bounds that a child takes over from its parent in a few additions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.problem.problem import Problem

from .kernels import count_visits, look_ahead
from .tables import NEVER, way_home


@dataclass(frozen=True, eq=False, slots=True)
class Bound:
    """b bounds of one form, of which the greatest counts.

    After d contours, the last at site s, the rest of the plan costs at least `to_go[k, d, s]` and `price[k, c]` for
    every contour c that is not yet cut. `to_go` is (b, n + 1, m), `price` (b, n); after n contours `to_go` is exact,
    infinite where no lawful move leads home.
    """

    to_go: Floats
    price: Floats


def least_in_and_out(problem: Problem, travel: Ints) -> Bound:
    """Every contour left must be reached, and left again, by the least lawful move; `travel` as in `BeamTables`."""
    n, m = problem.n, problem.m
    reach, leave = travel.min(axis=0), travel.min(axis=1)
    into = np.minimum.reduceat(reach[:m] + problem.site_cost, problem.first[:-1])
    out = np.minimum.reduceat(leave[:m] + problem.site_cost, problem.first[:-1])
    to_go = np.empty((2, n + 1, m))
    to_go[0] = reach[m]
    to_go[1] = leave[:m]
    to_go[:, n] = way_home(problem, travel)
    return Bound(to_go, np.stack([into, out]).astype(np.float64))


# A bound by priced walks of n steps that each land where the orders allow a contour at that place.
#
# A plan is such a walk that visits every contour once. A price on contours, taken off for each visit and charged
# once, changes the cost of no plan but discourages walks that visit one contour often and another never (Held and
# Karp 1971; walks by place in the order: Picard and Queyranne 1978). Walks that turn back at once, i–j–i, are left
# out (Houck and others 1980).
#
# `bounds/completion.py` bounds by walks as well, and its walks remember more than where they came from. The beam does
# not use it: its bound is nearer to the plan (0.81 to 0.91 of it from the start, not 0.70 to 0.79), but takes so much
# longer that the beam took 1.4 times the processor time until the proof, at four contours remembered, and was as wide
# in the end on most problems (three problems of 40 to 60 contours with a hard order for two pairs in three or more;
# medians of three pairs of runs).

GRAIN = 64.0
"""Prices are whole 64ths, so that their sums with costs are exact in doubles."""
MOST_ROUNDS = 300
PATIENCE = 8
"""Rounds without a better bound before the steps become shorter."""
SHORTER = 0.7
SHORTEST = 1e-3
INERTIA = 0.6
"""Share of the direction of a step that comes from the steps before."""


def walk_operations(problem: Problem, travel: Ints) -> int:
    """What one round takes."""
    return 2 * problem.n * int((travel < NEVER).sum()) // 3 + 1


def priced_walks(
    problem: Problem, travel: Ints, known: Bound, target: int, rounds: int, pay: Callable[[int], None]
) -> Bound:
    """The bound at the best prices found in so many rounds of subgradient steps.

    Parameters
    ----------
    problem, travel
        What is bounded, and its `travel_table`.
    known
        Bounds whose prices are a start.
    target
        Cost of a plan: steps aim at it.
    rounds
        How many walks are looked at, at the most `MOST_ROUNDS`.
    pay
        Called after each round with the operations that it took.
    """
    n, m = problem.n, problem.m
    rows, columns = np.nonzero(travel[:, :m] < NEVER)
    arc_from = np.searchsorted(rows, np.arange(m + 2)).astype(np.int64)
    arc_to = columns.astype(np.int64)
    arc_cost = (travel[rows, columns] + problem.site_cost[columns]).astype(np.float64)
    owner = np.append(problem.site_contour, n)
    earliest = problem.before.sum(axis=0).astype(np.int64)
    latest = (n - 1 - problem.before.sum(axis=1)).astype(np.int64)
    least, second = np.full((n + 1, m + 1), np.inf), np.full((n + 1, m + 1), np.inf)
    contour, step, second_step = (np.full((n + 1, m + 1), -1, dtype=np.int64) for _ in range(3))
    least[n, :m] = second[n, :m] = way_home(problem, travel)
    visits = np.zeros(n, dtype=np.int64)

    price = np.rint(np.minimum(known.price, target).mean(axis=0) * GRAIN) / GRAIN
    best, best_price, drift, length, waited = -np.inf, price, np.zeros(n), 1.0, 0
    cost = walk_operations(problem, travel)
    for _ in range(min(rounds, MOST_ROUNDS)):
        look_ahead(
            arc_from, arc_to, arc_cost, owner, price, earliest, latest, least, contour, step, second, second_step
        )
        pay(cost)
        bound = least[0, m] + price.sum()
        if bound > best:
            best, best_price, waited = bound, price, 0
        else:
            waited += 1
        if bound > target or length < SHORTEST:
            break
        count_visits(owner, contour, step, second_step, visits)
        if waited > PATIENCE:
            price, length, waited = best_price, SHORTER * length, 0
        if (visits == 1).all():
            break
        drift = INERTIA * drift + (1 - INERTIA) * (1 - visits)
        price = price + length * max(target - bound, 1.0) / max(1.0, float(drift @ drift)) * drift
        price = np.rint(np.clip(price, -target, target) * GRAIN) / GRAIN
    look_ahead(
        arc_from, arc_to, arc_cost, owner, best_price, earliest, latest, least, contour, step, second, second_step
    )
    return Bound(least[None, :, :m].copy(), best_price[None, :])
