"""Precedence, closed: what must come before what, and which contour may directly follow which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Ints, unique
from kerfwise.encoder.graphs import strong_components
from kerfwise.models.jit import KERNEL, jit, suited

from .bitsets import LOW, ONE, ROWS_AT_ONCE, LastAnswer, Masks, bit_number, digest, words
from .moves import PairTable

# Precedence, closed: everything that must come before everything else, blocks of contours included.

_last = LastAnswer[Ints]()
STEPS_A_CONTOUR = 4
"""Sets that are looked through to tell what comes directly before a contour, about."""


def close(n: int, pairs: Sequence[tuple[int, int]] | Ints, block: Ints) -> Bools:
    """Matrix (n, n): i must be cut before j, given pairs (before, after) and contiguous blocks.

    A contour outside a block that precedes (follows) one member precedes (follows) all of them, since nothing else
    may come between them. A true diagonal marks contours that the pairs contradict each other about.

    Examples
    --------
    >>> close(3, [(0, 1)], np.array([0, 1, 1]))[0].tolist()
    [False, True, True]
    """
    sooner, later = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    together = block[sooner] == block[later]
    names, member = np.unique(block, return_inverse=True)
    before = _closed(len(names), np.column_stack([member[sooner[~together]], member[later[~together]]]))
    if not np.array_equal(member, np.arange(len(names))):
        of_blocks, before = before, np.empty((n, n), dtype=np.bool_)
        for k in range(0, n, ROWS_AT_ONCE):
            np.take(of_blocks[member[k : k + ROWS_AT_ONCE]], member, axis=1, out=before[k : k + ROWS_AT_ONCE])
    within = np.column_stack([sooner[together], later[together]])
    within = within[np.argsort(member[within[:, 0]], kind="stable")]
    for links in np.split(within, np.flatnonzero(np.diff(member[within[:, 0]])) + 1):
        linked, place = np.unique(links, return_inverse=True)
        before[np.ix_(linked, linked)] |= _closed(len(linked), place.reshape(-1, 2))
    return before


def transitive(direct: Bools) -> Bools:
    """Transitive closure of a square relation; members of a cycle get a true diagonal (and perhaps no more)."""
    return _closed(len(direct), np.argwhere(direct))


def _closed(n: int, links: Ints) -> Bools:
    """The same of n things, of links (k, 2) from one to another, in any order and some perhaps more than once."""
    sooner, later = np.divmod(unique(links[:, 1] * n + links[:, 0]), n)[::-1]
    closed = np.zeros((n, words(n)), dtype=np.uint64)
    np.bitwise_or.at(closed, (sooner, later >> 6), ONE << (later.astype(np.uint64) & LOW))
    waiting = np.bincount(sooner, minlength=n)
    first = np.searchsorted(later, np.arange(n + 1))
    suited(_hand_on, n + closed.shape[1] * len(sooner))(first, sooner, waiting, closed, np.empty(n, np.int64))
    whole = unpacked(closed, n)
    if waiting.any():
        label = strong_components(n, np.column_stack([sooner, later]))
        on_cycle = np.bincount(label, minlength=n)[label] > 1
        whole[on_cycle, on_cycle] = True
    return whole


@jit(**KERNEL)
def _hand_on(  # pragma: no cover - compiled
    first: Ints, sooner: Ints, waiting: Ints, closed: Masks, ready: Ints
) -> None:
    """Hand on what comes after everything, the last first; `waiting` counts what comes after it and is not done.

    What comes directly before j are `sooner[first[j]]` … `sooner[first[j + 1] - 1]`. `ready` is room for all of them.
    """
    count = 0
    for j in range(len(waiting)):
        if waiting[j] == 0:
            ready[count] = j
            count += 1
    while count > 0:
        count -= 1
        j = ready[count]
        for k in range(first[j], first[j + 1]):
            i = sooner[k]
            for w in range(closed.shape[1]):
                closed[i, w] |= closed[j, w]
            waiting[i] -= 1
            if waiting[i] == 0:
                ready[count] = i
                count += 1


def immediate(before: Bools) -> Bools:
    """The pairs of a closed order with no third contour between them (its transitive reduction).

    Examples
    --------
    >>> chain = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=bool)
    >>> immediate(chain).astype(int).tolist()
    [[0, 1, 0], [0, 0, 1], [0, 0, 0]]
    """
    near = np.zeros_like(before)
    near[tuple(_immediate(before, columns_packed(before)))] = True
    return near


def known_immediate_pairs(before: Bools, sooner: Masks | None = None) -> Ints:
    """The same as columns i, j, (2, pairs), by j, found once where it is asked for again.

    The order must not change meanwhile; rows of `sooner` are what comes before each.

    Examples
    --------
    >>> known_immediate_pairs(np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=np.bool_)).tolist()
    [[0, 1], [1, 2]]
    """
    pairs = _last.known(before, b"")
    if pairs is None:
        pairs = _immediate(before, columns_packed(before) if sooner is None else sooner)
        _last.keep(before, b"", pairs)
    return pairs


def _immediate(before: Bools, sooner: Masks) -> Ints:
    rank = np.bitwise_count(sooner).sum(axis=1, dtype=np.int64)
    latest_first = np.argsort(-rank, kind="stable")
    ranked = columns_packed(before, latest_first)
    step, n = suited(_immediate_pairs, STEPS_A_CONTOUR * ranked.size), len(latest_first)
    left, pairs, far = np.empty(ranked.shape[1], np.uint64), np.empty((2, 5 * n), np.int64), np.zeros(2, np.int64)
    while step(ranked, latest_first, left, pairs, far) < n:
        pairs = np.hstack([pairs, np.empty_like(pairs)])
    return pairs[:, : far[1]].copy()


def unpacked(sets: Masks, n: int) -> Bools:
    """Sets of n things as rows of a relation (sets, n).

    Examples
    --------
    >>> unpacked(np.array([[5]], dtype=np.uint64), 3).tolist()
    [[True, False, True]]
    """
    bits = np.ascontiguousarray(sets).astype("<u8", copy=False).view(np.uint8)
    return np.unpackbits(bits, axis=1, count=n, bitorder="little").view(np.bool_)


def columns_packed(relation: Bools, rows: Ints | None = None) -> Masks:
    """The columns of a relation as sets of bits, its rows taken in the order of the numbers `rows`, where told.

    It is a good deal quicker than to turn the relation over: bytes of eight rows are put together.

    Examples
    --------
    >>> columns_packed(np.array([[True, False, True], [False, False, True]])).tolist()
    [[1], [0], [3]]
    >>> columns_packed(np.array([[True, False, True], [False, False, True]]), np.array([1, 0])).tolist()
    [[2], [0], [3]]
    """
    count, columns = relation.shape
    chosen = np.arange(count) if rows is None else rows
    padded = np.zeros((columns, words(count) * 8), dtype=np.uint8)
    for k in range(0, count, ROWS_AT_ONCE):
        some = relation[chosen[k : k + ROWS_AT_ONCE]].view(np.uint8)
        if short := -len(some) % 8:
            some = np.concatenate([some, np.zeros((short, columns), dtype=np.uint8)])
        eights = some.reshape(len(some) // 8, 8, columns)
        octets = eights[:, 7].copy()
        for bit in range(6, -1, -1):
            octets <<= 1
            octets |= eights[:, bit]
        padded[:, k // 8 : k // 8 + len(octets)] = octets.T
    return padded.view("<u8").astype(np.uint64, copy=False)


@jit(**KERNEL)
def _immediate_pairs(  # pragma: no cover - compiled
    ranked: Masks, latest_first: Ints, left: Masks, pairs: Ints, far: Ints
) -> int:
    """Of what comes before every contour, all that is not before another of them; those of the highest rank first.

    Bit k of each row of `ranked` stands for contour `latest_first[k]`. Begins with contour `far[0]`, where `far[1]`
    pairs are known; how far it came before there was no room for more. `left` is room for a row.
    """
    n, count = len(latest_first), far[1]
    for j in range(far[0], n):
        far[0], far[1] = j, count
        if count + n > pairs.shape[1]:
            return int(j)
        for w in range(len(left)):
            left[w] = ranked[j, w]
        for word in range(len(left)):
            while left[word]:
                i = latest_first[(word << 6) + bit_number(left[word] & ~(left[word] - ONE))]
                pairs[0, count], pairs[1, count] = i, j
                count += 1
                left[word] &= left[word] - ONE
                for w in range(word, len(left)):  # what comes before i has a lower rank
                    left[w] &= ~ranked[i, w]
    far[1] = count
    return n


# Which contour may directly follow which, kept as bits: of 10,000 contours 12.5 MB.


@dataclass(frozen=True, eq=False, slots=True)
class Followers:
    """Of n contours and home, which is number n: row i of `bits` are those that may directly follow i.

    Examples
    --------
    >>> followers = Followers.of(np.array([[False, True], [True, False]]))
    >>> len(followers), followers[0].tolist(), followers.ahead_of(0).tolist(), followers.at([0, 1], [1, 1]).tolist()
    (2, [False, True], [False, True], [True, False])
    """

    bits: NDArray[np.uint8]

    @staticmethod
    def of(lawful: Bools) -> Followers:
        """Of a matrix."""
        return Followers(np.packbits(lawful, axis=1, bitorder="little"))

    def __len__(self) -> int:
        return len(self.bits)

    def __getitem__(self, i: int) -> Bools:
        """Which may follow i, (n + 1,)."""
        row = np.unpackbits(self.bits[i], count=len(self), bitorder="little")
        return row.view(np.bool_)

    def ahead_of(self, j: int) -> Bools:
        """Which j may follow, (n + 1,)."""
        return np.asarray(self.bits[:, j >> 3] >> np.uint8(j & 7) & np.uint8(1)).view(np.bool_)

    def at(self, one: Ints | list[int], other: Ints | list[int]) -> Bools:
        """Whether `other[k]` may follow `one[k]`, (k,)."""
        i, j = np.asarray(one, dtype=np.int64), np.asarray(other, dtype=np.int64)
        return np.asarray(self.bits[i, j >> 3] >> (j & 7).astype(np.uint8) & np.uint8(1)).view(np.bool_)

    def weighed(self, weights: Ints) -> Ints:
        """What the weights (n + 1,) of those that may follow each come to, (n + 1,), without the matrix.

        Examples
        --------
        >>> Followers.of(np.array([[False, True], [True, True]])).weighed(np.array([5, 2])).tolist()
        [2, 7]
        """
        found = np.zeros(len(self), dtype=np.int64)
        for weight in np.unique(weights).tolist():
            alike = np.packbits(weights == weight, bitorder="little")
            found += weight * np.bitwise_count(self.bits & alike).sum(axis=1, dtype=np.int64)
        return found

    def whole(self) -> Bools:
        """As a matrix (n + 1, n + 1): large."""
        return np.unpackbits(self.bits, axis=1, count=len(self), bitorder="little").view(np.bool_)


_last_successors = LastAnswer[Followers]()


def known_followers(
    before: Bools, block: Ints, apart: Sequence[tuple[int, int]] = (), barred: PairTable | None = None
) -> Followers:
    """The same as `lawful_followers`, made once of orders that are asked for again; they must not change meanwhile."""
    unlike = np.array(apart, dtype=np.int64).reshape(-1, 2)
    key = digest(block, unlike, *(() if barred is None else (barred.row, barred.column, barred.key)))
    followers = _last_successors.known(before, key)
    if followers is None:
        followers = lawful_followers(before, block, unlike, barred)
        _last_successors.keep(before, key, followers)
    return followers


def lawful_followers(
    before: Bools, block: Ints, apart: Sequence[tuple[int, int]] | Ints = (), barred: PairTable | None = None
) -> Followers:
    """Which of n + 1 may directly follow which; n is the machine's home.

    `before` is the closed relation of what must come before what, `block` the contiguous block of every contour,
    `apart` are pairs that may not follow each other either way round, and `barred` has a number for each pair of which
    the second may not follow the first.

    Examples
    --------
    >>> chain = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=bool)
    >>> lawful_followers(chain, np.arange(3)).whole().astype(int).tolist()
    [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1, 0, 0, 0]]
    """
    n, wide = len(before), -(-len(before) // 8)
    sooner = columns_packed(before)
    near = known_immediate_pairs(before, sooner)
    near = near[:, np.argsort(near[0], kind="stable")]
    from_row = np.searchsorted(near[0], np.arange(0, n + ROWS_AT_ONCE, ROWS_AT_ONCE))
    first, last = (np.asarray(~before.any(axis=axis)) for axis in (0, 1))
    bits = _across_blocks(before, block)
    for k, row in enumerate(range(0, n, ROWS_AT_ONCE)):
        rows = slice(row, min(row + ROWS_AT_ONCE, n))
        lawful = ~np.packbits(before[rows], axis=1, bitorder="little")
        lawful &= ~sooner[rows].astype("<u8", copy=False).view(np.uint8)[:, :wide]
        one, other = near[:, from_row[k] : from_row[k + 1]]
        np.bitwise_or.at(lawful, (one - row, other >> 3), _bit(other))
        bits[rows, :wide] &= lawful
    itself = np.arange(n)
    bits[itself, itself >> 3] &= ~_bit(itself)
    bits[itself, n >> 3] |= last.astype(np.uint8) << np.uint8(n & 7)
    unlike = np.array(apart, dtype=np.int64).reshape(-1, 2)
    for one, other in (unlike.T, unlike[:, ::-1].T):
        np.bitwise_and.at(bits, (one, other >> 3), ~_bit(other))
    if barred is not None and len(barred):
        everything = np.arange(n + 1)
        for row in range(0, n, ROWS_AT_ONCE):
            some = everything[row : min(row + ROWS_AT_ONCE, n)]
            bits[some] &= ~np.packbits(barred.between(some, everything) > 0, axis=1, bitorder="little")
    bits[n] = np.packbits(np.append(first, False), bitorder="little")
    return Followers(bits)


def _across_blocks(before: Bools, block: Ints) -> NDArray[np.uint8]:
    """Who may follow whom as far as blocks go, as bits: they are entered at a first of them and left at a last."""
    n = len(before)
    enters, leaves = np.ones(n, np.bool_), np.ones(n, np.bool_)
    order = np.argsort(block, kind="stable")
    blocks = [k for k in np.split(order, np.flatnonzero(np.diff(block[order])) + 1) if len(k) > 1]
    for members in blocks:
        within = before[np.ix_(members, members)]
        enters[members], leaves[members] = ~within.any(axis=0), ~within.any(axis=1)
    bits = np.zeros((n + 1, n // 8 + 1), dtype=np.uint8)
    bits[:n][leaves] = np.packbits(np.append(enters, False), bitorder="little")
    for members in blocks:
        bits[members] |= np.packbits(np.bincount(members, minlength=n + 1).astype(np.bool_), bitorder="little")
    return bits


def _bit(number: Ints) -> NDArray[np.uint8]:
    """Where each number is in its byte."""
    return np.uint8(1) << (number & 7).astype(np.uint8)
