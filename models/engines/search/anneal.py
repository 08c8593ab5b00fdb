"""The walk: ruin and recreate or swap, choose sites, go on from there or go back, while the temperature falls."""

from __future__ import annotations

import numpy as np

from .chance import below, share
from .compiled import compiled, entry
from .greedy import nearest_first
from .literals import lean_on_sites
from .price import span_price
from .recreate import recreate
from .ruin import ruin
from .sites import choose_sites, refresh_sites
from .sop_exchange import swap_towards
from .state import BEST, BROKEN, CLIMBS, COST, LAWLESS, LENGTH, PRICE, START, TAKEN, TRIES, WORK, YES, State
from .tables import SearchTables
from .three_opt import PER_TRIAL, three_opt

DEAREST = 1 << 40  # the most that a broken statement counts, µm
EXCHANGES = 4  # work on exchanges for one of ruins, where they are quick
MOST = 12  # contours taken out at once
RUINS, FEW_RUINS, LONG = 0.1, 0.03, 300  # share of ruins among the moves, the rest are swaps: fewer on long routes
FORCED = 0.3  # share of ruins in which a site is forced, where that makes sense
MUCH = 0.4  # chance of overlooking a place where a trial is to differ
JUDGE = 128  # trials between two looks at how many of them were lawful


@entry
def begin(tables: SearchTables, state: State, make: bool) -> None:
    """Make a first route to stand on, or stand on the route that is the trial."""
    if make:
        nearest_first(tables, state)
    _stand(tables, state, make)


@entry
def walk(tables: SearchTables, state: State, until: int, hot: float, cold: float) -> None:
    """Search until `number[WORK]` reaches `until`; the temperature, µm, falls from `hot` to `cold` on the way."""
    swaps = 1.0 - max(FEW_RUINS, RUINS * min(1.0, LONG / tables.legs.n))
    start = state.number[WORK]
    while state.number[WORK] < until:
        temperature = _temperature(state, start, until, hot, cold)
        limit = -temperature * np.log(1.0 - share(state.random))
        if share(state.random) < swaps:
            state.number[WORK] += 60
            if swap_towards(tables, state, limit):
                _settle(tables, state, YES, limit)
        else:
            change = _settle(tables, state, _shuffle(tables, state), limit)
            if change > 0:
                state.climb[state.number[CLIMBS] % len(state.climb)] = change
                state.number[CLIMBS] += 1
        _judge(state, temperature)


