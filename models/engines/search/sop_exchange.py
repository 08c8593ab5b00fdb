"""Swapping two adjacent stretches so that two near contours follow each other (SOP 3-exchange).

Gambardella and Dorigo 2000: no stretch is turned round, so only orders across the two stretches matter; they are
checked as the scan goes.
"""

from __future__ import annotations

from .chance import below
from .compiled import compiled
from .legs import leg
from .orders import OrderLists
from .sites import FAR
from .state import LENGTH, WORK, State
from .tables import SearchTables


@compiled
def swap_towards(tables: SearchTables, state: State, limit: float) -> bool:
    """Bring a contour and a near one together by the best swap, if travel grows by less than `limit`."""
    orders = tables.orders
    n = state.number[LENGTH]
    x = state.order[below(state.random, n)]
    y = orders.near[x, below(state.random, orders.near.shape[1])]
    if y < 0 or state.position[y] == state.position[x] + 1:
        return False
    i, j, k, change = -1, -1, -1, FAR
    if state.position[y] > state.position[x]:
        i, j, k, change = _bring_back(tables, state, state.position[x] + 1, state.position[y])
        i2, j2, k2, change2 = _bring_forth(tables, state, state.position[x] + 1, state.position[y])
        if change2 < change:
            i, j, k, change = i2, j2, k2, change2
    else:
        i, j, k, change = _bring_before(tables, state, state.position[y], state.position[x] + 1)
    i3, k3, change3 = _turn_between(tables, state, state.position[x], state.position[y])
    if min(change, change3) >= limit:
        return False
    if change <= change3:
        _swap(state, i, j, k)
    else:
        _turn(state, i3, k3)
    return True


@compiled
def _leg_between(tables: SearchTables, state: State, p: int, q: int) -> int:
    """Travel from the contour at position p to that at q, home beyond either end."""
    legs = tables.legs
    a = state.site[state.order[p]] if p >= 0 else legs.m
    b = state.site[state.order[q]] if q < legs.n else legs.m
    return leg(legs, a, b)


@compiled
def _change(tables: SearchTables, state: State, i: int, j: int, k: int) -> int:
    """By how much travel grows when positions i … j - 1 and j … k - 1 are swapped."""
    return (
        _leg_between(tables, state, i - 1, j)
        + _leg_between(tables, state, k - 1, i)
        + _leg_between(tables, state, j - 1, k)
        - _leg_between(tables, state, i - 1, i)
        - _leg_between(tables, state, j - 1, j)
        - _leg_between(tables, state, k - 1, k)
    )


@compiled
def _earliest(orders: OrderLists, state: State, at: int, lo: int, hi: int) -> int:
    """Last position in lo … hi - 1 of one that must come before the contour at position `at`; lo - 1 if none."""
    found = lo - 1
    c = state.order[at]
    for e in range(orders.covers_first[c], orders.covers_first[c + 1]):
        where = state.position[orders.covers[e]]
        if lo <= where < hi:
            found = max(found, where)
    return found


@compiled
def _bring_back(tables: SearchTables, state: State, i: int, j: int) -> tuple[int, int, int, int]:
    """The best k to swap i … j - 1 with j … k - 1: what stands at j moves to i."""
    orders = tables.orders
    n = state.number[LENGTH]
    best, best_k = FAR, -1
    if _parts_block(orders, state, i) or _parts_block(orders, state, j):
        return i, j, best_k, best
    for k in range(j + 1, n + 1):
        state.number[WORK] += 8
        if _earliest(orders, state, k - 1, i, j) >= i:
            break
        if _parts_block(orders, state, k):
            continue
        change = _change(tables, state, i, j, k)
        if change < best:
            best, best_k = change, k
    return i, j, best_k, best


