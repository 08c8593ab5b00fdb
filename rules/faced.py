"""What the first or the last stretch of the paths of outer contours faces, as statements have it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.ranges import laid_out

from .statements import Before

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts, Stretch

ValueT = TypeVar("ValueT")
PER_MM = 100
"""Lengths in statements are whole hundredths of a millimetre."""


@dataclass(frozen=True, eq=False, slots=True)
class Faced:
    """What a stretch of the path of candidates of outer contours faces, (k,); hundredths of a millimetre.

    `first` and `count` say which rows of `neighbour` and `lengths` are the neighbours of each; `length` is what these
    come to, `solid` how much faces solid metal, `total` the whole stretch.
    """

    candidate: Ints
    contour: Ints
    first: Ints
    count: Ints
    length: Ints
    solid: Floats
    total: Floats
    neighbour: Ints
    lengths: Ints

    @staticmethod
    def of(facts: Facts, stretch: Stretch) -> Faced:
        """Of all of them, part after part."""
        faced = stretch.neighbours
        lengths = np.rint(faced.length_mm * PER_MM).astype(np.int64)
        outers = np.array([facts.nest.index[part.outer.id] for part in facts.nest.parts], dtype=np.int64)
        own = facts.first[outers + 1] - facts.first[outers]
        candidate = laid_out(facts.first[outers], own)
        first, until = (np.searchsorted(faced.row, candidate, side) for side in ("left", "right"))
        up_to = np.append(0, np.cumsum(lengths))
        solid, total = (stretch.solid_mm * PER_MM)[candidate], (stretch.total_mm * PER_MM)[candidate]
        length, contour = up_to[until] - up_to[first], np.repeat(outers, own)
        return Faced(candidate, contour, first, until - first, length, solid, total, faced.neighbour, lengths)

    def only(self, chosen: Ints) -> Faced:
        """Some of them."""
        return Faced(
            self.candidate[chosen],
            self.contour[chosen],
            self.first[chosen],
            self.count[chosen],
            self.length[chosen],
            self.solid[chosen],
            self.total[chosen],
            self.neighbour,
            self.lengths,
        )

    def orders(self, first: bool) -> list[tuple[Before, ...]]:
        """For each that its contour is cut before its neighbours, or these before it."""
        own, others = np.repeat(self.contour, self.count), self.neighbour[laid_out(self.first, self.count)]
        i, j = (own, others) if first else (others, own)
        return self._by_candidate(list(map(Before, i.tolist(), j.tolist())))

    def weights(self) -> list[tuple[int, ...]]:
        """How much of each faces each neighbour."""
        return self._by_candidate(self.lengths[laid_out(self.first, self.count)].tolist())

    def _by_candidate(self, values: list[ValueT]) -> list[tuple[ValueT, ...]]:
        until = np.cumsum(self.count)
        return [tuple(values[a:b]) for a, b in zip((until - self.count).tolist(), until.tolist(), strict=True)]
