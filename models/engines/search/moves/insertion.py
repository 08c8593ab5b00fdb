"""Where a contour, or a string of them, is best put in, and the best sites for a given order."""

from __future__ import annotations

from kerfwise.models.engines.search.state.conditions import met_at, pieces_begun, too_close, unmet
from kerfwise.models.engines.search.state.jit_tools import compiled, draw_share
from kerfwise.models.engines.search.state.route_state import (
    LENGTH,
    NOWHERE,
    PRICE,
    START,
    WORK,
    SearchTables,
    State,
    inside_block,
    put_in,
    window,
)
from kerfwise.models.engines.search.state.travel import cell_of, crossing, fare, least_enter, least_leave

# What it costs to put a contour in at a place, travel aside.


@compiled
def insertion_cost(tables: SearchTables, state: State, contour: int, at: int) -> int:
    """What a contour's own conditions, groups and lags cost before position `at`, whatever its site."""
    demands, groups = tables.demands, tables.groups
    total = 0
    start, stop = demands.of_contour[contour], demands.of_contour[contour + 1]
    if stop > start:
        cost, broken = unmet(demands, start, stop, state.position, at)
        total += cost + broken * state.number[PRICE]
    if len(groups.of) > 0:
        a = state.order[at - 1] if at > 0 else -1
        total += pieces_begun(groups, contour, a)
        if at < state.number[LENGTH]:
            b = state.order[at]
            total += pieces_begun(groups, b, contour) - pieces_begun(groups, b, a)
    if len(tables.lags.guide_other) > 0:
        cost, broken = too_close(tables.lags, contour, state.position, at)
        total += cost + broken * state.number[PRICE]
    return total


@compiled
def site_demands(tables: SearchTables, state: State, site: int, at: int) -> int:
    """What the conditions of a site cost before position `at`."""
    demands = tables.demands
    start, stop = demands.of_site[site], demands.of_site[site + 1]
    if stop == start:
        return 0
    cost, broken = unmet(demands, start, stop, state.position, at)
    return int(cost + broken * state.number[PRICE])


# The best sites for a given order: a layered shortest path, exact for travel, crossings, site costs, conditions.

FAR = 1 << 58  # more than any route costs, µm


@compiled
def move_cost(tables: SearchTables, state: State, a: int, b: int, at: int) -> int:
    """Travel from site a to site b just before position `at`, and what it crosses."""
    legs, crossed = tables.legs, tables.crossed
    cost = fare(legs, a, b, state.number[PRICE])
    if len(crossed.over) > 0:
        c = legs.contour[b]
        cell = cell_of(crossed, a * (legs.n + 1) + c)
        if cell >= 0:
            more, broken = crossing(crossed, cell + b - legs.first[c], state.position, at)
            cost += more + broken * state.number[PRICE]
    return cost


@compiled
def choose_sites(tables: SearchTables, state: State, lo: int, hi: int) -> None:
    """Choose the sites of positions `lo` … `hi - 1` of a full sequence; those beside them stay as they are."""
    legs, demands = tables.legs, tables.demands
    conditional = demands.of_site[legs.m] > demands.of_site[0]
    reach, back = state.reach, state.back
    before = legs.m if lo == 0 else state.site[state.order[lo - 1]]
    start, stop = 0, 0
    for p in range(lo, hi):
        c = state.order[p]
        last_start, last_stop = start, stop
        start, stop = legs.first[c], legs.first[c + 1]
        state.number[WORK] += 10 + 4 * (stop - start) * max(1, last_stop - last_start)
        if p == lo:
            for s in range(start, stop):
                reach[s] = move_cost(tables, state, before, s, p)
        else:
            for s in range(start, stop):
                reach[s] = FAR
            for t in range(last_start, last_stop):
                _extend(tables, state, t, start, stop, p)
        for s in range(start, stop):
            if state.forced[c] >= 0 and s != state.forced[c]:
                reach[s] = FAR
            reach[s] += legs.site_cost[s] + state.lean[s]
            if conditional:
                cost, broken = unmet(demands, demands.of_site[s], demands.of_site[s + 1], state.position, p)
                reach[s] += cost + broken * state.number[PRICE]
    after = legs.m if hi == legs.n else state.site[state.order[hi]]
    best, chosen = 2 * FAR, start
    for s in range(start, stop):
        total = reach[s] + move_cost(tables, state, s, after, hi)
        if total < best:
            best, chosen = total, s
    for p in range(hi - 1, lo - 1, -1):
        state.site[state.order[p]] = chosen
        chosen = back[chosen]


