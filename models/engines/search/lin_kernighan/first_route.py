"""The first route: always on to the lawful contour of the least reduced cost."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Ints

from .tables import ChainTables


def nearest_lawful(tables: ChainTables) -> Ints:
    """Contours (n,) in an order that keeps the orders."""
    n, before = tables.n, tables.orders.before
    waits_for = before.sum(axis=0)
    out = np.zeros(n, dtype=np.bool_)
    route = np.zeros(n, dtype=np.int64)
    here = n
    for at in range(n):
        free = np.flatnonzero(~out & (waits_for == 0))
        here = int(free[np.argmin(tables.cost[here, free])])
        route[at], out[here] = here, True
        waits_for -= before[here]
    return route
