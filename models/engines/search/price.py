"""What a stretch of a full sequence costs, to the µm as `evaluate.route_cost` has it."""

from __future__ import annotations

from kerfwise.arrays import Ints

from .compiled import compiled
from .crossed import cell_of, crossing
from .demands import unmet
from .groups import pieces_begun
from .lags import too_close_within, too_soon
from .legs import leg
from .literals import literals_unmet
from .tables import SearchTables


@compiled
def span_price(
    tables: SearchTables, order: Ints, position: Ints, site: Ints, lo: int, hi: int, room: Ints
) -> tuple[int, int]:
    """Cost, and number of hard statements broken, of all that positions `lo` … `hi - 1` have a part in.

    Two sequences that differ in this span alone differ in cost by what this differs. `room` is for a number a contour.
    """
    legs, demands, crossed, groups, lags = tables.legs, tables.demands, tables.crossed, tables.groups, tables.lags
    conditional, crossable = len(demands.contour) > 0, len(crossed.over) > 0
    cost, broken = 0, 0
    last = legs.m if lo == 0 else site[order[lo - 1]]
    for p in range(lo, hi + 1):
        s = legs.m if p == legs.n else site[order[p]]
        cost += leg(legs, last, s)
        if crossable:
            cell = cell_of(crossed, last * (legs.n + 1) + legs.contour[s])
            if cell >= 0:
                more, worse = crossing(crossed, cell + s - legs.first[legs.contour[s]], position, p)
                cost, broken = cost + more, broken + worse
        last = s
        if p == hi:
            break
        cost += legs.site_cost[s]
        if conditional:
            c = order[p]
            more, worse = unmet(demands, demands.of_contour[c], demands.of_contour[c + 1], position, p)
            cost, broken = cost + more, broken + worse
            more, worse = unmet(demands, demands.of_site[s], demands.of_site[s + 1], position, p)
            cost, broken = cost + more, broken + worse
    if len(groups.of) > 0:
        for p in range(lo, min(hi + 1, legs.n)):
            cost += pieces_begun(groups, order[p], order[p - 1] if p > 0 else -1)
    if len(lags.other) > 0:
        for p in range(lo, hi):
            more, worse = too_close_within(lags, order[p], position, hi)
            cost, broken = cost + more, broken + worse
    if len(lags.a) > 0:
        more, worse = too_soon(lags, legs, order, position, site, room)
        cost, broken = cost + more, broken + worse
    if len(tables.literals.bound) > 0:
        more, worse = literals_unmet(tables.literals, legs.contour, position, site)
        cost, broken = cost + more, broken + worse
    return cost, broken
