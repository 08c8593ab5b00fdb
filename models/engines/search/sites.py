"""The best sites for a given order: a layered shortest path, exact for travel, crossings, site costs, conditions."""

from __future__ import annotations

from .compiled import compiled
from .crossed import cell_of, crossing
from .demands import unmet
from .legs import leg
from .state import PRICE, WORK, State
from .tables import SearchTables

FAR = 1 << 58  # more than any route costs, µm


@compiled
def move_cost(tables: SearchTables, state: State, a: int, b: int, at: int) -> int:
    """Travel from site a to site b just before position `at`, and what it crosses."""
    legs, crossed = tables.legs, tables.crossed
    cost = leg(legs, a, b)
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
        total = so_far + leg(legs, t, s)
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
