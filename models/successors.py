"""Which contour may directly follow which."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .closure import immediate

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


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
    together = block[:, None] == block[None, :]
    inside = before & together
    leaves, enters = ~inside.any(axis=1), ~inside.any(axis=0)
    lawful = np.zeros((n + 1, n + 1), dtype=np.bool_)
    lawful[:n, :n] = ~before.T & (~before | immediate(before)) & (together | (leaves[:, None] & enters[None, :]))
    lawful[np.arange(n), np.arange(n)] = False
    lawful[n, :n] = ~before.any(axis=0)
    lawful[:n, n] = ~before.any(axis=1)
    for i, j in apart:
        lawful[i, j] = lawful[j, i] = False
    return lawful
