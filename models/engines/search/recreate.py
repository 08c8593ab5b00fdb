"""Putting back what was taken out, string after string, each where it costs least."""

from __future__ import annotations

import numpy as np

from .chance import below, share
from .compiled import compiled
from .insert import insert_contour, insert_string
from .legs import least_leave
from .sequence import window
from .state import UNITS, State
from .tables import SearchTables


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
            key = share(state.random)
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
