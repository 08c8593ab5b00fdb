"""Precedence, closed: everything that must come before everything else, blocks of contours included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.components import strong_components
from kerfwise.models.kernels import kept, suited

from .bits import Masks


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
    lifted = np.zeros((len(names), len(names)), dtype=np.bool_)
    lifted[member[sooner[~together]], member[later[~together]]] = True
    before = transitive(lifted).take(member, axis=0).take(member, axis=1)
    linked, place = np.unique(np.concatenate([sooner[together], later[together]]), return_inverse=True)
    inside = np.zeros((len(linked), len(linked)), dtype=np.bool_)
    inside[tuple(place.reshape(2, -1))] = True
    before[np.ix_(linked, linked)] |= transitive(inside)
    return before


def transitive(direct: Bools) -> Bools:
    """Transitive closure of a square relation; members of a cycle get a true diagonal (and perhaps no more)."""
    n = len(direct)
    closed = packed(direct)
    waiting = direct.sum(axis=1)
    suited(_close, n * n)(np.ascontiguousarray(direct.T), waiting, closed)
    on_cycle = _on_cycles(direct) if waiting.any() else np.zeros(n, dtype=np.bool_)
    bits = np.unpackbits(closed.astype("<u8", copy=False).view(np.uint8), axis=1, count=n, bitorder="little")
    whole = bits.view(np.bool_)
    whole[on_cycle, on_cycle] = True
    return whole


def _on_cycles(direct: Bools) -> Bools:
    label = strong_components(len(direct), np.argwhere(direct))
    return np.asarray(np.bincount(label, minlength=len(direct))[label] > 1)


@kept(nogil=True)
def _close(sooner: Bools, waiting: Ints, closed: Masks) -> None:  # pragma: no cover - compiled
    """Hand on what comes after every contour, the last first; `waiting` counts those after it that are not done."""
    n = len(sooner)
    ready = np.empty(n, np.int64)
    count = 0
    for j in range(n):
        if waiting[j] == 0:
            ready[count] = j
            count += 1
    while count > 0:
        count -= 1
        j = ready[count]
        for i in range(n):
            if sooner[j, i]:
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
    rank = before.sum(axis=0)
    latest_first = np.argsort(-rank, kind="stable").astype(np.int64)
    kept = np.zeros_like(before)
    suited(_mark_immediate, before.size)(np.ascontiguousarray(before.T), packed(before.T), latest_first, kept)
    return kept


def packed(relation: Bools) -> Masks:
    """The rows of a relation as sets of bits.

    Examples
    --------
    >>> packed(np.array([[True, False, True]])).tolist()
    [[5]]
    """
    rows, columns = relation.shape
    padded = np.zeros((rows, max(1, -(-columns // 64)) * 8), dtype=np.uint8)
    padded[:, : -(-columns // 8)] = np.packbits(relation, axis=1, bitorder="little")
    return padded.view("<u8").astype(np.uint64, copy=False)


@kept(nogil=True)
def _mark_immediate(
    sooner: Bools, masks: Masks, latest_first: Ints, kept: Bools
) -> None:  # pragma: no cover - compiled
    """Of what comes before every contour, all that is not before another of them; those of the highest rank first."""
    n = len(sooner)
    covered = np.empty(masks.shape[1], np.uint64)
    for j in range(n):
        covered[:] = 0
        left = sooner[j].sum()
        for i in latest_first:
            if left == 0:
                break
            if not sooner[j, i]:
                continue
            left -= 1
            if covered[i >> 6] >> np.uint64(i & 63) & np.uint64(1):
                continue
            kept[i, j] = True
            for w in range(len(covered)):
                covered[w] |= masks[i, w]
