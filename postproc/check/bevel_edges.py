"""Bevels on single edges of a contour, for the check: where each edge's face, root and ends lie."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.nest import Contour

_SAMPLE_MM = 0.5
_SHARP_RAD = math.radians(30)


@dataclass(frozen=True, eq=False, slots=True)
class EdgeSide:
    """One edge in fine points, with the directions into the part there, and whether its ends are sharp corners.

    `turns_rad` are how far the contour turns at its two ends: more than nothing away from the part.
    """

    bevel: Bevel | None
    points: Floats
    inwards: Floats
    turns_rad: tuple[float, float]

    @property
    def line(self) -> shapely.LineString:
        """The edge."""
        return shapely.LineString(self.points)

    @property
    def sharp(self) -> tuple[bool, bool]:
        """Whether each end is a sharp corner that sticks out."""
        return self.turns_rad[0] >= _SHARP_RAD - 1e-9, self.turns_rad[1] >= _SHARP_RAD - 1e-9

    def beside(self, out_mm: float) -> Floats:
        """The points so far outside the part."""
        points: Floats = self.points - out_mm * self.inwards
        return points

    def taken(self, away_mm: float) -> shapely.Geometry:
        """What a slope takes off the part where its face lies so far behind the edge; on past sharp corners."""
        points, into = list(self.points), list(self.inwards)
        for end, turn, sharp in zip((0, -1), self.turns_rad, self.sharp, strict=True):
            if not sharp or turn >= math.pi / 2:
                continue
            along = into[end][::-1] * (1, -1)
            along = along if np.dot(along, self.points[end] - self.points[1 if end == 0 else -2]) > 0 else -along
            far = self.points[end] + along * away_mm / math.tan(turn)
            points.insert(0 if end == 0 else len(points), far)
            into.insert(0 if end == 0 else len(into), into[end])
        outer, normals = np.array(points), np.array(into)
        return shapely.make_valid(shapely.Polygon([*outer, *(outer + away_mm * normals)[::-1]]))

    def face(self, away_mm: float, rest_mm: float) -> Floats:
        """Points of its face, without those `rest_mm` beside ends that are no sharp corners."""
        at = shapely.line_locate_point(self.line, shapely.points(self.points))
        begin, end = (0.0 if sharp else rest_mm for sharp in self.sharp)
        kept = (at >= begin - 1e-9) & (at <= self.line.length - end + 1e-9)
        points: Floats = (self.points + away_mm * self.inwards)[kept]
        return points


def sides_of(contour: Contour) -> Iterator[EdgeSide]:
    """The edges of a contour, in its order."""
    segments = contour.curve.segments
    left = contour.curve.is_ccw == (contour.kind == "outer")  # where the part is
    turns = []
    for before, after in zip((segments[-1], *segments[:-1]), segments, strict=True):
        (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
        turns.append((1 if left else -1) * math.atan2(ax * by - ay * bx, ax * bx + ay * by))
    for k, (segment, bevel) in enumerate(zip(segments, contour.bevel_of_edge, strict=True)):
        share = np.linspace(0.0, 1.0, max(2, math.ceil(segment.length_mm / _SAMPLE_MM) + 1)).tolist()
        tangents = np.array([segment.tangent_at(f) for f in share])
        inwards = np.column_stack([-tangents[:, 1], tangents[:, 0]]) * (1 if left else -1)
        points = np.array([segment.point_at(f) for f in share])
        yield EdgeSide(bevel, points, inwards, (turns[k], turns[(k + 1) % len(turns)]))
