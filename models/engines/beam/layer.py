"""One layer of the beam: the sets of one size that are kept, each with the sites that may be last in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Int32s, Ints
from kerfwise.models.engines.ideals.sets import Sets
from kerfwise.models.problem.bits import Masks

from .bound import Bound
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
