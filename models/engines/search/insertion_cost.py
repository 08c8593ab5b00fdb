"""What it costs to put a contour in at a place, travel aside."""

from __future__ import annotations

from .compiled import compiled
from .demands import unmet
from .groups import pieces_begun
from .lags import too_close
from .state import LENGTH, PRICE, State
from .tables import SearchTables


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
