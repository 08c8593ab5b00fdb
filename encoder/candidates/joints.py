"""Where the torch can join a contour: an entry on it, and the place beside it on the torch's path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.encoder.nest import Contour

OFF_MM = 0.01
"""A joining point this far from where an entry asks for it is that of another entry."""


@dataclass(frozen=True, eq=False, slots=True)
class Outline:
    """A contour to cut (number `index` of the nest) with its compensated path, both also as arrays.

    `right` is 1.0 where the waste lies to the right of the contour as drawn, else -1.0.
    """

    index: int
    contour: Contour
    path: Curve
    path_reversed: Curve
    drawn: SegmentArrays
    path_drawn: SegmentArrays
    right: float
    half_kerf_mm: float

    @staticmethod
    def of(index: int, contour: Contour, path: Curve, half_kerf_mm: float) -> Outline:
        """The outline of a contour whose compensated path is known."""
        right = 1.0 if contour.curve.is_ccw == (contour.kind == "outer") else -1.0
        drawn = SegmentArrays.of(contour.curve)
        return Outline(index, contour, path, path.reversed(), drawn, SegmentArrays.of(path), right, half_kerf_mm)

    def joints(self, at_mm: Floats) -> tuple[Joints, NDArray[np.bool_]]:
        """Entries at path lengths along the contour with where the torch joins, and which of them it really comes to.

        The others lie in hollow corners, where the torch cannot come as close to the contour as elsewhere; they are
        joined at the nearest place.
        """
        entry, before, after = self.drawn.frames(at_mm)
        tangent = before + after
        length = np.hypot(tangent[:, 0], tangent[:, 1])[:, None]
        # Where the contour turns back there is no mean tangent: go straight on.
        tangent = np.where(length > 1e-6, tangent / np.maximum(length, 1e-6), _left(before) * self.right)
        out = -self.right * _left(tangent)
        wanted = entry + self.half_kerf_mm * out
        join_mm, off_mm = self.path_drawn.project(wanted)
        join, _, _ = self.path_drawn.frames(join_mm)
        reach = join - entry
        distance_mm = np.hypot(reach[:, 0], reach[:, 1])[:, None]
        moved = (off_mm > OFF_MM)[:, None] & (distance_mm > 1e-6)
        out = np.where(moved, reach / np.maximum(distance_mm, 1e-6), out)
        index = np.full(len(at_mm), self.index)
        return Joints(index, at_mm, entry, join_mm, join, out), off_mm <= OFF_MM


@dataclass(frozen=True, eq=False, slots=True)
class Joints:
    """Parallel arrays, one row a joint.

    `contour` the number of the contour, `entry_mm` and `entry` (m, 2) where on it as drawn, `join_mm` and `join`
    (m, 2) where on its compensated path as drawn, `out` (m, 2) the unit vector from there into the waste.
    """

    contour: Ints
    entry_mm: Floats
    entry: Floats
    join_mm: Floats
    join: Floats
    out: Floats

    def __len__(self) -> int:
        return len(self.contour)

    def take(self, rows: NDArray[np.bool_] | Ints) -> Joints:
        """Some of the rows."""
        return Joints(
            self.contour[rows],
            self.entry_mm[rows],
            self.entry[rows],
            self.join_mm[rows],
            self.join[rows],
            self.out[rows],
        )

    @staticmethod
    def joined(several: Sequence[Joints]) -> Joints:
        """All rows of several, in order."""
        empty = Joints(
            np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2))
        )
        all_of = [empty, *several]
        return Joints(
            np.concatenate([j.contour for j in all_of]),
            np.concatenate([j.entry_mm for j in all_of]),
            np.concatenate([j.entry for j in all_of]),
            np.concatenate([j.join_mm for j in all_of]),
            np.concatenate([j.join for j in all_of]),
            np.concatenate([j.out for j in all_of]),
        )


def _left(v: Floats) -> Floats:
    return np.column_stack([-v[:, 1], v[:, 0]])
