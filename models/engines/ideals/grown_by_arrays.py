"""Layers of sets by whole arrays: what `sets` and `kernels.arrange` say compiled, in the same order, where few are."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Int16s, Int32s, Ints
from kerfwise.encoder.ranges import laid_out
from kerfwise.models.problem.bits import LOW, ONE, Masks, bits_of

from .local import OrderSets


def count_by_arrays(orders: OrderSets, ready: Masks, pending: Int32s, width: Ints, alive: Ints) -> tuple[int, int, int]:
    """Entries, states and additions of the layer that follows the sets `alive`."""
    next_ones = _next_ones(orders, ready, pending, alive)
    sites = next_ones @ orders.size
    return int(next_ones.sum()), int(sites.sum()), int(sites @ width[alive])


def grow_by_arrays(
    orders: OrderSets, masks: Masks, ready: Masks, pending: Int32s, hashes: Masks, alive: Ints, entries: int
) -> tuple[Masks, Masks, Int32s, Ints, Masks, Int16s, Int32s, Ints]:
    """The sets of that layer, numbered as they come up, and its entries."""
    next_ones = _next_ones(orders, ready, pending, alive)
    a, i = np.nonzero(next_ones)
    k, word, bit = alive[a], i >> 6, ONE << (i.astype(np.uint64) & LOW)
    reached = masks[k]
    reached[np.arange(entries), word] |= bit
    first, target = _numbered(reached)
    i_of, new_masks, new_ready = i[first], reached[first], ready[k[first]]
    new_ready[np.arange(len(first)), word[first]] &= ~bit[first]
    _open(orders, i_of, new_masks, new_ready)
    block = orders.block[i_of]
    whole = block < 0
    whole[~whole] = ~(orders.block_mask[block[~whole]] & ~new_masks[~whole]).any(axis=1)
    width = np.bincount(target, weights=orders.size[i], minlength=len(first)).astype(np.int64)
    return (
        new_masks, new_ready, np.where(whole, -1, block).astype(np.int32), width, hashes[k[first]] ^ orders.noise[i_of],
        i.astype(np.int16), target.astype(np.int32), np.append(0, np.cumsum(next_ones.sum(axis=1))),
    )  # fmt: skip


def arrange_by_arrays(
    contour: Int16s, target: Int32s, entry_from: Ints, alive: Ints, sets: int, size: Ints
) -> tuple[Ints, Int16s, Int32s, Ints, Ints]:
    """Entries sorted by the set that they lead to (see `kernels.arrange`)."""
    order = np.argsort(target, kind="stable")
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    source = np.repeat(alive, np.diff(entry_from)).astype(np.int32)
    ideal_entry = np.append(0, np.cumsum(np.bincount(target, minlength=sets)))
    return ideal_entry, contour[order], source[order], place, np.append(0, np.cumsum(size[contour[order]]))


def _next_ones(orders: OrderSets, ready: Masks, pending: Int32s, alive: Ints) -> Bools:
    """Which contours may be cut next once each of the sets `alive` is out, (len(alive), contours)."""
    words, waiting = ready[alive], pending[alive]
    within = waiting >= 0
    words[within] &= orders.block_mask[waiting[within]]
    return bits_of(words, len(orders.size))


def _numbered(reached: Masks) -> tuple[Ints, Ints]:
    """Where every set of some rows comes up first, in that order, and for every row the number of its set."""
    order = np.lexsort(reached.T)
    fresh = np.append(True, (reached[order[1:]] != reached[order[:-1]]).any(axis=1))[: len(order)]
    first = order[fresh]  # a stable sort: of rows that are the same the first comes first
    number = np.empty(len(first), dtype=np.int64)
    by_first = np.argsort(first)
    number[by_first] = np.arange(len(first))
    target = np.empty(len(order), dtype=np.int64)
    target[order] = number[np.cumsum(fresh) - 1]
    return first[by_first], target


def _open(orders: OrderSets, i_of: Ints, masks: Masks, ready: Masks) -> None:
    """What may be cut once contour `i_of` of every set is out, too, is put into `ready`."""
    count = orders.open_from[i_of + 1] - orders.open_from[i_of]
    row, j = np.repeat(np.arange(len(i_of)), count), orders.opens[laid_out(orders.open_from[i_of], count)]
    opened = ~(orders.needs[j] & ~masks[row]).any(axis=1)
    row, j = row[opened], j[opened]
    np.bitwise_or.at(ready, (row, j >> 6), ONE << (j.astype(np.uint64) & LOW))
