"""The walk by chains: a kick, chains until none is left that gains, and on from there or back, as it gets cooler."""

from __future__ import annotations

import numpy as np

from kerfwise.models.engines.search.chance import below, share
from kerfwise.models.engines.search.compiled import compiled, entry
from kerfwise.models.engines.search.line import may_swap
from kerfwise.models.engines.search.state import BEST, COST, WORK

from .chain import enqueue, improve_all
from .state import HIGH, LOW, ChainState
from .steps import arc, arrival, stretches, swap
from .tables import UNLAWFUL, ChainTables

KICKS = 2
"""Random steps of a kick."""
WIDTH = 8
"""Nearest arcs that a kick draws from."""
LONGEST = 16
"""Length of stretches that a kick moves, where but one of its arcs is a near one."""
DRAWS = 100
"""Draws of a kick after which there is none."""
PER_KICK = 50
"""Operations for a kick, beside its swaps."""


@entry
def walk_by_chains(tables: ChainTables, state: ChainState, until: int, hot: float, cold: float) -> None:
    """Search until `number[WORK]` reaches `until`; the temperature falls from `hot` to `cold` on the way.

    First all arcs of the trial are looked at, if that was not done yet.
    """
    _begin_trial(tables, state)
    improve_all(tables, state)
    _settle(tables, state, state.number[COST])
    start = state.number[WORK]
    while state.number[WORK] < until:
        done = (state.number[WORK] - start) / (until - start)
        temperature = hot * (cold / hot) ** done
        was = state.number[COST]
        limit = was - temperature * np.log(1.0 - share(state.random))
        _begin_trial(tables, state)
        for _ in range(KICKS):
            _kick(tables, state)
        improve_all(tables, state)
        if state.number[COST] <= limit:
            _settle(tables, state, state.number[COST])
        else:
            _go_back(state)
            state.number[COST] = was


@compiled
def _begin_trial(tables: ChainTables, state: ChainState) -> None:
    state.number[LOW], state.number[HIGH] = tables.n + 1, 0
    state.number[WORK] += PER_KICK


@compiled
def _kick(tables: ChainTables, state: ChainState) -> None:
    """A random step that makes a near arc or two, whatever the others cost."""
    line, near = state.line, tables.near
    for _ in range(DRAWS):
        p = below(state.random, tables.n + 1)
        x, follows = line[p], line[p + 1]
        y = near[x, below(state.random, min(WIDTH, near.shape[1]))]
        if y < 0:
            continue
        q = arrival(tables, state, y)
        c = _third(tables, state, p, q)
        i, j, k = stretches(p, q, c)
        if i == 0 or k > tables.n + 1:
            continue
        z, v, w = line[q - 1], line[c - 1], line[c]
        if arc(tables, z, w) >= UNLAWFUL or arc(tables, v, follows) >= UNLAWFUL:
            continue
        if not may_swap(tables.orders, line, state.place, i, j, k):
            continue
        state.number[COST] += (
            arc(tables, x, y)
            + arc(tables, z, w)
            + arc(tables, v, follows)
            - arc(tables, x, follows)
            - arc(tables, z, y)
            - arc(tables, v, w)
        )
        for tail in (x, z, v):
            enqueue(state, int(np.int64(tail)))
        swap(state, i, j, k)
        return


@compiled
def _third(tables: ChainTables, state: ChainState, p: int, q: int) -> int:
    """Where a kick breaks the third arc: such that another arc is a near one, or that a short stretch moves."""
    kind = below(state.random, 4)
    if kind == 0:
        w = tables.near[state.line[q - 1], below(state.random, min(WIDTH, tables.near.shape[1]))]
        return arrival(tables, state, w) if w >= 0 else 0
    if kind == 1:
        v = tables.near_in[state.line[p + 1], below(state.random, min(WIDTH, tables.near_in.shape[1]))]
        return int(np.int64(state.place[v])) + 1 if v >= 0 else 0
    size = 1 + below(state.random, LONGEST)
    return q + size if kind == 2 else p + 1 - size


@compiled
def _settle(tables: ChainTables, state: ChainState, cost: int) -> None:
    """Stand on the trial, and keep it if it is the best."""
    for p in range(state.number[LOW], state.number[HIGH]):
        state.stood[p] = state.line[p]
    if state.number[BEST] < 0 or cost < state.number[BEST]:
        state.number[BEST] = cost
        for p in range(tables.n):
            state.best[p] = state.line[p + 1]


@compiled
def _go_back(state: ChainState) -> None:
    """Make the trial the route we stand on again."""
    for p in range(state.number[LOW], state.number[HIGH]):
        contour = state.stood[p]
        state.line[p] = contour
        state.place[contour] = p
