"""Steps of a chain: an arc is broken, two near ones are made, two more are broken, and one arc closes the line.

Arcs a → a', b → b', c → c', in this order along the line, become a → b', c → a', b → c': two stretches change places
and none is turned round (Gambardella and Dorigo 2000). Whichever of the three is broken first, x → x' say, and y is
where the first new arc leads: x → y, then from y's predecessor z → w, then w's predecessor v → x'.
"""

from __future__ import annotations

import numpy as np

from kerfwise.models.engines.search.compiled import compiled
from kerfwise.models.engines.search.line import may_swap, swap_places
from kerfwise.models.engines.search.state import WORK

from .state import HIGH, LOW, ChainState
from .tables import UNLAWFUL, ChainTables

SHORT = 8
"""Length of stretches that are moved by steps whose second new arc need not be a near one."""
PER_ARC, PER_SWAP = 5, 20
"""Operations for looking at an arc, and for a swap, beside those for each place."""


@compiled
def arc(tables: ChainTables, a: int, b: int) -> int:
    """Reduced cost of the arc a → b."""
    return int(np.int64(tables.cost[a, b]))


@compiled
def arrival(tables: ChainTables, state: ChainState, contour: int) -> int:
    """The place where a contour stands; home as the end of the line."""
    return tables.n + 1 if contour == tables.n else int(np.int64(state.place[contour]))


@compiled
def stretches(p: int, q: int, c: int) -> tuple[int, int, int]:
    """The places i, j, k of the swap that makes the arcs p → q, q - 1 → c and c - 1 → p + 1; i = 0 if there is none."""
    if q > p + 1:
        if c > q:
            return p + 1, q, c
        if 1 <= c <= p:
            return c, p + 1, q
    elif 1 <= q < c <= p:
        return q, c, p + 1
    return 0, 0, 0


@compiled
def find_steps(tables: ChainTables, state: ChainState, depth: int, most: int, p: int, saved: int) -> int:
    """The best lawful steps that break the arc out of place p; answers how many there are.

    `saved` is what broken arcs cost more than made ones, with the arc at p broken. It stays above zero on the way.
    Steps that may end the chain with a gain come first, then those that save most.
    """
    line, near, near_in = state.line, tables.near, tables.near_in
    x, follows = line[p], line[p + 1]
    found = 0
    for e in range(near.shape[1]):
        y = near[x, e]
        if y < 0 or arc(tables, x, y) >= saved:
            break
        q = arrival(tables, state, y)
        if q == p + 1:
            continue
        z = line[q - 1]
        after = saved - arc(tables, x, y) + arc(tables, z, y)
        for f in range(near.shape[1]):
            w = near[z, f]
            if w < 0 or arc(tables, z, w) >= after:
                break
            found = _consider(tables, state, depth, found, most, p, q, arrival(tables, state, w), after)
        for f in range(near_in.shape[1]):
            v = near_in[follows, f]
            if v >= 0:
                found = _consider(tables, state, depth, found, most, p, q, int(np.int64(state.place[v])) + 1, after)
        for size in range(1, SHORT + 1):
            found = _consider(tables, state, depth, found, most, p, q, q + size, after)
            found = _consider(tables, state, depth, found, most, p, q, p + 1 - size, after)
    return found


@compiled
def _consider(
    tables: ChainTables, state: ChainState, depth: int, found: int, most: int, p: int, q: int, c: int, after: int
) -> int:
    """Note the step that breaks the arc into place c as well, if it is lawful and one of the best; answers how many."""
    state.number[WORK] += PER_ARC
    i, j, k = stretches(p, q, c)
    if i == 0 or k > tables.n + 1:
        return found
    line = state.line
    v, w = line[c - 1], line[c]
    made, closing = arc(tables, line[q - 1], w), arc(tables, v, line[p + 1])
    freed = after - made + arc(tables, v, w)
    if made >= after or closing >= UNLAWFUL:
        return found
    if found == most and _rank(freed, closing) <= _rank_at(state, depth, most - 1):
        return found
    for at in range(found):
        if state.swap[depth, at, 0] == i and state.swap[depth, at, 1] == j and state.swap[depth, at, 2] == k:
            return found
    state.number[WORK] += min(j - i, k - j)
    if not may_swap(tables.orders, line, state.place, i, j, k):
        return found
    found = min(found + 1, most)
    _note_step(state, depth, found - 1, i, j, k, freed, closing)
    return found


@compiled
def _rank(freed: int, closing: int) -> int:
    return freed + UNLAWFUL * 8 if freed > closing else freed


@compiled
def _rank_at(state: ChainState, depth: int, at: int) -> int:
    return _rank(state.freed[depth, at], state.closing[depth, at])


@compiled
def _note_step(state: ChainState, depth: int, last: int, i: int, j: int, k: int, freed: int, closing: int) -> None:
    """Put a step in its place among the first `last` at this depth."""
    at = last
    while at > 0 and _rank_at(state, depth, at - 1) < _rank(freed, closing):
        for part in range(3):
            state.swap[depth, at, part] = state.swap[depth, at - 1, part]
        state.freed[depth, at] = state.freed[depth, at - 1]
        state.closing[depth, at] = state.closing[depth, at - 1]
        at -= 1
    state.swap[depth, at, 0], state.swap[depth, at, 1], state.swap[depth, at, 2] = i, j, k
    state.freed[depth, at], state.closing[depth, at] = freed, closing


@compiled
def swap(state: ChainState, i: int, j: int, k: int) -> None:
    """Swap two stretches of the trial."""
    swap_places(state.line, state.place, state.spare, i, j, k)
    state.number[LOW] = min(state.number[LOW], i)
    state.number[HIGH] = max(state.number[HIGH], k)
    state.number[WORK] += PER_SWAP + k - i


@compiled
def take_step(state: ChainState, depth: int, at: int) -> None:
    """Take a step, and note after whom it makes arcs."""
    i, j, k = state.swap[depth, at, 0], state.swap[depth, at, 1], state.swap[depth, at, 2]
    state.tail[depth, 0], state.tail[depth, 1], state.tail[depth, 2] = (
        np.int64(state.line[i - 1]),
        np.int64(state.line[j - 1]),
        np.int64(state.line[k - 1]),
    )
    swap(state, i, j, k)


@compiled
def take_back(state: ChainState, depth: int, at: int) -> None:
    """Undo a step."""
    i, j, k = state.swap[depth, at, 0], state.swap[depth, at, 1], state.swap[depth, at, 2]
    swap(state, i, i + k - j, k)
