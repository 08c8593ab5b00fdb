"""Arcs as chains of exchanges read them, and on which problems chains are tried."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.models.engines.search.orders import OrderLists
from kerfwise.models.engines.search.tables import SearchTables
from kerfwise.models.problem.successors import lawful_followers

from .reduced_costs import reduced_costs

NEAREST = 10
"""Arcs out of every contour that steps make."""
UNLAWFUL = 1 << 30
"""Stands for the cost of an arc that no lawful order has; a sum of a few is a small number still."""
SPARSE, FEWEST, MOST = 0.5, 60, 3000
"""Chains are tried where orders decide less than this share of the pairs of contours, and for so many contours."""
DETOURS, SAMPLE = 0.1, 60
"""Share of arcs and contours that there is a cheaper way by, from which on costs are not taken for distances, and of
how many contours it is counted. Where they are distances, annealing does as well or better."""
TYPICAL = 5
"""Nearest arcs by whose cost temperatures are chosen."""


class ChainTables(NamedTuple):
    """Contours 0 … n - 1 and home, n: `cost` (n + 1, n + 1) are reduced costs.

    `near[a]` lists the arcs out of a that cost least, the cheapest first, filled up with -1;
    `near_in[b]` the ends of those into b.
    """

    n: int
    cost: Int32s
    near: Int32s
    near_in: Int32s
    orders: OrderLists


def chained(fields: SearchTables) -> bool:
    """Whether chains are to be tried.

    Each contour has one site, orders alone bind, they decide little, and costs are no distances.
    """
    n = fields.legs.n
    decided = int(fields.orders.before.sum()) / max(1, n * (n - 1) // 2)
    plain = fields.arcs.plain > 0 and FEWEST <= n <= MOST
    return plain and decided < SPARSE and detour_share(fields) > DETOURS


def detour_share(fields: SearchTables) -> float:
    """How often it is cheaper to go by a third contour than straight on, of all that the orders allow.

    In a plane never; where costs are drawn by chance, of one in six.
    """
    few = np.linspace(0, fields.legs.n - 1, min(SAMPLE, fields.legs.n)).astype(np.int64)
    lawful = _lawful(fields)[np.ix_(few, few)]
    cost = fields.arcs.cost[np.ix_(few, few)].astype(np.int64)
    ways = lawful[:, :, None] & lawful[None, :, :] & lawful[:, None, :]
    cheaper = cost[:, :, None] + cost[None, :, :] < cost[:, None, :]
    return float((ways & cheaper).sum() / max(1, ways.sum()))


def _lawful(fields: SearchTables) -> Bools:
    return lawful_followers(fields.orders.before, np.arange(fields.legs.n, dtype=np.int64)).whole()


def make_chain_tables(fields: SearchTables) -> ChainTables:
    """The arcs of a plain problem."""
    lawful = _lawful(fields)
    given = fields.arcs.cost.astype(np.int64)
    cost = reduced_costs(given, lawful)
    if cost[lawful].max(initial=0) >= UNLAWFUL:  # sums of a few would be no small numbers
        cost = given
    cost = np.where(lawful, cost, UNLAWFUL)
    return ChainTables(
        fields.legs.n,
        np.ascontiguousarray(cost.astype(np.int32)),
        _nearest(cost, given),
        _nearest(cost.T, given.T),
        fields.orders,
    )


def _nearest(cost: Ints, given: Ints) -> Int32s:
    """The ends of the cheapest lawful arcs of each row; where reduced costs are the same, the cheaper first."""
    by_cost = np.lexsort((given, cost), axis=1)[:, :NEAREST]
    near = np.where(np.take_along_axis(cost, by_cost, axis=1) < UNLAWFUL, by_cost, -1)
    return np.ascontiguousarray(near.astype(np.int32))


def typical_cost(tables: ChainTables) -> float:
    """Mean reduced cost of the nearest arcs."""
    rows = np.arange(tables.n + 1)[:, None]
    near = tables.near[:, :TYPICAL]
    costs: Ints = tables.cost[rows, near].astype(np.int64)
    return float(costs[near >= 0].mean())