@entry
def walk_plain(tables: SearchTables, state: State, until: int, hot: float, cold: float) -> None:
    """The same for plain problems, with exchanges of arcs; a kernel apart, as either takes seconds to compile."""
    start = state.number[WORK]
    while state.number[WORK] < until:
        temperature = _temperature(state, start, until, hot, cold)
        limit = -temperature * np.log(1.0 - share(state.random))
        before = state.number[WORK]
        _settle(tables, state, _shuffle(tables, state), limit)
        three_opt(tables, state, temperature, EXCHANGES * (state.number[WORK] - before) // PER_TRIAL)
        _judge(state, temperature)


@compiled
def _temperature(state: State, start: int, until: int, hot: float, cold: float) -> float:
    """The temperature, µm, at the work done so far."""
    done = (state.number[WORK] - start) / (until - start)
    return float(hot * (cold / hot) ** done)


@compiled
def _shuffle(tables: SearchTables, state: State) -> bool:
    """Ruin and recreate the trial; False if its sites are to stay as they came out."""
    state.number[WORK] += 200
    kind = below(state.random, 8)
    kind = 0 if kind < 3 else 1 if kind < 5 else kind - 3
    ruin(tables.orders, state, kind, min(MOST, tables.legs.n))
    free = True
    if len(tables.literals.bound) > 0 or len(tables.lags.a) > 0:
        free = share(state.random) > FORCED
        _force_a_site(tables, state, not free)
    chance = share(state.random)
    apart = not free and len(tables.lags.a) > 0
    recreate(tables, state, MUCH if apart or chance >= 0.95 else 0.1 if chance >= 0.8 else 0.01)
    return free


@compiled
def _force_a_site(tables: SearchTables, state: State, force: bool) -> None:
    """Make a contour that is out take a random site, or none of them.

    Sites have a part in general statements, and in seconds between cuts, that choosing them by travel does not see.
    Those may need a detour by the sites of several contours.
    """
    state.forced[:] = -1
    if force:
        one, taken = below(state.random, state.number[TAKEN]), state.number[TAKEN]
        for k in range(taken):
            if k == one or (len(tables.lags.a) > 0 and below(state.random, taken) == 0):
                contour = state.out[k]
                start, stop = tables.legs.first[contour], tables.legs.first[contour + 1]
                state.forced[contour] = start + below(state.random, stop - start)
                state.site[contour] = state.forced[contour]


@compiled
def _settle(tables: SearchTables, state: State, choose: bool, limit: float) -> int:
    """Choose the sites of what has changed if asked to, and go on from the trial if it costs at most `limit` more.

    Answers by how much it changes the cost.
    """
    n = tables.legs.n
    lo, hi = START, n
    while lo < n and state.order[lo] == state.order_now[lo] and not state.stale[state.order[lo]]:
        lo += 1
    while hi > lo and state.order[hi - 1] == state.order_now[hi - 1] and not state.stale[state.order[hi - 1]]:
        hi -= 1
    if lo >= hi:
        return 0
    refresh_sites(tables, state, lo, hi, choose)
    state.number[WORK] += 200 + tables.legs.n + 10 * (hi - lo)
    cost, broken = span_price(tables, state.order, state.position, state.site, lo, hi, state.time_ms)
    was, was_broken = span_price(tables, state.order_now, state.position_now, state.site_now, lo, hi, state.time_ms)
    more, worse = cost - was, broken - was_broken
    change = more + worse * state.number[PRICE]
    if change > limit:
        _go_back(state, lo, hi)
        return int(change)
    _go_on(state, lo, hi)
    state.number[COST] += more
    state.number[BROKEN] += worse
    _note(tables, state)
    return int(change)


@compiled
def _note(tables: SearchTables, state: State) -> None:
    """Keep the route we now stand on if it is the best lawful one, and see where general statements lean."""
    if state.number[BROKEN] == 0 and (state.number[BEST] < 0 or state.number[COST] < state.number[BEST]):
        state.number[BEST] = state.number[COST]
        for p in range(tables.legs.n):
            state.best[p] = state.site_now[state.order_now[p]]
    if len(tables.literals.bound) > 0:
        contour, price = tables.legs.contour, state.number[PRICE]
        lean_on_sites(tables.literals, contour, state.position_now, state.site_now, price, state.lean)


@compiled
def _judge(state: State, temperature: float) -> None:
    """Raise the price of unlawful routes if most of the last ones were unlawful, lower it if few were."""
    state.number[TRIES] += 1
    if state.number[BROKEN] > 0:
        state.number[LAWLESS] += 1
    if state.number[TRIES] % JUDGE == 0:
        price = state.number[PRICE]
        if 2 * state.number[LAWLESS] > JUDGE:
            state.number[PRICE] = min(price + price // 4 + 1, DEAREST)
        elif 8 * state.number[LAWLESS] < JUDGE:
            state.number[PRICE] = max(price - price // 8, np.int64(temperature) + 1)
        state.number[LAWLESS] = 0


@compiled
def _go_on(state: State, lo: int, hi: int) -> None:
    """Stand on the trial, which differs in positions `lo` … `hi - 1`."""
    for p in range(lo, hi):
        c = state.order[p]
        state.order_now[p] = c
        state.position_now[c] = p
        state.site_now[c] = state.site[c]


@compiled
def _go_back(state: State, lo: int, hi: int) -> None:
    """Make the trial the route we stand on again."""
    for p in range(lo, hi):
        c = state.order_now[p]
        state.order[p] = c
        state.position[c] = p
        state.site[c] = state.site_now[c]


@compiled
def _stand(tables: SearchTables, state: State, choose: bool) -> None:
    """Stand on the trial, a full sequence, after choosing the best sites for it if asked to."""
    n = tables.legs.n
    state.number[LENGTH] = n
    state.forced[:] = -1
    state.stale[:] = False
    if choose:
        choose_sites(tables, state, START, n)
    _go_on(state, START, n)
    cost, broken = span_price(tables, state.order, state.position, state.site, START, n, state.time_ms)
    for g in range(len(tables.groups.cost)):
        cost -= tables.groups.cost[g]
    state.number[COST], state.number[BROKEN] = cost, broken
    _note(tables, state)
