"""What each stretch of an offset curve is offset from: a line or arc of the drawn curve, or one of its corners."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .crossing import Circle, Line, Track
from .curve import Curve, FloatArray
from .segment import Point

MITRE_MM = 0.001
"""A corner whose pointed offset reaches less than this beyond its rounding arc is left pointed."""


@dataclass(frozen=True, eq=False, slots=True)
class Sources:
    """The n segments of a closed curve and the n corners between them, ready to be offset.

    Segment k has the number 2 k, the corner at its end 2 k + 1. `right_mm` is the offset to the right of travel
    (negative: left). Arrays have n rows: `tangent_in`, `tangent_out` are the unit tangents at a segment's ends,
    `centre`, `radius_mm` those of an offset arc (radius 0 for a line, negative where an arc vanishes), `turn_rad` the
    angle that the curve turns through at each corner, positive to the left.
    """

    right_mm: float
    start: FloatArray
    end: FloatArray
    bulge: FloatArray
    tangent_in: FloatArray
    tangent_out: FloatArray
    centre: FloatArray
    radius_mm: FloatArray
    turn_rad: FloatArray

    @staticmethod
    def of(curve: Curve, distance_mm: float) -> Sources:
        """The sources of `curve` offset outwards by `distance_mm`."""
        right_mm = distance_mm if curve.is_ccw else -distance_mm
        segments = curve.segments
        start = np.array([s.start for s in segments])
        end = np.array([s.end for s in segments])
        bulge = np.array([s.bulge for s in segments])
        chord = end - start
        length = np.hypot(chord[:, 0], chord[:, 1])[:, None]
        # The tangent at an end of an arc is its chord turned by half the sweep, 2 atan(bulge).
        along, across = chord / length, np.column_stack([-chord[:, 1], chord[:, 0]]) / length
        cos, sin = ((1 - bulge**2) / (1 + bulge**2))[:, None], (2 * bulge / (1 + bulge**2))[:, None]
        tangent_in, tangent_out = along * cos - across * sin, along * cos + across * sin
        arc = bulge != 0
        b = np.where(arc, bulge, 1.0)
        centre = (start + end) / 2 + across * length * ((1 - b * b) / (4 * b))[:, None]
        drawn_mm = length[:, 0] * (1 + b * b) / (4 * np.abs(b))
        radius_mm = np.where(arc, drawn_mm + right_mm * np.sign(b), 0.0)

        after = np.roll(tangent_in, -1, axis=0)
        cross = tangent_out[:, 0] * after[:, 1] - tangent_out[:, 1] * after[:, 0]
        turn_rad = np.arctan2(cross, (tangent_out * after).sum(axis=1))
        return Sources(right_mm, start, end, bulge, tangent_in, tangent_out, centre, radius_mm, turn_rad)

    def __len__(self) -> int:
        return len(self.start)

    @property
    def rounded(self) -> NDArray[np.bool_]:
        """Corners that bend away from the offset side by more than a mitre can bridge."""
        bridged_rad = 2 * math.acos(abs(self.right_mm) / (abs(self.right_mm) + MITRE_MM))
        # A cusp turns by half a turn either way, and is gone around on both sides.
        cusp = np.abs(self.turn_rad) > math.pi - 1e-6
        return (self.turn_rad * math.copysign(1.0, self.right_mm) > bridged_rad) | cusp

    @property
    def is_convex(self) -> bool:
        """True when the curve bounds a convex area."""
        sweep_rad = 4 * np.arctan(self.bulge)
        total_rad = float(self.turn_rad.sum() + sweep_rad.sum())
        same_way = math.copysign(1.0, total_rad) * np.concatenate([self.turn_rad, sweep_rad]) > -1e-9
        return bool(same_way.all() and abs(abs(total_rad) - math.tau) < 1e-6)

    def track(self, source: int) -> Track:
        """The line or circle that the offset of a source lies on."""
        k, is_corner = divmod(source, 2)
        if is_corner:
            return Circle(_point(self.end[k]), abs(self.right_mm), 1 if self.right_mm > 0 else -1)
        if self.bulge[k] != 0:
            return Circle(_point(self.centre[k]), float(self.radius_mm[k]), 1 if self.bulge[k] > 0 else -1)
        return Line(self.offset_start(k), _point(self.tangent_in[k]))

    def longest_sweep_rad(self, source: int) -> float:
        """The most that the offset arc of a source can turn."""
        k, is_corner = divmod(source, 2)
        return math.pi if is_corner else 4 * math.atan(abs(float(self.bulge[k])))

    def offset_start(self, k: int) -> Point:
        """Where the untrimmed offset of segment k begins."""
        (x, y), (tx, ty) = self.start[k].tolist(), self.tangent_in[k].tolist()
        return x + self.right_mm * ty, y - self.right_mm * tx

    def offset_end(self, k: int) -> Point:
        """Where the untrimmed offset of segment k ends."""
        (x, y), (tx, ty) = self.end[k].tolist(), self.tangent_out[k].tolist()
        return x + self.right_mm * ty, y - self.right_mm * tx

    def mitre(self, k: int) -> Point | None:
        """Where the offset tangents at the corner after segment k meet; None where the curve turns back."""
        (tx, ty), (ux, uy) = self.tangent_out[k].tolist(), self.tangent_in[(k + 1) % len(self)].tolist()
        scale = 1 + tx * ux + ty * uy  # the mitre is (normal + next normal) / (1 + their product) from the corner
        if scale < 1e-6:
            return None
        x, y = self.end[k].tolist()
        return x + self.right_mm * (ty + uy) / scale, y - self.right_mm * (tx + ux) / scale

    def is_smooth(self, k: int) -> bool:
        """True when the corner after segment k turns so little that its mitre is exact."""
        return bool(abs(self.turn_rad[k]) < 1e-4)


def _point(row: FloatArray) -> Point:
    x, y = row.tolist()
    return x, y
