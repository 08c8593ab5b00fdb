"""The inner loops of the beam, compiled by numba; they run without the GIL, so that two threads can share a layer."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats, Int32s, Ints
from kerfwise.models.engines.ideals.kernels import conditions_cost, leaving
from kerfwise.models.engines.ideals.sets import extend_set, find_slot, ready_word
from kerfwise.models.engines.ideals.stretch import HARD
from kerfwise.models.jit import inner, jit
from kerfwise.models.problem.bitsets import LOW, ONE, Masks, bit_number, has
from kerfwise.models.problem.crossings import FORBIDDEN

from .tables import NEVER, BeamTables


@jit(nogil=True)
def expand(  # pragma: no cover - compiled
    tables: BeamTables,
    to_go: Floats,
    price: Floats,
    masks: Masks,
    ready: Masks,
    rest: Floats,
    pending: Int32s,
    node_from: Ints,
    site: Int32s,
    value: Ints,
    depth: int,
    at: int,
    stop: int,
    limit: float,
    cut: float,
    child_f: Floats,
    child_value: Ints,
    child_parent: Int32s,
    child_site: Int32s,
    child_set: Int32s,
    used: int,
) -> tuple[int, int, float, int]:
    """Cut one more contour from the sets `at` … `stop - 1` until the buffers of children are nearly full.

    Children whose bound is over `limit` are gone for good, those that do not come under `cut` are dropped. Returns
    the next set, the number of children, the least bound of what was dropped, and the operations it took.
    """
    m = len(tables.site_contour)
    words = masks.shape[1]
    crossed, grouped = len(tables.cross_at) > 0, len(tables.terms.soft_cost) > 0
    column = np.empty(m, dtype=np.int64)
    best = np.empty(m, dtype=np.int64)
    parent = np.empty(m, dtype=np.int32)
    least = np.inf
    operations = 0
    while at < stop and used + m <= len(child_f):
        mask = masks[at]
        count = 0
        for w in range(words):
            bits = ready_word(tables.orders, ready, pending, at, w)
            while bits:
                low = bits & (~bits + ONE)
                bits ^= low
                k = w * 64 + bit_number(low)
                for d in range(tables.first[k], tables.first[k + 1]):
                    column[count] = d
                    parent[count] = -1
                    count += 1
        for x in range(node_from[at], node_from[at + 1]):
            last, have = site[x], value[x]
            row = tables.travel[last]
            for c in range(count):
                d = column[c]
                if row[d] == NEVER:
                    continue
                total = have + row[d]
                if crossed:
                    more = _crossing(tables, last, d, mask)
                    if more == FORBIDDEN:
                        continue
                    total += more
                if grouped and last < m:
                    total += leaving(tables.terms, mask, tables.site_contour[last], tables.site_contour[d])
                if parent[c] < 0 or total < best[c]:
                    best[c] = total
                    parent[c] = x
        operations += count * (node_from[at + 1] - node_from[at] + 2)
        for c in range(count):
            if parent[c] < 0:
                continue
            d = column[c]
            k = tables.site_contour[d]
            extra = conditions_cost(tables.terms, mask, k, d)
            if extra == HARD:
                continue
            total = best[c] + tables.terms.site_cost[d] + extra
            left = 0.0
            for b in range(len(price)):
                left = max(left, to_go[b, depth, d] + rest[at, b] - price[b, k])
            f = total + left
            if f > limit:
                continue
            if f >= cut:
                least = min(least, f)
                continue
            child_f[used] = f
            child_value[used] = total
            child_parent[used] = parent[c]
            child_site[used] = d
            child_set[used] = at
            used += 1
        at += 1
    return at, used, least, operations


@jit(nogil=True)
def gather(  # pragma: no cover - compiled
    tables: BeamTables,
    price: Floats,
    masks: Masks,
    ready: Masks,
    rest: Floats,
    hashes: Masks,
    child_site: Int32s,
    child_set: Int32s,
    slots: Int32s,
    new_masks: Masks,
    new_ready: Masks,
    new_rest: Floats,
    new_pending: Int32s,
    new_hashes: Masks,
    set_of: Int32s,
) -> int:
    """Find the sets of the children and describe each once; `set_of` is the set of every child. Returns their number.

    `slots`, a power of two of them, is a hash table of sets; equal hashes are told apart by the sets themselves.
    """
    slots[:] = 0
    count = 0
    for c in range(len(child_site)):
        source = child_set[c]
        k = tables.site_contour[child_site[c]]
        key = hashes[source] ^ tables.orders.noise[k]
        bit = ONE << (np.uint64(k) & LOW)
        slot = find_slot(slots, key, new_masks, new_hashes, masks[source], k >> 6, bit)
        if slots[slot] > 0:
            set_of[c] = slots[slot] - 1
            continue
        set_of[c] = count
        new_hashes[count] = key
        new_pending[count] = extend_set(
            tables.orders, masks[source], ready[source], k, new_masks[count], new_ready[count]
        )
        for b in range(len(price)):
            new_rest[count, b] = rest[source, b] - price[b, k]
        count += 1
        slots[slot] = count
    return count


@inner(nogil=True)
def _crossing(tables: BeamTables, leave: int, reach: int, mask: Masks) -> int:  # pragma: no cover - compiled
    """What a move costs for the contours that are out; `FORBIDDEN` if it is not lawful."""
    move = tables.cross_at[leave, reach]
    cost = 0
    if move >= 0:
        for e in range(tables.cross_from[move], tables.cross_from[move + 1]):
            if has(mask, tables.cross_over[e]):
                if tables.cross_cost[e] == FORBIDDEN:
                    return FORBIDDEN
                cost += tables.cross_cost[e]
    return cost


# The inner loops of the bound by walks, compiled by numba.


@jit(nogil=True)
def look_ahead(  # pragma: no cover - compiled
    arc_from: Ints,
    arc_to: Ints,
    arc_cost: Floats,
    owner: Ints,
    price: Floats,
    earliest: Ints,
    latest: Ints,
    least: Floats,
    contour: Ints,
    step: Ints,
    second: Floats,
    second_step: Ints,
) -> None:
    """Fill `least[d, s]` (n + 1, m + 1): the least rest of a walk that stands at site s after d steps; row n is given.

    `contour[d, s]`, `step[d, s]` are where it goes next; `second`, `second_step` the same for the least walk that goes
    to another contour next, which is taken where the first would lead straight back to where it came from.
    """
    n, m = len(earliest), len(owner) - 1
    for d in range(n - 1, -1, -1):
        for s in range(m + 1):
            here = owner[s]
            best = other = np.inf
            to = to_other = to_contour = -1
            if s == m if d == 0 else (s < m and earliest[here] < d <= latest[here] + 1):
                for e in range(arc_from[s], arc_from[s + 1]):
                    t = arc_to[e]
                    c = owner[t]
                    if d < earliest[c] or d > latest[c]:
                        continue
                    rest = second[d + 1, t] if contour[d + 1, t] == here else least[d + 1, t]
                    total = arc_cost[e] - price[c] + rest
                    if total < best:
                        if c != to_contour:
                            other, to_other = best, to
                        best, to, to_contour = total, t, c
                    elif total < other and c != to_contour:
                        other, to_other = total, t
            least[d, s], step[d, s], contour[d, s] = best, to, to_contour
            second[d, s], second_step[d, s] = other, to_other


@jit(nogil=True)
def count_visits(  # pragma: no cover - compiled
    owner: Ints, contour: Ints, step: Ints, second_step: Ints, visits: Ints
) -> None:
    """How often the least walk from home visits every contour (n,)."""
    s, before = len(owner) - 1, -1
    visits[:] = 0
    for d in range(len(visits)):
        to = second_step[d, s] if contour[d, s] == before else step[d, s]
        before, s = owner[s], to
        visits[owner[s]] += 1
