"""Exchanges that turn a stretch round, for problems where most arcs cost the same both ways."""

from __future__ import annotations

from typing import cast

import numpy as np

from .arcs import gap_cost
from .chance import high, rather_low, short
from .compiled import compiled
from .line import may_reverse, may_swap, reverse, sum_reversed, swap_places
from .state import NO, YES, State
from .tables import SearchTables

KINDS = cast(int, np.int64(6))


@compiled
def try_reversal(tables: SearchTables, state: State, where: np.uint64, how: np.uint64, limit: float) -> int:
    """Turn a stretch round, or move one turned, if the cost grows by at most `limit`; answers by how much it does.

    An arc x → y to a near contour is made, x standing before y but where a stretch moves back.
    """
    arcs, line = tables.arcs, state.line
    n = tables.legs.n
    p = high(where, n + 1)
    x = line[p]
    if arcs.near_count[x] == 0:
        return 0
    y = arcs.near[x, rather_low(where, arcs.near_count[x])]
    q = int(np.int64(state.place[y]))
    kind = high(how, KINDS)
    size = short(how)
    if kind == 0:
        return _reverse(tables, state, p + 1, q + 1, limit)
    if kind == 1:
        return _reverse(tables, state, p, q, limit)
    if kind == 2:
        return _move(tables, state, p + 1, q + 1 - size, q + 1, NO, limit)
    if kind == 3:
        return _move(tables, state, p + 1, p + 1 + size, q + 1, NO, limit)
    if kind == 4:
        return _move(tables, state, p, p + size, q, YES, limit)
    return _move(tables, state, q + 1 - size, q + 1, p + 1, YES, limit)


@compiled
def _reverse(tables: SearchTables, state: State, i: int, k: int, limit: float) -> int:
    """Turn places i … k - 1 round."""
    arcs, line = tables.arcs, state.line
    if i < 1 or k < i + 2:
        return 0
    change = (
        np.int64(arcs.cost[line[i - 1], line[k - 1]])
        + np.int64(arcs.cost[line[i], line[k]])
        - gap_cost(arcs, line, i)
        - gap_cost(arcs, line, k)
        + state.turned[k - 1]
        - state.turned[i]
    )
    if change > limit or not may_reverse(tables.orders, line, state.place, i, k):
        return 0
    reverse(line, state.place, i, k)
    sum_reversed(arcs, state, i)
    return int(change)


@compiled
def _move(tables: SearchTables, state: State, i: int, j: int, k: int, first: bool, limit: float) -> int:
    """Swap places i … j - 1 and j … k - 1 and turn one of them, the one that stood first or the other."""
    arcs, line, place = tables.arcs, state.line, state.place
    if i < 1 or j <= i or k <= j:
        return 0
    a, b = (i, j) if first else (j, k)
    if first:
        change = np.int64(arcs.cost[line[i - 1], line[j]]) + np.int64(arcs.cost[line[k - 1], line[j - 1]])
        change += np.int64(arcs.cost[line[i], line[k]])
    else:
        change = np.int64(arcs.cost[line[i - 1], line[k - 1]]) + np.int64(arcs.cost[line[j], line[i]])
        change += np.int64(arcs.cost[line[j - 1], line[k]])
    change += state.turned[b - 1] - state.turned[a]
    change -= gap_cost(arcs, line, i) + gap_cost(arcs, line, j) + gap_cost(arcs, line, k)
    if change > limit or not may_swap(tables.orders, line, place, i, j, k):
        return 0
    if not may_reverse(tables.orders, line, place, a, b):
        return 0
    reverse(line, place, a, b)
    swap_places(line, place, state.spare, i, j, k)
    sum_reversed(arcs, state, i)
    return int(change)
