"""Makes the next layer of a beam: all children within the limit, the best of them kept, sorted into sets."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Int32s

from .bound import Bound
from .kernels import expand, gather
from .layer import BeamLayer, Children
from .tables import BeamTables

WORTH_SHARING = 4000
"""States in a layer from which on a second thread is worth waking."""
SLOTS_PER_CHILD = 2
"""Slots of the hash table of sets for each child, at least."""
PER_CHILD = 10
"""Operations that it takes to keep a child, and `PER_WORD` for every word of its set."""
PER_WORD = 4


@dataclass(slots=True)
class Spent:
    """Operations so far, and the least bound of all states that were dropped for lack of room."""

    operations: int = 0
    dropped: float = np.inf

    def add(self, operations: int, dropped: float) -> None:
        """More of both."""
        self.operations += operations
        self.dropped = min(self.dropped, dropped)


class Grower:
    """Grows layers of at most `width` states, one half of a large one in a second thread.

    What is kept does not depend on how a layer is shared out: the best, and of equals the first.
    """

    def __init__(self, tables: BeamTables, bound: Bound, width: int, threads: Executor) -> None:
        self._tables, self._bound, self._width, self._threads = tables, bound, width, threads
        self._rooms: list[Children] = []

    def grow(self, layer: BeamLayer, limit: float, spent: Spent) -> tuple[BeamLayer, Int32s]:
        """The next layer and the parent of every state; children whose bound is over `limit` are of no use."""
        sets = len(layer.masks)
        if len(layer.site) < WORTH_SHARING:
            parts = [self._part(0, layer, 0, sets, limit)]
        else:
            middle = int(np.searchsorted(layer.node_from, len(layer.site) // 2))
            other = self._threads.submit(self._part, 1, layer, middle, sets, limit)
            parts = [self._part(0, layer, 0, middle, limit), other.result()]
        for _, part in parts:
            spent.add(part.operations, part.dropped)
        children = Children.joined([part for part, _ in parts])
        if len(children.f) > self._width:
            children, dropped, _ = children.best(self._width)
            spent.add(0, dropped)
        spent.add((PER_CHILD + PER_WORD * layer.masks.shape[1]) * len(children.f), np.inf)
        return self._gathered(layer, children)

    def _part(self, number: int, layer: BeamLayer, start: int, stop: int, limit: float) -> tuple[Children, Spent]:
        """The best children of the sets `start` … `stop - 1`, in their order."""
        bound, room = self._bound, self._room(number)
        used, cut, spent = 0, np.inf, Spent()
        while start < stop:
            start, used, dropped, operations = expand(
                self._tables, bound.to_go, bound.price, layer.masks, layer.ready, layer.rest, layer.pending,
                layer.node_from, layer.site, layer.value, layer.depth + 1, start, stop, limit, cut,
                room.f, room.value, room.parent, room.site, room.source, used,
            )  # fmt: skip
            spent.add(operations, dropped)
            if used > self._width:
                kept, dropped, cut = room.only(slice(0, used)).best(self._width)
                room.put_first(kept)
                used = len(kept.f)
                spent.add(0, dropped)
        return room.only(slice(0, used)), spent

    def _room(self, number: int) -> Children:
        while len(self._rooms) <= number:
            self._rooms.append(Children.room(2 * self._width + len(self._tables.site_contour)))
        return self._rooms[number]

    def _gathered(self, layer: BeamLayer, children: Children) -> tuple[BeamLayer, Int32s]:
        """The children sorted into their sets, each set described once."""
        count, words = len(children.f), layer.masks.shape[1]
        slots = np.empty(1 << (SLOTS_PER_CHILD * count).bit_length(), dtype=np.int32)
        masks, ready = np.empty((count, words), dtype=np.uint64), np.empty((count, words), dtype=np.uint64)
        rest = np.empty((count, layer.rest.shape[1]))
        hashes, pending = np.empty(count, dtype=np.uint64), np.empty(count, dtype=np.int32)
        set_of = np.empty(count, dtype=np.int32)
        sets = gather(
            self._tables, self._bound.price, layer.masks, layer.ready, layer.rest, layer.hashes,
            children.site, children.source, slots, masks, ready, rest, pending, hashes, set_of,
        )  # fmt: skip
        order = np.argsort(set_of, kind="stable")
        grown = BeamLayer(
            depth=layer.depth + 1,
            masks=masks[:sets],
            ready=ready[:sets],
            rest=rest[:sets],
            pending=pending[:sets],
            hashes=hashes[:sets],
            node_from=np.append(0, np.cumsum(np.bincount(set_of, minlength=sets))),
            site=children.site[order],
            value=children.value[order],
        )
        return grown, children.parent[order]
