"""What moves of a network cost for what is out, as the inner loops of a sweep read it.

A move to the last contour of a block has several ways through the block. Which is the cheapest depends on what is out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.kernels import kept
from kerfwise.models.problem.bits import Masks

ALL = 1 << 62


class Over(NamedTuple):
    """Ways of the move from site r to site c of a network: those from `begin[r * columns + c]` to the next beginning.

    A way costs `extra` µm more than the move, and `price` for each contour of its `mask` (w words) that is out. A move
    without ways costs nothing more.
    """

    begin: Ints
    extra: Ints
    mask: Masks
    columns: int
    price: int


def nothing_over(words: int) -> Over:
    """Where no move crosses anything."""
    none = np.zeros(0, dtype=np.int64)
    return Over(none, none, np.zeros((0, words), dtype=np.uint64), 0, 0)


@kept(nogil=True)
def over_in_set(over: Over, mask: Masks, row: int, column: int) -> int:  # pragma: no cover - compiled
    """What the cheapest way of a move costs more than the move when `mask` is out; nothing on the way in, row < 0."""
    if row < 0:
        return 0
    move = row * over.columns + column
    if over.begin[move] == over.begin[move + 1]:
        return 0
    least = ALL
    for k in range(over.begin[move], over.begin[move + 1]):
        cost = over.extra[k]
        for w in range(len(mask)):
            bits = over.mask[k, w] & mask[w]
            while bits:
                bits &= bits - np.uint64(1)
                cost += over.price
        least = min(least, cost)
    return least
