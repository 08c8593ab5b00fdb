"""The inner loops of the beam, compiled by numba; they run without the GIL, so that two threads can share a layer."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.kernels import kept
from kerfwise.models.problem.bits import LOW, ONE, Masks, has, missing, place

from .tables import HARD, NEVER, Shorts, Tables


@kept(nogil=True)
def expand(  # pragma: no cover - compiled
    tables: Tables,
    to_go: Floats,
    price: Floats,
    masks: Masks,
    ready: Masks,
    rest: Floats,
    pending: Ints,
    node_from: Ints,
    site: Shorts,
    value: Ints,
    depth: int,
    at: int,
    stop: int,
    limit: float,
    cut: float,
    child_f: Floats,
    child_value: Ints,
    child_parent: Shorts,
    child_site: Shorts,
    child_set: Shorts,
    used: int,
) -> tuple[int, int, float, int]:
    """Cut one more contour from the sets `at` … `stop - 1` until the buffers of children are nearly full.

    Children whose bound is over `limit` are gone for good, those that do not come under `cut` are dropped. Returns
    the next set, the number of children, the least bound of what was dropped, and the operations it took.
    """
    m = len(tables.site_contour)
    words = masks.shape[1]
    crossed = len(tables.cross_at) > 0
    column = np.empty(m, dtype=np.int64)
    best = np.empty(m, dtype=np.int64)
    parent = np.empty(m, dtype=np.int32)
    incomplete = np.empty(len(tables.soft_cost), dtype=np.bool_)
    least = np.inf
    operations = 0
    while at < stop and used + m <= len(child_f):
        mask = masks[at]
        count = 0
        for w in range(words):
            bits = ready[at, w]
            while bits:
                low = bits & (~bits + ONE)
                bits ^= low
                k = w * 64 + place(low)
                if pending[at] >= 0 and tables.block[k] != pending[at]:
                    continue
                for d in range(tables.first[k], tables.first[k + 1]):
                    column[count] = d
                    parent[count] = -1
                    count += 1
        for g in range(len(incomplete)):
            incomplete[g] = missing(tables.soft_mask[g], mask)
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
                    if more == HARD:
                        continue
                    total += more
                if len(incomplete) and last < m:
                    total += _left(tables, incomplete, tables.site_contour[last], tables.site_contour[d])
                if parent[c] < 0 or total < best[c]:
                    best[c] = total
                    parent[c] = x
        operations += count * (node_from[at + 1] - node_from[at] + 2)
        for c in range(count):
            if parent[c] < 0:
                continue
            d = column[c]
            k = tables.site_contour[d]
            asked = _surcharge(tables, k, d, mask)
            if asked == HARD:
                continue
            total = best[c] + tables.site_cost[d] + asked
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


@kept(nogil=True)
def gather(  # pragma: no cover - compiled
    tables: Tables,
    price: Floats,
    masks: Masks,
    ready: Masks,
    rest: Floats,
    pending: Ints,
    pending_left: Ints,
    hashes: Masks,
    child_site: Shorts,
    child_set: Shorts,
    slots: Shorts,
    new_masks: Masks,
    new_ready: Masks,
    new_rest: Floats,
    new_pending: Ints,
    new_left: Ints,
    new_hashes: Masks,
    set_of: Shorts,
) -> int:
    """Find the sets of the children and describe each once; `set_of` is the set of every child. Returns their number.

    `slots`, a power of two of them, is a hash table of sets; equal hashes are told apart by the sets themselves.
    """
    words = masks.shape[1]
    slots[:] = -1
    span = np.uint64(len(slots) - 1)
    count = 0
    for c in range(len(child_site)):
        source = child_set[c]
        k = tables.site_contour[child_site[c]]
        word, bit = k >> 6, ONE << (np.uint64(k) & LOW)
        key = hashes[source] ^ tables.noise[k]
        slot = key & span
        while slots[slot] >= 0:
            known = slots[slot]
            if new_hashes[known] == key:
                same = True
                for w in range(words):
                    here = masks[source, w]
                    if w == word:
                        here |= bit
                    if here != new_masks[known, w]:
                        same = False
                        break
                if same:
                    break
            slot = (slot + ONE) & span
        if slots[slot] >= 0:
            set_of[c] = slots[slot]
            continue
        slots[slot] = count
        set_of[c] = count
        new_hashes[count] = key
        new_masks[count] = masks[source]
        new_masks[count, word] |= bit
        new_ready[count] = ready[source]
        new_ready[count, word] &= ~bit
        for e in range(tables.open_from[k], tables.open_from[k + 1]):
            j = tables.opens[e]
            if not missing(tables.needs[j], new_masks[count]):
                new_ready[count, j >> 6] |= ONE << (np.uint64(j) & LOW)
        for b in range(len(price)):
            new_rest[count, b] = rest[source, b] - price[b, k]
        left = (pending_left[source] if pending[source] >= 0 else tables.block_size[k]) - 1
        new_left[count] = left
        new_pending[count] = tables.block[k] if left > 0 else -1
        count += 1
    return count


@kept(nogil=True)
def _surcharge(tables: Tables, k: int, d: int, mask: Masks) -> int:  # pragma: no cover - compiled
    """What the conditions make cutting contour k at site d cost when a set is out; `HARD` if it is not lawful."""
    cost = 0
    for q in range(tables.cond_from[k], tables.cond_from[k + 1]):
        if tables.cond_site[q] >= 0 and tables.cond_site[q] != d:
            continue
        total = 0
        for e in range(tables.member_from[q], tables.member_from[q + 1]):
            if has(mask, tables.member[e]):
                total += tables.weight[e]
        if total < tables.cond_bound[q]:
            if tables.cond_cost[q] == HARD:
                return HARD
            cost += tables.cond_cost[q]
    return cost


@kept(nogil=True)
def _crossing(tables: Tables, leave: int, reach: int, mask: Masks) -> int:  # pragma: no cover - compiled
    """What a move costs for the contours that are out; `HARD` if it is not lawful."""
    move = tables.cross_at[leave, reach]
    cost = 0
    if move >= 0:
        for e in range(tables.cross_from[move], tables.cross_from[move + 1]):
            if has(mask, tables.cross_over[e]):
                if tables.cross_cost[e] == HARD:
                    return HARD
                cost += tables.cross_cost[e]
    return cost


@kept(nogil=True)
def _left(tables: Tables, incomplete: np.ndarray, i: int, j: int) -> int:  # pragma: no cover - compiled
    """What leaving soft groups before they are whole costs when contour j follows i."""
    cost = 0
    for g in range(len(incomplete)):
        if incomplete[g] and tables.soft_has[g, i] and not tables.soft_has[g, j]:
            cost += tables.soft_cost[g]
    return cost
