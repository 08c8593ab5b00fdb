"""Which contour may directly follow which."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Ints
from kerfwise.models.kernels import kept, suited

from .closure import immediate
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
    suited(_mark_lawful, 2 * n * n)(before, np.ascontiguousarray(before.T), immediate(before), block, lawful)
    lawful[n, :n] = ~before.any(axis=0)
    lawful[:n, n] = ~before.any(axis=1)
    for i, j in apart:
        lawful[i, j] = lawful[j, i] = False
    return lawful


@kept(nogil=True)
def _mark_lawful(  # pragma: no cover - compiled
    before: Bools, after: Bools, near: Bools, block: Ints, lawful: Bools
) -> None:
    """Contours: not backwards, nothing in between, and blocks are entered at a first and left at a last of them."""
    n = len(before)
    enters, leaves = np.ones(n, np.bool_), np.ones(n, np.bool_)
    for i in range(n):
        for j in range(n):
            if before[i, j] and block[i] == block[j]:
                leaves[i] = enters[j] = False
    for i in range(n):
        for j in range(n):
            if i != j and not after[i, j] and (near[i, j] or not before[i, j]):
                lawful[i, j] = block[i] == block[j] or (leaves[i] and enters[j])
