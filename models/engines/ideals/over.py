"""What moves cost for what is out, as the inner loops of a sweep read it.

A move crosses parts. In a network one to the last contour of a block has several ways through the block, too: which is
the cheapest depends on what is out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.kernels import inner, kept
from kerfwise.models.problem.bits import Masks

ALL = 1 << 62


class Over(NamedTuple):
    """Ways of the move from row r to column c of a table: those from `begin[r * columns + c]` to the next beginning.

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
    """What the cheapest way of a move costs more than the move when `mask` is out."""
    move = row * over.columns + column
    return cheapest_way(over.extra, over.mask, over.price, mask, over.begin[move], over.begin[move + 1])


@inner(nogil=True)
def cheapest_way(  # pragma: no cover - compiled
    extra: Ints, ways: Masks, price: int, mask: Masks, begin: int, end: int
) -> int:
    """The least that the ways `begin` … `end - 1` cost more when `mask` is out; nothing where there are none."""
    if begin == end:
        return 0
    least = ALL
    for k in range(begin, end):
        cost = extra[k]
        for w in range(len(mask)):
            bits = ways[k, w] & mask[w]
            while bits:
                bits &= bits - np.uint64(1)
                cost += price
        least = min(least, cost)
    return least
