"""The first route: always on to the nearest contour that may be cut now."""

from __future__ import annotations

from .compiled import compiled
from .insertion_cost import insertion_cost, site_demands
from .legs import least_leave
from .sites import FAR, move_cost
from .state import LENGTH, State
from .tables import SearchTables


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
