"""What is taken out of a route: neighbours, strings round a place, a stretch, anything, or one string to move."""

from __future__ import annotations

import numpy as np

from kerfwise.models.engines.search.state.jit_tools import below, compiled, draw_share
from kerfwise.models.engines.search.state.route_state import (
    LENGTH,
    TAKEN,
    UNITS,
    OrderLists,
    SearchTables,
    State,
    close_gaps,
    window,
)
from kerfwise.models.engines.search.state.travel import least_leave

from .insertion import insert_contour, insert_string


@compiled
def ruin(orders: OrderLists, state: State, kind: int, most: int) -> None:
    """Take up to about `most` contours out; `out` and `unit` list them."""
    n = state.number[LENGTH]
    state.number[UNITS] = state.number[TAKEN] = 0
    state.unit[0] = 0
    size = 1 + below(state.random, most)
    seed = state.order[below(state.random, n)]
    if kind == 0:
        _neighbourhood(orders, state, seed, size)
    elif kind == 1:
        _strings(orders, state, seed, size)
    elif kind == 2:
        _stretch(orders, state, state.position[seed], size)
    elif kind == 3:
        for _ in range(size):
            _take(orders, state, state.order[below(state.random, n)])
    else:
        _whole(orders, state, state.position[seed], size)
    close_gaps(state)


@compiled
def _add(state: State, contour: int) -> None:
    """Append a contour to the string being taken out."""
    state.out[state.number[TAKEN]] = contour
    state.number[TAKEN] += 1
    state.position[contour] = -1


@compiled
def _end_string(state: State) -> None:
    state.number[UNITS] += 1
    state.unit[state.number[UNITS]] = state.number[TAKEN]


@compiled
def _take(orders: OrderLists, state: State, contour: int) -> None:
    """Take one contour out; of a block often the whole of it, as a string."""
    if state.position[contour] < 0:
        return
    b = orders.block[contour]
    start, stop = orders.block_first[b], orders.block_first[b + 1]
    if stop - start > 1 and draw_share(state.random) < 0.6:
        low = state.number[LENGTH]
        present = 0
        for e in range(start, stop):
            where = state.position[orders.in_block[e]]
            if where >= 0:
                low = min(low, where)
                present += 1
        if present == stop - start:
            if draw_share(state.random) < 0.7:
                for p in range(low, low + present):
                    _add(state, state.order[p])
                _end_string(state)
            else:
                for p in range(low, low + present):
                    _add(state, state.order[p])
                    _end_string(state)
            return
    _add(state, contour)
    _end_string(state)


@compiled
def _neighbourhood(orders: OrderLists, state: State, seed: int, size: int) -> None:
    """The nearest of the nearest, breadth first with gaps."""
    _take(orders, state, seed)
    reached = 0
    while state.number[TAKEN] < size and reached < state.number[TAKEN]:
        c = state.out[reached]
        reached += 1
        for j in range(orders.near.shape[1]):
            if orders.near[c, j] >= 0 and draw_share(state.random) < 0.5:
                _take(orders, state, orders.near[c, j])
            if orders.near_in[c, j] >= 0 and draw_share(state.random) < 0.5:
                _take(orders, state, orders.near_in[c, j])
            if state.number[TAKEN] >= size:
                break


@compiled
def _strings(orders: OrderLists, state: State, seed: int, size: int) -> None:
    """Short stretches through the seed and its neighbours (Christiaens and Vanden Berghe 2020)."""
    length = 1 + below(state.random, min(size, 10))
    _around(orders, state, seed, length)
    for j in range(orders.near.shape[1]):
        _around(orders, state, orders.near[seed, j], length)
        _around(orders, state, orders.near_in[seed, j], length)
        if state.number[TAKEN] >= size:
            return


@compiled
def _around(orders: OrderLists, state: State, contour: int, length: int) -> None:
    if contour < 0 or state.position[contour] < 0:
        return
    first = max(0, state.position[contour] - below(state.random, length))
    for p in range(first, min(first + length, state.number[LENGTH])):
        _take(orders, state, state.order[p])


@compiled
def _stretch(orders: OrderLists, state: State, at: int, size: int) -> None:
    for p in range(at, min(at + size, state.number[LENGTH])):
        _take(orders, state, state.order[p])


@compiled
def _whole(orders: OrderLists, state: State, at: int, size: int) -> None:
    """One string, to be moved as it stands; blocks are not broken."""
    n = state.number[LENGTH]
    stop = min(at + size, n)
    while at > 0 and orders.block[state.order[at - 1]] == orders.block[state.order[at]]:
        at -= 1
    while stop < n and orders.block[state.order[stop]] == orders.block[state.order[stop - 1]]:
        stop += 1
    for p in range(at, stop):
        _add(state, state.order[p])
    _end_string(state)


# Putting back what was taken out, string after string, each where it costs least.


@compiled
def recreate(tables: SearchTables, state: State, blink: float) -> None:
    """Put every string back in, in one of several orders, with a chance `blink` of overlooking a place."""
    units = state.number[UNITS]
    _rank(tables, state, below(state.random, 5))
    for i in range(units):
        u = state.queue[i]
        start, stop = state.unit[u], state.unit[u + 1]
        if stop - start > 1 and insert_string(tables, state, start, stop, blink):
            continue
        for k in range(start, stop):
            insert_contour(tables, state, k, blink)


@compiled
def _rank(tables: SearchTables, state: State, kind: int) -> None:
    """Sort the strings: at random, far from home first or last, tight windows first, or as they were taken."""
    units = state.number[UNITS]
    for u in range(units):
        contour = state.out[state.unit[u]]
        if kind <= 1:
            key = draw_share(state.random)
        elif kind == 2:
            key = -np.float64(least_leave(tables.legs, tables.legs.m, contour))
        elif kind == 3:
            key = np.float64(least_leave(tables.legs, tables.legs.m, contour))
        else:
            lo, hi = window(tables.orders, state, contour)
            key = np.float64(hi - lo)
        state.unit_key[u] = key
        i = u
        while i > 0 and state.unit_key[state.queue[i - 1]] > key:
            state.queue[i] = state.queue[i - 1]
            i -= 1
        state.queue[i] = u
