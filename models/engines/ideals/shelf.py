"""Many small tables kept in few large pieces of memory: the system gets these back as soon as they are not needed."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats

PIECE = 1 << 23
"""Numbers in a piece, 64 MB: a piece is far larger than what an allocator keeps for later."""


class Shelf:
    """Where tables are put one behind the other; a piece goes when no table in it is needed any more.

    Examples
    --------
    >>> shelf = Shelf()
    >>> one, two = (shelf.put(np.full((2, 2), value)) for value in (1.0, 2.0))
    >>> two.tolist(), one.base is two.base
    ([[2.0, 2.0], [2.0, 2.0]], True)
    """

    def __init__(self) -> None:
        self._piece: Floats = np.empty(0)
        self._used = 0

    def put(self, table: Floats) -> Floats:
        """A copy of a table, on the shelf."""
        if self._used + table.size > len(self._piece):
            self._piece, self._used = np.empty(max(PIECE, table.size)), 0
        place = self._piece[self._used : self._used + table.size].reshape(table.shape)
        place[...] = table
        self._used += table.size
        return place
