"""Precedence, closed: everything that must come before everything else, blocks of contours included."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]


def close(n: int, pairs: list[tuple[int, int]], block: Ints) -> Bools:
    """Matrix (n, n): i must be cut before j, given pairs (before, after) and contiguous blocks.

    A contour outside a block that precedes (follows) one member precedes (follows) all of them, since nothing else
    may come between them. A true diagonal marks contours that the pairs contradict each other about.

    Examples
    --------
    >>> close(3, [(0, 1)], np.array([0, 1, 1]))[0].tolist()
    [False, True, True]
    """
    between = np.zeros((n, n), dtype=np.bool_)
    inside = np.zeros((n, n), dtype=np.bool_)
    for i, j in pairs:
        (inside if block[i] == block[j] else between)[i, j] = True
    names, member = np.unique(block, return_inverse=True)
    lifted = np.zeros((len(names), len(names)), dtype=np.bool_)
    rows, columns = np.nonzero(between)
    lifted[member[rows], member[columns]] = True
    return np.asarray(transitive(lifted)[np.ix_(member, member)] | transitive(inside))


def transitive(direct: Bools) -> Bools:
    """Transitive closure of a square relation; members of a cycle get a true diagonal (and perhaps no more)."""
    n = len(direct)
    closed = direct.copy()
    _, label = connected_components(coo_matrix(direct), directed=True, connection="strong")
    on_cycle = np.bincount(label, minlength=n)[label] > 1
    closed[on_cycle, on_cycle] = True
    waiting = direct.sum(axis=1)
    ready = np.flatnonzero(waiting == 0).tolist()
    while ready:
        j = ready.pop()
        for i in np.flatnonzero(direct[:, j]):
            closed[i] |= closed[j]
            waiting[i] -= 1
            if waiting[i] == 0:
                ready.append(int(i))
    return closed


def immediate(before: Bools) -> Bools:
    """The pairs of a closed order with no third contour between them (its transitive reduction).

    Examples
    --------
    >>> chain = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=bool)
    >>> immediate(chain).astype(int).tolist()
    [[0, 1, 0], [0, 0, 1], [0, 0, 0]]
    """
    rank = before.sum(axis=0) + 1
    sooner = np.ascontiguousarray(before.T)
    kept = np.zeros_like(before)
    for j in range(len(before)):
        left = np.where(sooner[j], rank, 0)
        while left[i := int(left.argmax())]:
            kept[i, j] = True
            left[i] = 0
            left[sooner[i]] = 0
    return kept
