"""What each stretch of an offset curve is offset from: a line or arc of the drawn curve, or one of its corners."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools, Floats

from .crossing import Circle, Line, LineOrCircle
from .curve import Curve
from .segment import Point
from .segment_arrays import SegmentArrays

MITRE_MM = 0.001
"""A corner whose pointed offset reaches less than this beyond its rounding arc is left pointed."""
SMOOTH_RAD = 1e-4
"""A corner that turns by less has an exact mitre."""


def bridged_rad(offset_mm: float) -> float:
    """By how much a corner may bend away from an offset that leaves it pointed."""
    return 2 * math.acos(abs(offset_mm) / (abs(offset_mm) + MITRE_MM))


def rounded_corners(turn_rad: Floats, right_mm: Floats | float, bridged: Floats | float) -> Bools:
    """Corners that bend away from the offset side by more than a mitre can bridge, `bridged` in radians."""
    # A cusp turns by half a turn either way, and is gone around on both sides.
    return np.asarray((turn_rad * np.sign(right_mm) > bridged) | (np.abs(turn_rad) > math.pi - 1e-6))


def offset_radii_mm(drawn: SegmentArrays, right_mm: Floats | float) -> Floats:
    """Radii (n,) of the offset arcs of segments, negative where an arc vanishes, 0 for lines."""
    return np.where(drawn.bulge != 0, drawn.radius_mm + right_mm * np.sign(drawn.bulge), 0.0)


def offset_track(drawn: SegmentArrays, radius_mm: Floats, k: int, begin: Point) -> LineOrCircle:
    """The line or circle that the offset of segment k lies on, whose untrimmed offset begins at `begin`."""
    if drawn.bulge[k] != 0:
        return Circle(_point(drawn.centre[k]), float(radius_mm[k]), 1 if drawn.bulge[k] > 0 else -1)
    return Line(begin, _point(drawn.tangent_in[k]))


def arc_bulge(turn: int, start: Point, end: Point, longest_rad: float) -> float:
    """Bulge of the arc between two points, seen from its centre; NaN if it would run backwards."""
    (sx, sy), (ex, ey) = start, end
    sweep = (turn * (math.atan2(ey, ex) - math.atan2(sy, sx))) % math.tau
    if sweep > longest_rad and math.tau - sweep < sweep - longest_rad:
        return 0.0 if math.tau - sweep < 1e-9 else math.nan
    return turn * math.tan(sweep / 4)


@dataclass(frozen=True, eq=False, slots=True)
class Sources:
    """The n segments of a closed curve and the n corners between them, ready to be offset.

    Segment k has the number 2 k, the corner at its end 2 k + 1. `right_mm` is the offset to the right of travel
    (negative: left); `radius_mm` (n,) are the radii of offset arcs, negative where an arc vanishes, 0 for lines.
    """

    drawn: SegmentArrays
    right_mm: float
    radius_mm: Floats

    @staticmethod
    def of(curve: Curve, distance_mm: float) -> Sources:
        """The sources of `curve` offset outwards by `distance_mm`."""
        right_mm = distance_mm if curve.is_ccw else -distance_mm
        drawn = SegmentArrays.of(curve)
        return Sources(drawn, right_mm, offset_radii_mm(drawn, right_mm))

    def __len__(self) -> int:
        return len(self.drawn)

    @property
    def rounded(self) -> Bools:
        """See `rounded_corners`."""
        return rounded_corners(self.drawn.turn_rad, self.right_mm, bridged_rad(self.right_mm))

    def track(self, source: int) -> LineOrCircle:
        """The line or circle that the offset of a source lies on."""
        k, is_corner = divmod(source, 2)
        if is_corner:
            return Circle(_point(self.drawn.end[k]), abs(self.right_mm), 1 if self.right_mm > 0 else -1)
        return offset_track(self.drawn, self.radius_mm, k, self.offset_start(k))

    def longest_sweep_rad(self, source: int) -> float:
        """The most that the offset arc of a source can turn."""
        k, is_corner = divmod(source, 2)
        return math.pi if is_corner else 4 * math.atan(abs(float(self.drawn.bulge[k])))

    def offset_start(self, k: int) -> Point:
        """Where the untrimmed offset of segment k begins."""
        (x, y), (tx, ty) = self.drawn.start[k].tolist(), self.drawn.tangent_in[k].tolist()
        return x + self.right_mm * ty, y - self.right_mm * tx

    def offset_end(self, k: int) -> Point:
        """Where the untrimmed offset of segment k ends."""
        (x, y), (tx, ty) = self.drawn.end[k].tolist(), self.drawn.tangent_out[k].tolist()
        return x + self.right_mm * ty, y - self.right_mm * tx

    def mitre(self, k: int) -> Point | None:
        """Where the offset tangents at the corner after segment k meet; None where the curve turns back."""
        (tx, ty), (ux, uy) = self.drawn.tangent_out[k].tolist(), self.drawn.tangent_in[(k + 1) % len(self)].tolist()
        scale = 1 + tx * ux + ty * uy  # the mitre is (normal + next normal) / (1 + their product) from the corner
        if scale < 1e-6:
            return None
        x, y = self.drawn.end[k].tolist()
        return x + self.right_mm * (ty + uy) / scale, y - self.right_mm * (tx + ux) / scale

    def is_smooth(self, k: int) -> bool:
        """True when the corner after segment k turns so little that its mitre is exact."""
        return bool(abs(self.drawn.turn_rad[k]) < SMOOTH_RAD)


def _point(row: Floats) -> Point:
    x, y = row.tolist()
    return x, y
