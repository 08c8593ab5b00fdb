"""Arcs as chains of exchanges read them, and the state and first route of such a search."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.models.engines.search.state.route_state import BEST, NUMBERS, OrderLists, SearchTables
from kerfwise.models.engines.tuning import BREADTH, DETOURS, FEWEST, SAMPLE, SPARSE, TYPICAL
from kerfwise.models.engines.tuning import CHAINS_MOST as MOST
from kerfwise.models.engines.tuning import CHAINS_NEAREST as NEAREST
from kerfwise.models.problem.precedence import lawful_followers

# Arcs as chains of exchanges read them, and on which problems chains are tried.

UNLAWFUL = 1 << 30
"""Stands for the cost of an arc that no lawful order has; a sum of a few is a small number still."""


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
    costs = fields.arcs.cost.astype(np.int64)
    cost = reduced_costs(costs, lawful)
    if cost[lawful].max(initial=0) >= UNLAWFUL:  # sums of a few would be no small numbers
        cost = costs
    cost = np.where(lawful, cost, UNLAWFUL)
    return ChainTables(
        fields.legs.n,
        np.ascontiguousarray(cost.astype(np.int32)),
        _nearest(cost, costs),
        _nearest(cost.T, costs.T),
        fields.orders,
    )


def _nearest(cost: Ints, costs: Ints) -> Int32s:
    """The ends of the cheapest lawful arcs of each row; where reduced costs are the same, the cheaper first."""
    by_cost = np.lexsort((costs, cost), axis=1)[:, :NEAREST]
    near = np.where(np.take_along_axis(cost, by_cost, axis=1) < UNLAWFUL, by_cost, -1)
    return np.ascontiguousarray(near.astype(np.int32))


def typical_cost(tables: ChainTables) -> float:
    """Mean reduced cost of the nearest arcs."""
    rows = np.arange(tables.n + 1)[:, None]
    near = tables.near[:, :TYPICAL]
    costs: Ints = tables.cost[rows, near].astype(np.int64)
    return float(costs[near >= 0].mean())


# What arcs cost beyond the cheapest assignment of a successor to everyone.
#
# A tour is an assignment, too. So every tour costs the assignment's cost and, above that, the reduced costs of its
# arcs: none of them is below zero, and most arcs of a good tour are at zero where costs differ much both ways.


def reduced_costs(cost: Ints, lawful: Bools) -> Ints:
    """Reduced costs (k, k) of arcs that cost `cost` (k, k), whole numbers at least 0 wherever the arc is lawful.

    What an unlawful arc has in its place means nothing. Some lawful arcs must make an assignment.

    Examples
    --------
    >>> lawful = ~np.eye(3, dtype=bool)
    >>> reduced_costs(np.array([[0, 2, 5], [4, 0, 3], [1, 6, 0]]), lawful).tolist()[0]
    [-2, 0, 3]
    """
    from scipy.optimize import linear_sum_assignment  # it takes longer to load than a small nest to plan

    size = len(cost)
    far = (int(cost[lawful].max(initial=0)) + 1) * (size + 1)
    dear = np.where(lawful, cost, far).astype(np.int64)
    assigned = linear_sum_assignment(dear)[1]
    taken = dear[np.arange(size), assigned]
    more = dear - taken[:, None]  # than what the assignment takes: no circle of such changes is below zero
    into = np.zeros(size, dtype=np.int64)
    while True:
        least = np.minimum(into, (more + into[assigned][:, None]).min(axis=0))
        if (least == into).all():
            break
        into = least
    out_of = taken - into[assigned]
    return np.asarray(cost - out_of[:, None] - into[None, :], dtype=np.int64)


# The state of a search by chains: the route it stands on and the one it tries, and room to work in.

WIDEST = max(BREADTH)
DEPTH = len(BREADTH)

# What `ChainState.number` holds beside what `search.state` names.
QUEUED = NUMBERS  # contours in the queue
FRONT = NUMBERS + 1  # where in the ring the first of them is
LOW = NUMBERS + 2  # the places where the trial differs from the route we stand on are LOW …
HIGH = NUMBERS + 3  # … HIGH - 1


class ChainState(NamedTuple):
    """Arrays that kernels write to.

    `line` lists the contours of the trial between home and home, `place` says where each stands, `stood` is the route
    we stand on in the same form. `queue` is a ring of the contours that arcs may be broken after, `waits` says who is
    in it. Step k at depth d swaps places `swap[d, k, 0]` … `swap[d, k, 1] - 1` and … `swap[d, k, 2] - 1`; then
    `freed[d, k]` has been saved, without the last arc that closes the line, which costs `closing[d, k]`.
    `tail[d]` are the contours after which the step taken at depth d made arcs, `trying[d]` is that step, one of
    `known[d]`. `best` lists sites in order.
    """

    line: Int32s
    place: Int32s
    spare: Int32s
    stood: Int32s
    queue: Ints
    waits: Bools
    swap: Ints
    freed: Ints
    closing: Ints
    tail: Ints
    trying: Ints
    known: Ints
    best: Ints
    number: Ints
    random: NDArray[np.uint64]


def new_chain_state(tables: ChainTables, seed: tuple[int, ...]) -> ChainState:
    """An empty state; equal seeds walk equal ways."""
    n = tables.n
    number = np.zeros(HIGH + 1, dtype=np.int64)
    number[BEST] = -1
    return ChainState(
        line=np.full(n + 2, n, dtype=np.int32),
        place=np.zeros(n + 1, dtype=np.int32),
        spare=np.zeros(n + 2, dtype=np.int32),
        stood=np.full(n + 2, n, dtype=np.int32),
        queue=np.zeros(n + 1, dtype=np.int64),
        waits=np.zeros(n + 1, dtype=np.bool_),
        swap=np.zeros((DEPTH, WIDEST, 3), dtype=np.int64),
        freed=np.zeros((DEPTH, WIDEST), dtype=np.int64),
        closing=np.zeros((DEPTH, WIDEST), dtype=np.int64),
        tail=np.zeros((DEPTH, 3), dtype=np.int64),
        trying=np.zeros(DEPTH, dtype=np.int64),
        known=np.zeros(DEPTH, dtype=np.int64),
        best=np.full(n, -1, dtype=np.int64),
        number=number,
        random=np.random.SeedSequence(seed).generate_state(1, np.uint64) | np.uint64(1),
    )


# The first route: always on to the lawful contour of the least reduced cost.


def nearest_lawful(tables: ChainTables) -> Ints:
    """Contours (n,) in an order that keeps the orders."""
    n, before = tables.n, tables.orders.before
    waits_for = before.sum(axis=0)
    out = np.zeros(n, dtype=np.bool_)
    route = np.zeros(n, dtype=np.int64)
    here = n
    for at in range(n):
        free = np.flatnonzero(~out & (waits_for == 0))
        here = int(free[np.argmin(tables.cost[here, free])])
        route[at], out[here] = here, True
        waits_for -= before[here]
    return route