@compiled
def _extend(tables: SearchTables, state: State, t: int, start: int, stop: int, at: int) -> None:
    """Go on from site t, reached just before, to each of the sites `start` … `stop - 1` at position `at`."""
    legs, crossed, reach, back = tables.legs, tables.crossed, state.reach, state.back
    so_far = reach[t]
    cell = -1
    if len(crossed.over) > 0:
        cell = cell_of(crossed, t * (legs.n + 1) + legs.contour[start])
    for s in range(start, stop):
        total = so_far + fare(legs, t, s, state.number[PRICE])
        if cell >= 0:
            cost, broken = crossing(crossed, cell + s - start, state.position, at)
            total += cost + broken * state.number[PRICE]
        if total < reach[s]:
            reach[s], back[s] = total, t
    if cell >= 0:
        state.number[WORK] += 10 * (stop - start)


@compiled
def refresh_sites(tables: SearchTables, state: State, lo: int, hi: int, choose: bool) -> None:
    """Choose anew the sites of every run of stale contours in positions `lo` … `hi - 1`, or just call them fresh."""
    p = lo
    while p < hi:
        if not state.stale[state.order[p]]:
            p += 1
            continue
        start = p
        while p < hi and state.stale[state.order[p]]:
            state.stale[state.order[p]] = False
            p += 1
        if choose:
            choose_sites(tables, state, start, p)


@compiled
def insert_contour(tables: SearchTables, state: State, k: int, blink: float) -> None:
    """Put contour `out[k]` in where it costs least; every place is overlooked with probability `blink`."""
    legs = tables.legs
    contour = state.out[k]
    lo, hi = window(tables.orders, state, contour)
    _clear_later(state, lo, hi)
    noted = _note_later(tables, state, contour, lo, hi)
    if noted:
        _sum_later(state, lo, hi)
    start, stop = legs.first[contour], legs.first[contour + 1]
    if state.forced[contour] >= 0:
        start, stop = state.forced[contour], state.forced[contour] + 1
    best, best_at, best_site = 2 * FAR, hi, start
    block = tables.orders.block[contour]
    for at in range(lo, hi + 1):
        a, b = _beside(tables, state, at)
        base = (state.later[at] if noted else 0) - move_cost(tables, state, a, b, at)
        if base + least_leave(legs, a, contour) + least_enter(legs, contour, b) >= best:
            continue
        if inside_block(tables.orders, state, at, block):
            continue
        if blink > 0.0 and best < FAR and draw_share(state.random) < blink:
            continue
        base += insertion_cost(tables, state, contour, at)
        state.number[WORK] += 3 * (stop - start)
        for s in range(start, stop):
            total = base + move_cost(tables, state, a, s, at) + move_cost(tables, state, s, b, at)
            total += legs.site_cost[s] + state.lean[s]
            if total < best:
                total += site_demands(tables, state, s, at)
                if total < best:
                    best, best_at, best_site = total, at, s
    state.number[WORK] += 80 + 4 * (hi - lo) + state.number[LENGTH] - best_at
    state.site[contour] = best_site
    put_in(state, k, k + 1, best_at)


@compiled
def insert_string(tables: SearchTables, state: State, start: int, stop: int, blink: float) -> bool:
    """Put the contours `out[start:stop]` in as they stand where they cost least; False if there is no such place.

    Their own sites are kept, but those of the first and the last may change with the place.
    """
    legs = tables.legs
    first, last = state.out[start], state.out[stop - 1]
    lo, hi = START, state.number[LENGTH]
    for k in range(start, stop):
        low, high = window(tables.orders, state, state.out[k])
        lo, hi = max(lo, low), min(hi, high)
    if lo > hi:
        return False
    _clear_later(state, lo, hi)
    for k in range(start, stop):
        _note_later(tables, state, state.out[k], lo, hi)
    _sum_later(state, lo, hi)
    best, best_at, best_first, best_last = 2 * FAR, NOWHERE, NOWHERE, NOWHERE
    second, last_but_one = state.site[state.out[start + 1]], state.site[state.out[stop - 2]]
    for at in range(lo, hi + 1):
        a, b = _beside(tables, state, at)
        base = state.later[at] - move_cost(tables, state, a, b, at)
        if base + least_leave(legs, a, first) + least_enter(legs, last, b) >= best:
            continue
        if inside_block(tables.orders, state, at, NOWHERE):
            continue
        if blink > 0.0 and best < FAR and draw_share(state.random) < blink:
            continue
        for k in range(start, stop):
            base += insertion_cost(tables, state, state.out[k], at)
        into, site_in = FAR, -1
        for s in range(legs.first[first], legs.first[first + 1]):
            total = move_cost(tables, state, a, s, at) + move_cost(tables, state, s, second, at) + legs.site_cost[s]
            if total < into:
                into, site_in = total, s
        out_of, site_out = FAR, -1
        for s in range(legs.first[last], legs.first[last + 1]):
            total = move_cost(tables, state, last_but_one, s, at) + move_cost(tables, state, s, b, at)
            total += legs.site_cost[s]
            if total < out_of:
                out_of, site_out = total, s
        state.number[WORK] += 40
        if base + into + out_of < best:
            best, best_at, best_first, best_last = base + into + out_of, at, site_in, site_out
    state.number[WORK] += 4 * (hi - lo) + 80 * (stop - start)
    if best_at < 0:
        return False
    state.site[first], state.site[last] = best_first, best_last
    put_in(state, start, stop, best_at)
    return True