@compiled
def _bring_forth(tables: SearchTables, state: State, j: int, k: int) -> tuple[int, int, int, int]:
    """The best i to swap i … j - 1 with j … k - 1: what stands at j - 1 moves to just before k."""
    orders = tables.orders
    best, best_i = FAR, -1
    if _parts_block(orders, state, j) or _parts_block(orders, state, k):
        return best_i, j, k, best
    for i in range(j - 1, -1, -1):
        state.number[WORK] += 8
        c = state.order[i]
        stuck = False
        for e in range(orders.covered_first[c], orders.covered_first[c + 1]):
            if j <= state.position[orders.covered[e]] < k:
                stuck = True
        if stuck:
            break
        if _parts_block(orders, state, i):
            continue
        change = _change(tables, state, i, j, k)
        if change < best:
            best, best_i = change, i
    return best_i, j, k, best


@compiled
def _bring_before(tables: SearchTables, state: State, i: int, k: int) -> tuple[int, int, int, int]:
    """The best j to swap i … j - 1 with j … k - 1: what stands at k - 1 comes just before what stands at i."""
    orders = tables.orders
    best, best_j = FAR, -1
    if _parts_block(orders, state, i) or _parts_block(orders, state, k):
        return i, best_j, k, best
    needed = k  # the stretch moved must reach down to here, for the sake of what must come before its members
    for j in range(k - 1, i, -1):
        state.number[WORK] += 8
        c = state.order[j]
        for e in range(orders.covers_first[c], orders.covers_first[c + 1]):
            where = state.position[orders.covers[e]]
            if where >= i:
                needed = min(needed, where)
        if needed <= i:
            break
        if needed < j or _parts_block(orders, state, j):
            continue
        change = _change(tables, state, i, j, k)
        if change < best:
            best, best_j = change, j
    return i, best_j, k, best


@compiled
def _turn_between(tables: SearchTables, state: State, at: int, to: int) -> tuple[int, int, int]:
    """Turning round the stretch that brings what stands at `at` before what stands at `to`: its bounds, the change."""
    orders = tables.orders
    i, k = (at + 1, to + 1) if at < to else (to, at)
    if i >= k - 1 or _parts_block(orders, state, i) or _parts_block(orders, state, k):
        return i, k, FAR
    change = (
        _leg_between(tables, state, i - 1, k - 1)
        + _leg_between(tables, state, i, k)
        - _leg_between(tables, state, i - 1, i)
        - _leg_between(tables, state, k - 1, k)
    )
    for p in range(i + 1, k):
        state.number[WORK] += 8
        if _earliest(orders, state, p, i, p) >= i:
            return i, k, FAR
        change += _leg_between(tables, state, p, p - 1) - _leg_between(tables, state, p - 1, p)
    return i, k, change


@compiled
def _turn(state: State, i: int, k: int) -> None:
    """Turn positions i … k - 1 of the trial round; all of them, and those beside them, become stale."""
    for p in range(i, k):
        c = state.order_now[i + k - 1 - p]
        state.order[p] = c
        state.position[c] = p
        state.stale[c] = True
    if i > 0:
        state.stale[state.order[i - 1]] = True
    if k < state.number[LENGTH]:
        state.stale[state.order[k]] = True


@compiled
def _parts_block(orders: OrderLists, state: State, at: int) -> bool:
    if at <= 0 or at >= state.number[LENGTH]:
        return False
    return bool(orders.block[state.order[at - 1]] == orders.block[state.order[at]])


@compiled
def _swap(state: State, i: int, j: int, k: int) -> None:
    """Swap positions i … j - 1 and j … k - 1 of the trial; the contours at the three seams become stale."""
    for p in range(j, k):
        state.order[i + p - j] = state.order_now[p]
    for p in range(i, j):
        state.order[k - j + p] = state.order_now[p]
    for p in range(i, k):
        state.position[state.order[p]] = p
    for seam in (i, i + k - j, k):
        if seam > 0:
            state.stale[state.order[seam - 1]] = True
        if seam < state.number[LENGTH]:
            state.stale[state.order[seam]] = True
