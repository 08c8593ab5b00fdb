"""One line or arc."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""Least x and y, greatest x and y, mm."""


def length_between_mm(start: Point, end: Point, bulge: float) -> float:
    """The length of a line or arc between two points, mm.

    Examples
    --------
    >>> length_between_mm((0, 0), (3, 4), 0.0)
    5.0
    """
    chord_mm = math.dist(start, end)
    if bulge == 0.0:
        return chord_mm
    return chord_mm * (1 + bulge * bulge) / (4 * abs(bulge)) * abs(4.0 * math.atan(bulge))


@dataclass(frozen=True, slots=True)
class Segment:
    """A line (bulge 0) or an arc from `start` to `end`; bulge = tan(sweep / 4), positive counter-clockwise.

    Examples
    --------
    >>> half = Segment((1.0, 0.0), (-1.0, 0.0), 1.0)
    >>> round(half.length_mm, 4), round(half.radius_mm, 4)
    (3.1416, 1.0)
    """

    start: Point
    end: Point
    bulge: float = 0.0

    @property
    def is_arc(self) -> bool:
        """True for an arc."""
        return self.bulge != 0.0

    @property
    def chord_mm(self) -> float:
        """Straight distance from start to end, mm."""
        return math.dist(self.start, self.end)

    @property
    def sweep_rad(self) -> float:
        """Signed angle the arc turns through (0 for a line)."""
        return 4.0 * math.atan(self.bulge)

    @property
    def radius_mm(self) -> float:
        """Radius of the arc, infinite for a line."""
        if self.bulge == 0.0:
            return math.inf
        return math.dist(self.start, self.end) * (1 + self.bulge * self.bulge) / (4 * abs(self.bulge))

    @property
    def centre(self) -> Point:
        """Centre of the arc (meaningless for a line)."""
        (x0, y0), (x1, y1), b = self.start, self.end, self.bulge
        k = (1 - b * b) / (4 * b)
        return (x0 + x1) / 2 - (y1 - y0) * k, (y0 + y1) / 2 + (x1 - x0) * k

    @property
    def length_mm(self) -> float:
        """Path length, mm."""
        return length_between_mm(self.start, self.end, self.bulge)

    @property
    def area_term_mm2(self) -> float:
        """Contribution to the signed area of the closed curve it is part of."""
        (x0, y0), (x1, y1) = self.start, self.end
        area = (x0 * y1 - x1 * y0) / 2
        if self.is_arc:
            sweep = self.sweep_rad
            area += self.radius_mm**2 * (sweep - math.sin(sweep)) / 2
        return area

    def _angle_at(self, fraction: float) -> float:
        cx, cy = self.centre
        return math.atan2(self.start[1] - cy, self.start[0] - cx) + self.sweep_rad * fraction

    def point_at(self, fraction: float) -> Point:
        """The point a fraction 0…1 of the way along."""
        if fraction <= 0.0:
            return self.start
        if fraction >= 1.0:
            return self.end
        if self.bulge == 0.0:
            (x0, y0), (x1, y1) = self.start, self.end
            return x0 + (x1 - x0) * fraction, y0 + (y1 - y0) * fraction
        (cx, cy), r, a = self.centre, self.radius_mm, self._angle_at(fraction)
        return cx + r * math.cos(a), cy + r * math.sin(a)

    def tangent_at(self, fraction: float) -> Point:
        """Unit tangent in the direction of travel."""
        if self.bulge == 0.0:
            (x0, y0), (x1, y1), length = self.start, self.end, self.chord_mm
            return (x1 - x0) / length, (y1 - y0) / length
        a, turn = self._angle_at(fraction), math.copysign(1.0, self.bulge)
        return -math.sin(a) * turn, math.cos(a) * turn

    def between(self, f0: float, f1: float) -> Segment:
        """The piece from fraction `f0` to fraction `f1`."""
        return Segment(self.point_at(f0), self.point_at(f1), self.bulge_between(f0, f1))

    def bulge_between(self, f0: float, f1: float) -> float:
        """The bulge of the piece from fraction `f0` to fraction `f1`."""
        return math.tan(math.atan(self.bulge) * (f1 - f0)) if self.bulge != 0.0 else 0.0

    def project(self, point: Point) -> tuple[float, float]:
        """Fraction of the nearest point to `point`, and the distance to it, mm."""
        if self.bulge == 0.0:
            (x0, y0), (x1, y1) = self.start, self.end
            dx, dy = x1 - x0, y1 - y0
            f = ((point[0] - x0) * dx + (point[1] - y0) * dy) / (dx * dx + dy * dy)
            f = min(max(f, 0.0), 1.0)
            return f, math.dist(point, (x0 + dx * f, y0 + dy * f))
        (cx, cy), sweep = self.centre, self.sweep_rad
        turn = math.atan2(point[1] - cy, point[0] - cx) - self._angle_at(0.0)
        turn = turn % math.tau if sweep > 0 else -(-turn % math.tau)
        f = turn / sweep
        if f <= 1.0:
            return f, abs(math.dist(point, (cx, cy)) - self.radius_mm)
        d0, d1 = math.dist(point, self.start), math.dist(point, self.end)
        return (0.0, d0) if d0 <= d1 else (1.0, d1)

    @property
    def angle_rad(self) -> float:
        """Where on its circle an arc starts, rad from the x axis (meaningless for a line)."""
        return self._angle_at(0.0)

    def chords_within(self, tolerance_mm: float) -> int:
        """How many chords stay within `tolerance_mm`."""
        if self.bulge == 0.0:
            return 1
        r = self.radius_mm
        # 1 - cos(step / 2) = tolerance / r, written so that the widest arc keeps its digits
        step = math.pi / 2 if r <= tolerance_mm else min(4 * math.asin(math.sqrt(tolerance_mm / (2 * r))), math.pi / 2)
        return max(1, math.ceil(abs(self.sweep_rad) / step - 1e-9))

    def flatten(self, tolerance_mm: float) -> NDArray[np.float64]:
        """Array (m, 2) of the points after `start`, the last exactly `end`; chords within `tolerance_mm`."""
        n = self.chords_within(tolerance_mm)
        if n == 1:
            return np.array([self.end])
        r = self.radius_mm
        (cx, cy), a0 = self.centre, self.angle_rad
        a = a0 + self.sweep_rad * np.arange(1, n + 1) / n
        points = np.column_stack([cx + r * np.cos(a), cy + r * np.sin(a)])
        points[-1] = self.end
        return points