@compiled
def _beside(tables: SearchTables, state: State, at: int) -> tuple[int, int]:
    """The sites before and after the gap in front of position `at`."""
    home = tables.legs.m
    a = home if at == 0 else state.site[state.order[at - 1]]
    b = home if at == state.number[LENGTH] else state.site[state.order[at]]
    return a, b


@compiled
def _clear_later(state: State, lo: int, hi: int) -> None:
    for at in range(lo, hi + 1):
        state.later[at] = 0


@compiled
def _note_later(tables: SearchTables, state: State, contour: int, lo: int, hi: int) -> bool:
    """Add to `later[at]` what it costs that a contour is put in before position `at`, or further back.

    That is what changes for conditions of others and for moves over it. False if nothing does.
    """
    demands, crossed = tables.demands, tables.crossed
    found = False
    for e in range(demands.touch_first[contour], demands.touch_first[contour + 1]):
        k = demands.touch[e]
        other = demands.contour[k]
        where = state.position[other]
        if where < lo or (demands.site[k] >= 0 and demands.site[k] != state.site[other]):
            continue
        was = met_at(demands, k, state.position, where, 0)
        now = met_at(demands, k, state.position, where, demands.touch_weight[e])
        if was != now:
            price = demands.cost[k] if demands.cost[k] >= 0 else state.number[PRICE]
            state.later[min(where, hi)] += price if was else -price
            found = True
    if len(crossed.over) > 0 and crossed.is_over[contour]:
        for at in range(lo + 1, hi + 1):
            a, b = _beside(tables, state, at)
            cost = _cost_over(tables, state, contour, a, b)
            state.later[at - 1] += cost
            found = found or cost > 0
    return found


@compiled
def _cost_over(tables: SearchTables, state: State, contour: int, a: int, b: int) -> int:
    """What the move from site a to site b costs for crossing a contour, once that is cut."""
    legs, crossed = tables.legs, tables.crossed
    cost = 0
    c = legs.contour[b]
    cell = cell_of(crossed, a * (legs.n + 1) + c)
    if cell >= 0:
        start = cell + b - legs.first[c]
        for e in range(crossed.start[start], crossed.start[start + 1]):
            if crossed.over[e] == contour:
                cost += crossed.cost[e] if crossed.cost[e] >= 0 else state.number[PRICE]
    return cost


@compiled
def _sum_later(state: State, lo: int, hi: int) -> None:
    for at in range(hi - 1, lo - 1, -1):
        state.later[at] += state.later[at + 1]


# The first route: always on to the nearest contour that may be cut now.


@compiled
def nearest_first(tables: SearchTables, state: State) -> None:
    """Fill the trial with a route that keeps all orders and blocks."""
    legs, orders = tables.legs, tables.orders
    n = legs.n
    state.position[:] = -1
    waits_for, left_in_block = state.stack, state.queue
    for c in range(n):
        waits_for[c] = orders.covers_first[c + 1] - orders.covers_first[c]
        b = orders.block[c]
        left_in_block[b] = orders.block_first[b + 1] - orders.block_first[b]
    here, open_block = legs.m, -1
    for at in range(n):
        state.number[LENGTH] = at
        best, chosen = 2 * FAR, -1
        for c in range(n):
            if state.position[c] >= 0 or waits_for[c] > 0 or (open_block >= 0 and orders.block[c] != open_block):
                continue
            if least_leave(legs, here, c) >= best:
                continue
            base = insertion_cost(tables, state, c, at)
            for s in range(legs.first[c], legs.first[c + 1]):
                total = base + move_cost(tables, state, here, s, at) + legs.site_cost[s]
                if total < best:
                    total += site_demands(tables, state, s, at)
                    if total < best:
                        best, chosen = total, s
        c = legs.contour[chosen]
        state.order[at], state.position[c], state.site[c] = c, at, chosen
        here = chosen
        left_in_block[orders.block[c]] -= 1
        open_block = orders.block[c] if left_in_block[orders.block[c]] > 0 else -1
        for e in range(orders.covered_first[c], orders.covered_first[c + 1]):
            waits_for[orders.covered[e]] -= 1
    state.number[LENGTH] = n
