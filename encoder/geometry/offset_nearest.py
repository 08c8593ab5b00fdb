"""Which source each point of an offset curve belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats

from .curve import Curve
from .offset_region import CHORD_MM
from .offset_sources import Sources

NOTHING = -1


@dataclass(frozen=True, eq=False, slots=True)
class Nearest:
    """Finds the source that points are offset from."""

    sources: Sources
    outline: Floats
    """The drawn curve in chords, array (chords, 2): where each begins."""
    tree: shapely.STRtree
    """Of the chords."""
    segment: NDArray[np.int64]
    """The segment of each chord, and whether it is the first or the last one of it."""
    first: NDArray[np.bool_]
    last: NDArray[np.bool_]
    rounded: NDArray[np.bool_]

    @staticmethod
    def among(sources: Sources, curve: Curve) -> Nearest:
        """An index over the segments of `curve`, whose sources are given."""
        chords = [s.flatten(CHORD_MM) if s.is_arc else np.array([s.end]) for s in curve.segments]
        outline = np.concatenate([sources.drawn.start[:1], *chords])[:-1]
        segment = np.repeat(np.arange(len(chords)), [len(c) for c in chords])
        first = np.diff(segment, prepend=-1) > 0
        chord = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)
        tree = shapely.STRtree(shapely.linestrings(chord))
        return Nearest(sources, outline, tree, segment, first, np.roll(first, -1), sources.rounded)

    def distances_mm(self, points: Floats) -> Floats:
        """Distance of each point from the drawn curve, mm."""
        found = shapely.points(points)
        return np.asarray(shapely.distance(found, self.tree.geometries[self.tree.nearest(found)]))

    def label(self, points: Floats) -> NDArray[np.int64]:
        """The number of the source of each point; NOTHING at corners that the offset does not go around."""
        found = shapely.points(points)
        at, side, fraction = self._foot(points, self.tree.nearest(found))
        wrong = np.flatnonzero(side * self.sources.right_mm < 0)
        if len(wrong):
            # Both sides of a slit lie on the same spot: take the side that faces the point.
            row, near = self.tree.query_nearest(found[wrong])
            _, near_side, _ = self._foot(points[wrong[row]], near)
            facing = near_side * self.sources.right_mm > 0
            at[wrong[row[facing]]] = near[facing]
            at, side, fraction = self._foot(points, at)
        n = len(self.sources)
        k = self.segment[at]
        before, after = self.first[at] & (fraction <= 1e-9), self.last[at] & (fraction >= 1 - 1e-9)
        corner = np.where(before, (k - 1) % n, k)
        labels = np.where(before | after, 2 * corner + 1, 2 * k)
        gone = ((before | after) & ~self.rounded[corner]) | (
            ~(before | after) & (self.sources.drawn.bulge[k] != 0) & (self.sources.radius_mm[k] < 1e-6)
        )
        labels[gone] = NOTHING
        return labels

    def _foot(self, points: Floats, at: NDArray[np.int64]) -> tuple[NDArray[np.int64], Floats, Floats]:
        """Chord numbers, positive where the point lies right of its chord, and the fraction along it (unclamped)."""
        start = self.outline[at]
        along = self.outline[(at + 1) % len(self.outline)] - start
        rel = points - start
        fraction = (rel * along).sum(axis=1) / (along * along).sum(axis=1)
        return np.array(at), along[:, 1] * rel[:, 0] - along[:, 0] * rel[:, 1], fraction
