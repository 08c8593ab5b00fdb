"""Exchanges by the million: make a short arc, close the gaps by another, and see whether that may be.

Of the exchanges of three arcs (Gambardella and Dorigo 2000) each trial draws one: an arc x → y to a near contour, and
where the line is cut the third time; its cost is known at once, and orders are looked at only for those cheap enough.
"""

from __future__ import annotations

import numpy as np

from .chance import chunk, draw_number, high, odd, rather_low, short
from .compiled import compiled
from .line import lay_out, may_swap, sum_reversed, swap_places, take_up
from .reversals import try_reversal
from .state import BEST, COST, ONE, TRADED, TRADES, WORK, State
from .tables import SearchTables

PER_TRIAL = 13  # operations


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
        if arcs.even > 0 and odd(where):
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
