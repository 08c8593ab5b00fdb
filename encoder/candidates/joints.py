"""Where the torch can join a contour: an entry on it, and the place beside it on the torch's path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.encoder.nest import Contour

OFF_MM = 0.01
"""A joining point this far from where an entry asks for it is that of another entry."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A contour to cut (number `index` of the nest) with its compensated path, both also as arrays.

    `right` is 1.0 where the waste lies to the right of the contour as drawn, else -1.0.
    """

    index: int
    contour: Contour
    path: Curve
    drawn: SegmentArrays
    path_drawn: SegmentArrays
    right: float
    half_kerf_mm: float

    @staticmethod
    def of(paths: Mapping[int, tuple[Contour, Curve]], half_kerf_mm: float) -> dict[int, Outline]:
        """The outlines of contours, by number, whose compensated paths are known."""
        drawn = SegmentArrays.of(*(contour.curve for contour, _ in paths.values())).each()
        path_drawn = SegmentArrays.of(*(path for _, path in paths.values())).each()
        return {
            k: Outline(k, contour, path, one, other, _right(contour), half_kerf_mm)
            for (k, (contour, path)), one, other in zip(paths.items(), drawn, path_drawn, strict=True)
        }

    @cached_property
    def path_reversed(self) -> Curve:
        """The path the other way round."""
        return self.path.reversed()

    @property
    def around_mm(self) -> float:
        """The length of the contour as drawn."""
        return float(self.drawn.starts_mm[-1])

    def joints(self, at_mm: Floats) -> tuple[Joints, Bools]:
        """See `joints_at`."""
        return joints_at([self], at_mm, np.zeros(len(at_mm), np.int64))


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

    def take(self, rows: Bools | Ints) -> Joints:
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


def joints_at(outlines: Sequence[Outline], at_mm: Floats, of: Ints) -> tuple[Joints, Bools]:
    """Entries at path lengths along contours with where the torch joins, and which of them it really comes to.

    `of` (m,), ascending, numbers the outline of each. The entries that the torch does not come to lie in hollow
    corners, where it cannot come as close to the contour as elsewhere; they are joined at the nearest place.
    """
    if not outlines:
        return Joints.joined([]), np.zeros(0, np.bool_)
    drawn = SegmentArrays.joined([outline.drawn for outline in outlines])
    paths = SegmentArrays.joined([outline.path_drawn for outline in outlines])
    right = np.array([outline.right for outline in outlines])[of][:, None]
    half_kerf_mm = np.array([outline.half_kerf_mm for outline in outlines])[of][:, None]
    entry, before, after = drawn.frames(at_mm, of)
    tangent = before + after
    length = np.hypot(tangent[:, 0], tangent[:, 1])[:, None]
    # Where the contour turns back there is no mean tangent: go straight on.
    tangent = np.where(length > 1e-6, tangent / np.maximum(length, 1e-6), _left(before) * right)
    out = -right * _left(tangent)
    wanted = entry + half_kerf_mm * out
    join_mm, off_mm = paths.project(wanted, of)
    join, _, _ = paths.frames(join_mm, of)
    reach = join - entry
    distance_mm = np.hypot(reach[:, 0], reach[:, 1])[:, None]
    moved = (off_mm > OFF_MM)[:, None] & (distance_mm > 1e-6)
    out = np.where(moved, reach / np.maximum(distance_mm, 1e-6), out)
    index = np.array([outline.index for outline in outlines], dtype=np.int64)[of]
    return Joints(index, at_mm, entry, join_mm, join, out), off_mm <= OFF_MM


def _right(contour: Contour) -> float:
    return 1.0 if contour.curve.is_ccw == (contour.kind == "outer") else -1.0


def _left(v: Floats) -> Floats:
    return np.column_stack([-v[:, 1], v[:, 0]])
