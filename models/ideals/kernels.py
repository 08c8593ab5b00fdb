"""The inner loops of the sweep over ideals, compiled by numba.

A layer holds the ideals (sets that the orders allow to be cut first) of one size. An *entry* is an ideal together
with the contour that was cut last in it; its states are that contour's sites. Values are whole µm held in doubles
(exact far beyond any plan), so that one add-and-min loop serves, infinity included.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from .local import Floats, Ints, Masks


@njit(cache=True)
def successors(
    ideals: Masks, alive: Ints, needs: Masks, mates: Masks
) -> tuple[Masks, Ints, Ints]:  # pragma: no cover - compiled
    """Every way to cut one more contour: the new ideals, the contour cut, and the row of the ideal it came from."""
    n = len(needs)
    count = 0
    for attempt in range(2):
        if attempt == 1:
            grown = np.empty(count, dtype=np.uint64)
            cut = np.empty(count, dtype=np.int64)
            source = np.empty(count, dtype=np.int64)
            count = 0
        for k in range(len(alive)):
            ideal = ideals[alive[k]]
            open_block = np.uint64(0)
            for i in range(n):
                if mates[i] & ideal and mates[i] & ~ideal:
                    open_block = mates[i]
                    break
            for i in range(n):
                bit = np.uint64(1) << np.uint64(i)
                if ideal & bit or needs[i] & ~ideal or (open_block and not open_block & bit):
                    continue
                if attempt == 1:
                    grown[count] = ideal | bit
                    cut[count] = i
                    source[count] = alive[k]
                count += 1
    return grown, cut, source


@njit(cache=True)
def _surcharge(  # pragma: no cover - compiled
    ideal: np.uint64,
    i: int,
    out: Floats,
    first: Ints,
    cond_of: Ints,
    cond_site: Ints,
    cond_from: Ints,
    cond_member: Ints,
    cond_weight: Ints,
    cond_bound: Ints,
    cond_cost: Floats,
) -> None:
    """Add to out[d] what the conditions make site d of contour i cost when `ideal` is already cut."""
    for q in range(cond_of[i], cond_of[i + 1]):
        total = 0
        for k in range(cond_from[q], cond_from[q + 1]):
            if ideal >> np.uint64(cond_member[k]) & np.uint64(1):
                total += cond_weight[k]
        if total < cond_bound[q]:
            if cond_site[q] < 0:
                out[:] += cond_cost[q]
            else:
                out[cond_site[q] - first[i]] += cond_cost[q]


@njit(cache=True)
def _count(mask: np.uint64) -> int:  # pragma: no cover - compiled
    """Number of bits set."""
    count = 0
    while mask:
        mask &= mask - np.uint64(1)
        count += 1
    return count


@njit(cache=True, parallel=True)
def sweep(  # pragma: no cover - compiled
    entry_contour: Ints,
    entry_source: Ints,
    entry_state: Ints,
    ideals: Masks,
    ideal_entry: Ints,
    last_contour: Ints,
    last_state: Ints,
    values: Floats,
    row_of: Ints,
    travel: Floats,
    first: Ints,
    site_cost: Floats,
    cond_of: Ints,
    cond_site: Ints,
    cond_from: Ints,
    cond_member: Ints,
    cond_weight: Ints,
    cond_bound: Ints,
    cond_cost: Floats,
    soft_mask: Masks,
    soft_cost: Floats,
    crossed: Masks,
    crossing_price: float,
    result: Floats,
) -> None:
    """Fill `result`: for every entry (new ideal, contour just cut), the least cost to each of its sites.

    Entry e cuts `entry_contour[e]` from ideal row `entry_source[e]` of the layer before and owns
    `result[entry_state[e]:entry_state[e+1]]`. That ideal's own entries are `ideal_entry[row]` … `ideal_entry[row+1]-1`,
    each with its last contour (-1: where the stretch is entered from) and its states in `values`; the travel rows of
    contour j start at `row_of[j]` (`row_of[-1]` for the entrance). Every contour of `crossed` that is out costs
    `crossing_price` on top (see `crossed.Crossed`).
    """
    for e in prange(len(entry_contour)):
        i = entry_contour[e]
        row = entry_source[e]
        a, b = first[i], first[i + 1]
        best = np.full(b - a, np.inf)
        for s in range(ideal_entry[row], ideal_entry[row + 1]):
            j = last_contour[s]
            extra = 0.0
            if j >= 0:
                for g in range(len(soft_mask)):
                    leaves = soft_mask[g] >> np.uint64(j) & ~(soft_mask[g] >> np.uint64(i)) & np.uint64(1)
                    if leaves and soft_mask[g] & ~ideals[row]:
                        extra += soft_cost[g]
            at = row_of[j]
            for k in range(last_state[s], last_state[s + 1]):
                value = values[k] + extra
                if value < np.inf:
                    r = at + k - last_state[s]
                    if len(crossed):
                        for d in range(b - a):
                            over = _count(crossed[r, a + d] & ideals[row])
                            if over:
                                best[d] = min(best[d], value + travel[r, a + d] + over * crossing_price)
                            else:
                                best[d] = min(best[d], value + travel[r, a + d])
                    else:
                        for d in range(b - a):
                            best[d] = min(best[d], value + travel[r, a + d])
        best += site_cost[a:b]
        _surcharge(
            ideals[row], i, best, first, cond_of, cond_site, cond_from, cond_member, cond_weight, cond_bound, cond_cost
        )
        result[entry_state[e] : entry_state[e + 1]] = best
