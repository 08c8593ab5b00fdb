"""Where a contour, or a string of them, is best put in."""

from __future__ import annotations

from .chance import share
from .compiled import compiled
from .crossed import cell_of
from .demands import met_at
from .insertion_cost import insertion_cost, site_demands
from .legs import least_enter, least_leave
from .sequence import inside_block, put_in, window
from .sites import FAR, move_cost
from .state import LENGTH, NOWHERE, PRICE, START, WORK, State
from .tables import SearchTables


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
        if blink > 0.0 and best < FAR and share(state.random) < blink:
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
        if blink > 0.0 and best < FAR and share(state.random) < blink:
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
