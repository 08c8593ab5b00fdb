"""One layer of the beam: the sets of one size that are kept, each with the sites that may be last in it."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Int32s, Ints
from kerfwise.models.engines.ideals.sets import Sets
from kerfwise.models.problem.bitsets import Masks

from .bounds import Bound
from .kernels import expand, gather
from .tables import BeamTables


@dataclass(frozen=True, eq=False, slots=True)
class BeamLayer:
    """s sets of `depth` contours in w words, and their states.

    `masks`, `ready` (s, w) are the sets and what may be cut next; `rest` (s, b) what each bound says of the contours
    not in the set; `pending` (s) a contiguous block that is not whole, or -1. States of set k are `node_from[k]` …
    `node_from[k + 1] - 1`: the last site, and the cost so far, µm.
    """

    depth: int
    masks: Masks
    ready: Masks
    rest: Floats
    pending: Int32s
    hashes: Masks
    node_from: Ints
    site: Int32s
    value: Ints


@dataclass(frozen=True, eq=False, slots=True)
class Children:
    """States of the next layer: `f` bounds the best plan through each, `source` is the set that it grew from."""

    f: Floats
    value: Ints
    parent: Int32s
    site: Int32s
    source: Int32s

    @classmethod
    def room(cls, size: int) -> Children:
        """Room for so many."""
        return cls(np.empty(size), np.empty(size, dtype=np.int64), *(np.empty(size, dtype=np.int32) for _ in range(3)))

    @classmethod
    def joined(cls, parts: list[Children]) -> Children:
        """All of several."""
        return parts[0] if len(parts) == 1 else cls(*map(np.concatenate, zip(*(p.columns for p in parts), strict=True)))

    @property
    def columns(self) -> tuple[NDArray[Any], ...]:
        """The arrays, in the order that they are declared."""
        return self.f, self.value, self.parent, self.site, self.source

    def only(self, chosen: slice | Ints) -> Children:
        """Some of them."""
        f, value, parent, site, source = (column[chosen] for column in self.columns)
        return Children(f, value, parent, site, source)

    def put_first(self, others: Children) -> None:
        """Overwrite the first ones."""
        for column, other in zip(self.columns, others.columns, strict=True):
            column[: len(other)] = other

    def best(self, width: int) -> tuple[Children, float, float]:
        """The `width` of least `f`, the first ones where equal; the least `f` of the others, the most of those kept."""
        most = float(np.partition(self.f, width - 1)[width - 1])
        kept = self.f < most
        level = np.flatnonzero(self.f == most)
        spare = width - int(kept.sum())
        kept[level[:spare]] = True
        dropped = most if len(level) > spare else float(self.f[~kept].min(initial=np.inf))
        return self.only(np.flatnonzero(kept)), dropped, most


def root(tables: BeamTables, bound: Bound) -> BeamLayer:
    """Nothing is cut and the torch is at home."""
    nothing = Sets.empty(tables.orders, 1)
    return BeamLayer(
        depth=0,
        masks=nothing.masks,
        ready=nothing.ready,
        rest=bound.price.sum(axis=1)[None, :],
        pending=nothing.pending,
        hashes=nothing.hashes,
        node_from=np.array([0, 1]),
        site=np.array([len(tables.site_contour)], dtype=np.int32),
        value=np.zeros(1, dtype=np.int64),
    )


# Makes the next layer of a beam: all children within the limit, the best of them kept, sorted into sets.

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


# Where every state came from, layer by layer; forgets what no living state came from.

WORTH_CLEARING = 20_000_000
"""States noted, 8 bytes each, before a first clearing."""


@dataclass(slots=True)
class History:
    """The parent (a place in the layer before) and the last site of every state of every layer but the first."""

    parents: list[Int32s] = field(default_factory=list)
    sites: list[Int32s] = field(default_factory=list)
    _clear_at: int = field(default_factory=lambda: WORTH_CLEARING)

    def note(self, parent: Int32s, site: Int32s) -> None:
        """The states of the next layer."""
        self.parents.append(parent)
        self.sites.append(site)
        if sum(map(len, self.sites)) >= self._clear_at:
            self._clear()
            self._clear_at = max(WORTH_CLEARING, 2 * sum(map(len, self.sites)))

    def route(self, state: int) -> tuple[int, ...]:
        """The sites that led to a state of the last layer, in cutting order."""
        route = []
        for parent, site in zip(reversed(self.parents), reversed(self.sites), strict=True):
            route.append(int(site[state]))
            state = int(parent[state])
        return tuple(reversed(route))

    def _clear(self) -> None:
        for k in range(len(self.parents) - 1, 0, -1):
            used = np.zeros(len(self.sites[k - 1]), dtype=np.bool_)
            used[self.parents[k]] = True
            number = np.cumsum(used, dtype=np.int32) - np.int32(1)
            self.parents[k] = number[self.parents[k]]
            self.parents[k - 1], self.sites[k - 1] = self.parents[k - 1][used], self.sites[k - 1][used]
