"""Precedence, closed: everything that must come before everything else, blocks of contours included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.components import strong_components
from kerfwise.models.kernels import kept, suited

from .bits import LOW, ONE, ROWS_AT_ONCE, Masks, words


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
        before = before.take(member, axis=0).take(member, axis=1)
    linked, place = np.unique(np.concatenate([sooner[together], later[together]]), return_inverse=True)
    if len(linked):
        before[np.ix_(linked, linked)] |= _closed(len(linked), place.reshape(2, -1).T)
    return before


def transitive(direct: Bools) -> Bools:
    """Transitive closure of a square relation; members of a cycle get a true diagonal (and perhaps no more)."""
    return _closed(len(direct), np.argwhere(direct))


def _closed(n: int, links: Ints) -> Bools:
    """The same of n things, of links (k, 2) from one to another, in any order and some perhaps more than once."""
    sooner, later = np.divmod(np.unique(links[:, 1] * n + links[:, 0]), n)[::-1]
    closed = np.zeros((n, words(n)), dtype=np.uint64)
    np.bitwise_or.at(closed, (sooner, later >> 6), ONE << (later.astype(np.uint64) & LOW))
    waiting = np.bincount(sooner, minlength=n)
    first = np.searchsorted(later, np.arange(n + 1))
    suited(_hand_on, n + closed.shape[1] * len(sooner))(first, sooner, waiting, closed)
    bits = closed.astype("<u8", copy=False).view(np.uint8)
    whole = np.unpackbits(bits, axis=1, count=n, bitorder="little").view(np.bool_)
    if waiting.any():
        label = strong_components(n, np.column_stack([sooner, later]))
        on_cycle = np.bincount(label, minlength=n)[label] > 1
        whole[on_cycle, on_cycle] = True
    return whole


@kept(nogil=True)
def _hand_on(first: Ints, sooner: Ints, waiting: Ints, closed: Masks) -> None:  # pragma: no cover - compiled
    """Hand on what comes after everything, the last first; `waiting` counts what comes after it and is not done.

    What comes directly before j are `sooner[first[j]]` … `sooner[first[j + 1] - 1]`.
    """
    n = len(waiting)
    ready = np.empty(n, np.int64)
    count = 0
    for j in range(n):
        if waiting[j] == 0:
            ready[count] = j
            count += 1
    while count > 0:
        count -= 1
        j = ready[count]
        for i in sooner[first[j] : first[j + 1]]:
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
    near[tuple(immediate_pairs(packed(before.T)))] = True
    return near


def immediate_pairs(sooner: Masks) -> Ints:
    """The same as columns i, j, (2, pairs), by j; rows of `sooner` are what comes before each.

    Examples
    --------
    >>> immediate_pairs(np.array([[0], [1], [3]], dtype=np.uint64)).tolist()
    [[0, 1], [1, 2]]
    """
    rank = np.bitwise_count(sooner).sum(axis=1, dtype=np.int64)
    latest_first = np.argsort(-rank, kind="stable")
    return suited(_immediate_pairs, len(rank) * len(rank))(sooner, rank, latest_first)


def packed(relation: Bools) -> Masks:
    """The rows of a relation as sets of bits.

    Examples
    --------
    >>> packed(np.array([[True, False, True]])).tolist()
    [[5]]
    """
    rows, columns = relation.shape
    padded = np.zeros((rows, words(columns) * 8), dtype=np.uint8)
    for k in range(0, rows, ROWS_AT_ONCE):  # a relation turned over is copied for it
        some = slice(k, k + ROWS_AT_ONCE)
        padded[some, : -(-columns // 8)] = np.packbits(relation[some], axis=1, bitorder="little")
    return padded.view("<u8").astype(np.uint64, copy=False)


@kept(nogil=True)
def _immediate_pairs(sooner: Masks, rank: Ints, latest_first: Ints) -> Ints:  # pragma: no cover - compiled
    """Of what comes before every contour, all that is not before another of them; those of the highest rank first."""
    covered = np.empty(sooner.shape[1], np.uint64)
    pairs = np.empty((2, 4 * len(rank) + 1), np.int64)
    count = 0
    for j in range(len(rank)):
        covered[:] = 0
        left = rank[j]
        for i in latest_first:
            if left == 0:
                break
            word, bit = i >> 6, np.uint64(i & 63)
            if not sooner[j, word] >> bit & np.uint64(1):
                continue
            left -= 1
            if covered[word] >> bit & np.uint64(1):
                continue
            if count == pairs.shape[1]:
                wider = np.empty((2, 2 * count), np.int64)
                for k in range(count):  # numba takes seconds to compile what copies a block
                    wider[0, k], wider[1, k] = pairs[0, k], pairs[1, k]
                pairs = wider
            pairs[0, count], pairs[1, count] = i, j
            count += 1
            for w in range(len(covered)):
                covered[w] |= sooner[i, w]
    return pairs[:, :count].copy()
