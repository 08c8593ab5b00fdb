"""Which contour may directly follow which."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Ints
from kerfwise.models.kernels import kept, suited

from .bits import Masks
from .closure import mark_immediate, packed
from .last import LastOf, digest

_last = LastOf[NDArray[np.uint8]]()
"""Who may follow whom, as bits."""


def known_successors(before: Bools, block: Ints, apart: Iterable[tuple[int, int]] = ()) -> Bools:
    """The same as `lawful_successors`, made once of orders that are asked for again; they must not change meanwhile."""
    unlike = np.array(list(apart), dtype=np.int64).reshape(-1, 2)
    asked = digest(block, unlike)
    bits = _last.known(before, asked)
    if bits is not None:
        return np.unpackbits(bits, axis=1, count=len(before) + 1, bitorder="little").view(np.bool_)
    lawful = lawful_successors(before, block, [(i, j) for i, j in unlike.tolist()])
    _last.keep(before, asked, np.packbits(lawful, axis=1, bitorder="little"))
    return lawful


def lawful_successors(before: Bools, block: Ints, apart: Iterable[tuple[int, int]] = ()) -> Bools:
    """Matrix (n + 1, n + 1): j may directly follow i; n is the machine's home.

    `before` is the closed relation of what must come before what, `block` the contiguous block of every contour, and
    `apart` pairs that may not follow each other either way round.

    Examples
    --------
    >>> chain = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=bool)
    >>> lawful_successors(chain, np.arange(3)).astype(int).tolist()
    [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1, 0, 0, 0]]
    """
    n = len(before)
    lawful = np.zeros((n + 1, n + 1), dtype=np.bool_)
    sooner = packed(before.T)
    mark_immediate(sooner, lawful)
    enters, leaves = _ends_of_blocks(before, block)
    suited(_mark_lawful, n * n)(before, sooner, block, enters, leaves, lawful)
    lawful[n, :n] = ~before.any(axis=0)
    lawful[:n, n] = ~before.any(axis=1)
    for i, j in apart:
        lawful[i, j] = lawful[j, i] = False
    return lawful


def _ends_of_blocks(before: Bools, block: Ints) -> tuple[Bools, Bools]:
    """Contours with none of their block before them, and with none after them."""
    enters, leaves = np.ones(len(before), np.bool_), np.ones(len(before), np.bool_)
    order = np.argsort(block, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(block[order])) + 1):
        if len(members) > 1:
            within = before[np.ix_(members, members)]
            enters[members], leaves[members] = ~within.any(axis=0), ~within.any(axis=1)
    return enters, leaves


@kept(nogil=True)
def _mark_lawful(  # pragma: no cover - compiled
    before: Bools, sooner: Masks, block: Ints, enters: Bools, leaves: Bools, lawful: Bools
) -> None:
    """Contours: not backwards, nothing in between, and blocks are entered at a first and left at a last of them.

    Where nothing is in between is marked already; `sooner` are the sets of what comes before each.
    """
    n = len(before)
    for i in range(n):
        for j in range(n):
            if not before[i, j] and i != j and not sooner[i, j >> 6] >> np.uint64(j & 63) & np.uint64(1):
                lawful[i, j] = True
            if lawful[i, j]:
                lawful[i, j] = block[i] == block[j] or (leaves[i] and enters[j])
