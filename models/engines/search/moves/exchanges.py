"""Exchanges: two stretches swapped, or a short arc made and the gaps closed by others."""

from __future__ import annotations

from typing import cast

import numpy as np

from kerfwise.models.engines.search.state.jit_tools import (
    below,
    chunk,
    compiled,
    draw_number,
    high,
    is_odd,
    rather_low,
    short,
)
from kerfwise.models.engines.search.state.route_state import (
    BEST,
    COST,
    LENGTH,
    NO,
    ONE,
    PRICE,
    TRADED,
    TRADES,
    WORK,
    YES,
    OrderLists,
    SearchTables,
    State,
    lay_out,
    may_reverse,
    may_swap,
    reverse,
    sum_reversed,
    swap_places,
    take_up,
)
from kerfwise.models.engines.search.state.travel import fare, gap_cost
from kerfwise.models.engines.tuning import PER_TRIAL

from .insertion import FAR

# Swapping two adjacent stretches so that two near contours follow each other (SOP 3-exchange).
#
# Gambardella and Dorigo 2000: no stretch is turned round, so only orders across the two stretches matter; they are
# checked as the scan goes.


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
    return fare(legs, a, b, state.number[PRICE])


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


# Exchanges that turn a stretch round, for problems where most arcs cost the same both ways.

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


# Exchanges by the million: make a short arc, close the gaps by another, and see whether that may be.
#
# Of the exchanges of three arcs (Gambardella and Dorigo 2000) each trial draws one: an arc x → y to a near contour,
# and where the line is cut the third time; its cost is known at once, and orders are looked at only for those cheap
# enough.


@compiled
def three_opt(tables: SearchTables, state: State, temperature: float, trials: int) -> None:
    """Try exchanges on the route we stand on, and take those that the temperature lets pass. For plain problems."""
    arcs = tables.arcs
    lay_out(state)
    if arcs.even > 0:
        sum_reversed(arcs, state, ONE)
    cost, best = state.number[COST], state.number[BEST]
    taken = 0
    for _ in range(trials):
        where, how = draw_number(state.random), draw_number(state.random)
        limit = temperature * arcs.falls[chunk(how)]
        if arcs.even > 0 and is_odd(where):
            change = try_reversal(tables, state, where, how, limit)
        else:
            change = _try_swap(tables, state, where, how, limit)
        if change != 0:
            cost += change
            taken += 1
            if cost < best:
                best = cost
                for p in range(tables.legs.n):
                    state.best[p] = state.line[p + 1]
    state.number[WORK] += PER_TRIAL * trials + taken * tables.legs.n // 2
    state.number[TRADES] += trials
    state.number[TRADED] += taken
    state.number[BEST] = best
    state.number[COST] = cost
    take_up(state)


@compiled
def _try_swap(tables: SearchTables, state: State, where: np.uint64, how: np.uint64, limit: float) -> int:
    """Swap two adjacent stretches if the cost grows by at most `limit`; answers by how much it does.

    Arcs a → a', b → b', c → c', in this order along the line, become a → b', c → a', b → c'. Given x → y, one of
    these, the third cut is where the line may be closed: before x, after y or between them if y comes first.
    """
    arcs, line, place = tables.arcs, state.line, state.place
    n = tables.legs.n
    p = high(where, n + 1)
    x = line[p]
    if arcs.near_count[x] == 0:
        return 0
    y = arcs.near[x, rather_low(where, arcs.near_count[x])]
    q = int(np.int64(place[y]))
    if q == p + 1:
        return 0
    follows, leads = line[p + 1], line[q - 1]
    c = _third(tables, state, p, q, how)
    if q > p:
        if q < c <= n + 1:
            i, j, k = p + 1, q, c
        elif 1 <= c <= p:
            i, j, k = c, p + 1, q
        else:
            return 0
    elif q < c <= p:
        i, j, k = q, c, p + 1
    else:
        return 0
    a, b = line[c - 1], line[c]
    change = (
        np.int64(arcs.cost[x, y])
        + np.int64(arcs.cost[leads, b])
        + np.int64(arcs.cost[a, follows])
        - np.int64(arcs.cost[x, follows])
        - np.int64(arcs.cost[leads, y])
        - np.int64(arcs.cost[a, b])
    )
    if change > limit or not may_swap(tables.orders, line, place, i, j, k):
        return 0
    swap_places(line, place, state.spare, i, j, k)
    if arcs.even > 0:
        sum_reversed(arcs, state, i)
    return int(change)


@compiled
def _third(tables: SearchTables, state: State, p: int, q: int, how: np.uint64) -> int:
    """The third place to cut before: where a near arc closes the line, or such that a short stretch moves."""
    arcs, line = tables.arcs, state.line
    kind = high(how, 16)
    if kind < 5:
        leads = line[q - 1]
        if arcs.near_count[leads] == 0:
            return -1
        return int(state.place[arcs.near[leads, rather_low(how, arcs.near_count[leads])]])
    if kind < 10:
        follows = line[p + 1]
        if arcs.near_in_count[follows] == 0:
            return -1
        last = arcs.near_in[follows, rather_low(how, arcs.near_in_count[follows])]
        return int(state.place[last]) + 1
    size = short(how)
    return q + size if kind & 1 else p + 1 - size
