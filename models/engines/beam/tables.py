"""A problem as the flat arrays that the kernels read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Floats, Int32s, Ints
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.models.engines.ideals.stretch import OrderSets, StepTerms, localise
from kerfwise.models.problem.crossings import FORBIDDEN, in_order
from kerfwise.models.problem.problem import Problem

NEVER = int(np.iinfo(np.int32).max)
"""The cost of a move that is not lawful; others cost less."""


class BeamTables(NamedTuple):
    """What the kernels of a beam read of a problem of n contours and m sites.

    `travel` (m + 1, m + 1) has what a move costs whatever is out, home last. `orders` and `terms` are those of the
    sweep over ideals, with the whole problem for a stretch.
    The crossings of a move are `cross_from[k]` … `cross_from[k + 1] - 1` with k = `cross_at[leave, reach]` (-1: none),
    each with its own price `cross_cost`, `FORBIDDEN` where it must not be; `cross_at` is (0, 0) where nothing is
    crossed.
    """

    first: Ints
    site_contour: Ints
    travel: Int32s
    orders: OrderSets
    terms: StepTerms
    cross_at: Int32s
    cross_from: Ints
    cross_over: Ints
    cross_cost: Ints


def make_beam_tables(problem: Problem, travel: Ints) -> BeamTables:
    """The arrays of a problem, with its `travel_table`."""
    whole = localise(problem, tuple(range(problem.n)), frozenset())
    cross_at, cross_from, order = _crossings(problem)
    return BeamTables(
        first=problem.first,
        site_contour=problem.site_contour,
        travel=travel.astype(np.int32),
        orders=whole.orders,
        terms=whole.terms,
        cross_at=cross_at,
        cross_from=cross_from,
        cross_over=(problem.crossings.over if order is None else problem.crossings.over[order]).astype(np.int64),
        cross_cost=problem.crossings.cost if order is None else problem.crossings.cost[order],
    )


def travel_table(problem: Problem) -> Ints:
    """What every move costs before anything is out, (m + 1, m + 1); `NEVER` for those that no lawful order has."""
    everywhere = np.arange(problem.m + 1)
    travel = problem.travel(everywhere, everywhere)
    owner = np.append(problem.site_contour, problem.n)
    for lag in problem.lags:
        if lag.weight is not None and lag.cuts == 1:
            cost = cost_um(lag.weight)
            for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
                travel[np.ix_(owner == i, owner == j)] += cost
    travel[~problem.successors()[np.ix_(owner, owner)]] = NEVER
    return travel


def way_home(problem: Problem, travel: Ints) -> Floats:
    """What the last move of a plan costs from every site (m,), infinite where it is not lawful: everything is out."""
    cost = travel[: problem.m, problem.m].astype(np.float64)
    cost[cost == NEVER] = np.inf
    rows = problem.crossings
    last = (rows.reach == problem.m) & (rows.leave < problem.m)
    np.add.at(cost, rows.leave[last], np.where(rows.cost[last] == FORBIDDEN, np.inf, rows.cost[last]))
    return cost


def _crossings(problem: Problem) -> tuple[Int32s, Ints, Ints | None]:
    """Where the crossings of every move are, and the rows of `problem.crossings` in that order; None as they stand."""
    rows, m = problem.crossings, problem.m
    if not len(rows):
        return np.zeros((0, 0), dtype=np.int32), np.zeros(1, dtype=np.int64), np.zeros(0, dtype=np.int64)
    move = rows.moves(m)
    order = in_order(move)
    if order is not None:
        move = move[order]
    start = np.flatnonzero(np.diff(move, prepend=-1))
    at = np.full((m + 1) * (m + 1), -1, dtype=np.int32)
    at[move[start]] = np.arange(len(start))
    return at.reshape(m + 1, m + 1), np.append(start, len(move)).astype(np.int64), order
