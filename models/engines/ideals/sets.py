"""The sets that the orders allow to be cut first, grown layer by layer, and counted beforehand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Int16s, Int32s, Ints, concat_ranges
from kerfwise.models.engines.tuning import (
    ADDITIONS_A_STATE,
    ADDITIONS_AN_ENTRY,
    BYTES_A_STATE,
    BYTES_AN_ENTRY,
    COUNTED_FASTER,
    SHARE_KEPT,
    SLOTS_AT_FIRST,
    STEPS_A_SET,
    STEPS_A_WORD,
)
from kerfwise.models.engines.tuning import SETS_ADDITIONS_PER_S as ADDITIONS_PER_S
from kerfwise.models.jit import KERNEL, inner, jit, suited
from kerfwise.models.problem.bitsets import LOW, ONE, Masks, bit_number, bits_of, missing, words
from kerfwise.models.problem.problem import Problem

from .stretch import OrderSets, orders_of, series

# The sets that the orders allow to be cut first, layer by layer: those of one size from those one smaller.


@dataclass(frozen=True, eq=False, slots=True)
class Sets:
    """s sets of one size. `masks`, `ready` (s, w) are the sets and what may be cut next, blocks aside; `pending` (s) is
    a block that is not whole, or -1; `width` (s) the number of states (last sites) that a set has.
    """

    masks: Masks
    ready: Masks
    pending: Int32s
    width: Ints
    hashes: Masks

    def __len__(self) -> int:
        return len(self.width)

    @staticmethod
    def empty(orders: OrderSets, ways: int) -> Sets:
        """The set of no contours, which has as many states as there are ways in."""
        k = len(orders.size)
        ready = np.zeros((1, words(k)), dtype=np.uint64)
        for i in np.flatnonzero(~orders.needs.any(axis=1)):
            ready[0, i // 64] |= np.uint64(1 << int(i) % 64)
        return Sets(np.zeros_like(ready), ready, np.full(1, -1, np.int32), np.array([ways]), np.zeros(1, np.uint64))

    def first(self, count: int) -> Sets:
        """The first of them."""
        masks, ready, hashes = self.masks[:count], self.ready[:count], self.hashes[:count]
        return Sets(masks, ready, self.pending[:count], self.width[:count], hashes)


class Layer(NamedTuple):
    """Sets as kernels take them; of those that are made, the entries that lead to them as well (see `grow`)."""

    masks: Masks
    ready: Masks
    pending: Int32s
    width: Ints
    hashes: Masks
    contour: Int16s
    target: Int32s
    entry_from: Ints

    @staticmethod
    def of(sets: Sets, entries: int = 0, sources: int = 0) -> Layer:
        """Of sets, whose arrays are not copied, with room for entries from some sources."""
        contour, target = np.empty(entries, np.int16), np.empty(entries, np.int32)
        rows = sets.masks, sets.ready, sets.pending, sets.width, sets.hashes
        return Layer(*rows, contour, target, np.zeros(sources + 1, np.int64))


@dataclass(frozen=True, eq=False, slots=True)
class Growth:
    """What cutting one more contour from some sets takes: entries (set, contour cut), states and additions."""

    entries: int
    states: int
    additions: float


def growth(orders: OrderSets, sets: Sets, alive: Ints) -> Growth:
    """Count before anything is made."""
    steps = len(alive) * sets.ready.shape[1] * STEPS_A_WORD
    entries, states, additions = suited(_count, steps, count_by_arrays)(
        orders, sets.ready, sets.pending, sets.width, alive
    )
    return Growth(entries, states, float(additions))


def grow(orders: OrderSets, sets: Sets, alive: Ints, entries: int) -> tuple[Sets, Int16s, Int32s, Ints]:
    """The sets that cutting one more contour from the sets `alive` leads to.

    Returns them, and of every entry the contour cut and the set it leads to; entries of `alive[a]` are `entry_from[a]`
    … `entry_from[a + 1] - 1`.
    """
    step, words = suited(_grow, entries * STEPS_A_SET, grow_by_arrays), sets.masks.shape[1]
    made = Sets(
        masks=np.empty((entries, words), np.uint64),
        ready=np.empty((entries, words), np.uint64),
        pending=np.empty(entries, np.int32),
        width=np.empty(entries, np.int64),
        hashes=np.empty(entries, np.uint64),
    )
    came, goes = Layer.of(sets), Layer.of(made, entries, len(alive))
    slots, far = np.zeros(SLOTS_AT_FIRST, np.int32), np.zeros(2, np.int64)
    while step(orders, came, alive, goes, slots, far) < len(alive):
        slots = np.zeros(4 * len(slots), np.int32)
    return made.first(int(far[1])), goes.contour, goes.target, goes.entry_from


@inner(**KERNEL)
def ready_word(orders: OrderSets, ready: Masks, pending: Int32s, k: int, w: int) -> np.uint64:  # pragma: no cover
    """Word w of what may be cut next, once set k is out."""
    bits = ready[k, w]
    if pending[k] >= 0:
        bits &= orders.block_mask[pending[k], w]
    return np.uint64(bits)


@jit(**KERNEL)
def _count(  # pragma: no cover - compiled
    orders: OrderSets, ready: Masks, pending: Int32s, width: Ints, alive: Ints
) -> tuple[int, int, int]:
    entries = states = additions = 0
    for k in alive:
        sites = 0
        for w in range(ready.shape[1]):
            bits = ready_word(orders, ready, pending, k, w)
            while bits:
                low = bits & (~bits + ONE)
                bits ^= low
                sites += orders.size[w * 64 + bit_number(low)]
                entries += 1
        states += sites
        additions += sites * width[k]
    return entries, states, additions


@inner(**KERNEL)
def find_slot(  # pragma: no cover - compiled
    slots: Int32s, key: np.uint64, masks: Masks, hashes: Masks, source: Masks, word: int, bit: np.uint64
) -> int:
    """The slot of a set (`source` and one bit more), or the free slot where it belongs; slots hold numbers from 1."""
    span = np.uint64(len(slots) - 1)
    slot = key & span
    while slots[slot] > 0:
        known = slots[slot] - 1
        if hashes[known] == key:
            same = True
            for w in range(len(source)):
                here = source[w]
                if w == word:
                    here |= bit
                if here != masks[known, w]:
                    same = False
                    break
            if same:
                break
        slot = (slot + ONE) & span
    return int(slot)


@inner(**KERNEL)
def extend_set(  # pragma: no cover - compiled
    orders: OrderSets, mask: Masks, ready: Masks, i: int, new_mask: Masks, new_ready: Masks
) -> int:
    """Write the set that cutting contour i leads to, and what may be cut next; the block that is not whole, or -1."""
    bit = ONE << (np.uint64(i) & LOW)
    for w in range(len(mask)):  # numba takes seconds to compile what copies an array into another
        new_mask[w], new_ready[w] = mask[w], ready[w]
    new_mask[i >> 6] |= bit
    new_ready[i >> 6] &= ~bit
    for e in range(orders.open_from[i], orders.open_from[i + 1]):
        j = orders.opens[e]
        if not missing(orders.needs[j], new_mask):
            new_ready[j >> 6] |= ONE << (np.uint64(j) & LOW)
    block = orders.block[i]
    return block if block >= 0 and missing(orders.block_mask[block], new_mask) else -1


@jit(**KERNEL)
def _grow(  # pragma: no cover - compiled
    orders: OrderSets, came: Layer, alive: Ints, goes: Layer, slots: Int32s, far: Ints
) -> int:
    """Grow from `alive[far[0]]` on, where `far[1]` sets are made; how far it came before slots, empty now, were few."""
    begin, count, span = far[0], far[1], np.uint64(len(slots) - 1)
    for known in range(count):
        free = goes.hashes[known] & span
        while slots[free] > 0:
            free = (free + ONE) & span
        slots[free] = known + 1
    used, new_masks, new_ready = goes.entry_from[begin], goes.masks, goes.ready
    for a in range(begin, len(alive)):
        far[0], far[1] = a, count
        if 2 * (count + len(orders.size)) > len(slots):
            return int(a)
        k = alive[a]
        for w in range(new_masks.shape[1]):
            bits = ready_word(orders, came.ready, came.pending, k, w)
            while bits:
                bit = bits & (~bits + ONE)
                bits ^= bit
                i = w * 64 + bit_number(bit)
                key = came.hashes[k] ^ orders.noise[i]
                slot = find_slot(slots, key, new_masks, goes.hashes, came.masks[k], w, bit)
                known = slots[slot] - 1
                if known < 0:
                    known = count
                    goes.hashes[known], goes.width[known] = key, 0
                    goes.pending[known] = extend_set(
                        orders, came.masks[k], came.ready[k], i, new_masks[known], new_ready[known]
                    )
                    count += 1
                    slots[slot] = count
                goes.width[known] += orders.size[i]
                goes.contour[used], goes.target[used] = i, known
                used += 1
        goes.entry_from[a + 1] = used
    far[1] = count
    return len(alive)


# The same by whole arrays, number for number, where sets are few.


def count_by_arrays(orders: OrderSets, ready: Masks, pending: Int32s, width: Ints, alive: Ints) -> tuple[int, int, int]:
    """Entries, states and additions of the layer that follows the sets `alive`."""
    may_follow = _may_follow(orders, ready, pending, alive)
    sites = may_follow @ orders.size
    return int(may_follow.sum()), int(sites.sum()), int(sites @ width[alive])


def grow_by_arrays(orders: OrderSets, came: Layer, alive: Ints, goes: Layer, slots: Int32s, far: Ints) -> int:
    """That layer, its sets numbered as they come up; see `grow`."""
    may_follow = _may_follow(orders, came.ready, came.pending, alive)
    a, i = np.nonzero(may_follow)
    k, word, bit = alive[a], i >> 6, ONE << (i.astype(np.uint64) & LOW)
    reached = came.masks[k]
    reached[np.arange(len(i)), word] |= bit
    keys = reached[:, 0] if reached.shape[1] == 1 else reached
    _, first, target = np.unique(keys, return_index=True, return_inverse=True, axis=0)
    in_turn = np.argsort(first)
    first, number = first[in_turn], np.argsort(in_turn)
    i_of, count = i[first], len(first)
    masks, ready = reached[first], came.ready[k[first]]
    ready[np.arange(count), word[first]] &= ~bit[first]
    opened = orders.open_from[i_of + 1] - orders.open_from[i_of]
    row, j = np.repeat(np.arange(count), opened), orders.opens[concat_ranges(orders.open_from[i_of], opened)]
    free = ~(orders.needs[j] & ~masks[row]).any(axis=1)
    np.bitwise_or.at(ready, (row[free], j[free] >> 6), ONE << (j[free].astype(np.uint64) & LOW))
    block = orders.block[i_of]
    begun = np.flatnonzero(block >= 0)
    whole = ~(orders.block_mask[block[begun]] & ~masks[begun]).any(axis=1)
    block[begun[whole]] = -1
    goes.masks[:count], goes.ready[:count], goes.pending[:count] = masks, ready, block
    goes.hashes[:count] = came.hashes[k[first]] ^ orders.noise[i_of]
    goes.contour[:], goes.target[:] = i, number[target.ravel()]
    goes.width[:count] = np.bincount(goes.target, weights=orders.size[i], minlength=count)
    goes.entry_from[1:] = np.cumsum(may_follow.sum(axis=1))
    far[:] = len(alive), count
    return len(alive)


def _may_follow(orders: OrderSets, ready: Masks, pending: Int32s, alive: Ints) -> Bools:
    """Which contours may be cut next once each of the sets `alive` is out, (len(alive), contours)."""
    words, waiting = ready[alive], pending[alive]
    within = waiting >= 0
    words[within] &= orders.block_mask[waiting[within]]
    return bits_of(words, len(orders.size))


# Counts the sets of a problem before anything is made of them: what a sweep without any bound would take.


@dataclass(frozen=True, slots=True)
class Count:
    """Of all stretches together: sets, entries (a set and the last contour in it), states (and the last site in it).

    `whole` is False where counting was given up; the numbers are then those reached.
    """

    stretches: int
    longest: int
    sets: int
    entries: int
    states: int
    additions: float
    whole: bool

    @property
    def seconds(self) -> float:
        """What a sweep takes, in deterministic seconds."""
        return additions_of(self.additions, self.entries, self.states) / ADDITIONS_PER_S

    def fits(self, most_bytes: float) -> bool:
        """Whether all is counted, and can be kept in so many bytes."""
        return self.whole and self.entries * BYTES_AN_ENTRY + self.states * BYTES_A_STATE <= SHARE_KEPT * most_bytes

    @property
    def work(self) -> float:
        """What counting took, in deterministic seconds."""
        return self.entries * ADDITIONS_AN_ENTRY / COUNTED_FASTER / ADDITIONS_PER_S

    def __str__(self) -> str:
        size = f"{'' if self.whole else 'more than '}{self.sets} sets, {self.states} states"
        return f"{size}, {self.stretches} stretches one after the other, of {self.longest} contours at most"


def additions_of(additions: float, entries: int, states: int) -> float:
    """What a layer takes, in additions."""
    return additions + ADDITIONS_AN_ENTRY * entries + ADDITIONS_A_STATE * states


def count_sets(problem: Problem, most_entries: float, going: Callable[[int], bool] = lambda _: True) -> Count:
    """Count until there are more than `most_entries`, fewer where sets are long, or are bound to be.

    Where the sets of the first layers are already more than their share, those of the middle would be far too many.
    `going` is asked before each layer whether to go on, and told how many there are so far.
    """
    stretches = series(problem)
    most_entries *= min(1.0, 2 / words(max(map(len, stretches), default=0)))
    sets = entries = states = done = 0
    additions, ways = 0.0, 1
    for group in stretches:
        orders = orders_of(problem, group)
        layer = Sets.empty(orders, ways)
        for _ in group:
            alive = np.arange(len(layer))
            ahead = growth(orders, layer, alive)
            entries, states = entries + ahead.entries, states + ahead.states
            additions += ahead.additions
            done += 1
            if entries > most_entries * min(1.0, 2 * done / problem.n) or not going(entries):
                return Count(len(stretches), max(map(len, stretches)), sets, entries, states, additions, False)
            layer, *_ = grow(orders, layer, alive, ahead.entries)
            sets += len(layer)
        ways = int(layer.width.sum())
    return Count(len(stretches), max(map(len, stretches), default=0), sets, entries, states, additions, True)
