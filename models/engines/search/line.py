"""A route as a line of contours from home to home, and two ways to change it: swap two stretches, reverse one."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Int32s

from .arcs import ArcCosts
from .compiled import compiled
from .orders import OrderLists
from .state import State


@compiled
def lay_out(state: State) -> None:
    """Write the route we stand on into the line; home is at both ends."""
    n = len(state.order_now)
    state.line[0] = state.line[n + 1] = n
    state.place[n] = 0
    for p in range(n):
        c = state.order_now[p]
        state.line[p + 1] = c
        state.place[c] = p + 1


@compiled
def take_up(state: State) -> None:
    """Stand on the line, and make it the trial as well."""
    for p in range(len(state.order_now)):
        c = int(state.line[p + 1])
        state.order_now[p] = state.order[p] = c
        state.position_now[c] = state.position[c] = p


@compiled
def may_swap(orders: OrderLists, line: Int32s, place: Int32s, i: int, j: int, k: int) -> bool:
    """Whether places i … j - 1 and j … k - 1 may be swapped: nothing in the first must come before one in the second.

    It suffices to look at orders with no third contour between: of a chain, one link leads across.
    """
    before = orders.before
    if before[line[j - 1], line[j]] or before[line[i], line[j]] or before[line[j - 1], line[k - 1]]:
        return False
    if j - i <= k - j:
        for p in range(j - 1, i - 1, -1):
            c = line[p]
            for e in range(orders.covered_first[c], orders.covered_first[c + 1]):
                if j <= place[orders.covered[e]] < k:
                    return False
    else:
        for p in range(j, k):
            c = line[p]
            for e in range(orders.covers_first[c], orders.covers_first[c + 1]):
                if i <= place[orders.covers[e]] < j:
                    return False
    return True


@compiled
def may_reverse(orders: OrderLists, line: Int32s, place: Int32s, i: int, k: int) -> bool:
    """Whether places i … k - 1 may be turned round: no order within them."""
    for p in range(i, k):
        c = line[p]
        for e in range(orders.covered_first[c], orders.covered_first[c + 1]):
            if p < place[orders.covered[e]] < k:
                return False
    return True


@compiled
def swap_places(line: Int32s, place: Int32s, spare: Int32s, i: int, j: int, k: int) -> None:
    """Swap places i … j - 1 and j … k - 1; `spare` is room for the shorter of the two."""
    left, right = j - i, k - j
    if left <= right:
        for t in range(left):
            spare[t] = line[i + t]
        for t in range(i, i + right):
            line[t] = line[t + left]
        for t in range(left):
            line[i + right + t] = spare[t]
    else:
        for t in range(right):
            spare[t] = line[j + t]
        for t in range(k - 1, i + right - 1, -1):
            line[t] = line[t - right]
        for t in range(right):
            line[i + t] = spare[t]
    for t in range(i, k):
        place[line[t]] = t


@compiled
def reverse(line: Int32s, place: Int32s, i: int, k: int) -> None:
    """Turn places i … k - 1 round."""
    a, b = i, k - 1
    while a < b:
        line[a], line[b] = line[b], line[a]
        a, b = a + 1, b - 1
    for t in range(i, k):
        place[line[t]] = t


@compiled
def sum_reversed(arcs: ArcCosts, state: State, start: int) -> None:
    """`turned[p]`: by how much places 0 … p cost more when gone through the other way; right up to `start` already."""
    line = state.line
    for p in range(max(start, 1), len(line)):
        a, b = line[p - 1], line[p]
        state.turned[p] = state.turned[p - 1] + np.int64(arcs.cost[b, a]) - np.int64(arcs.cost[a, b])
