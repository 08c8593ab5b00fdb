"""The largest circle inside a closed curve: how wide a hole is."""

from __future__ import annotations

import math

import numpy as np
import shapely

from .curve import Curve
from .segment import Point

SAME_MM = 1e-6
"""Arcs whose centres and radii differ by less are arcs of one circle."""

_CHORD_MM = 0.005
_FOUND_MM = 1e-4
_STEPS_MM = (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)


def wider_than(curve: Curve, mm: float) -> bool:
    """Whether a circle of that diameter has room inside a closed curve, found where it costs little.

    False says nothing yet.

    Examples
    --------
    >>> slot = Curve.of([(0, 0), (50, 0), (50, 8), (0, 8)])
    >>> wider_than(slot, 8), wider_than(slot, 8.1)
    (True, False)
    """
    inside, middle = _area(curve), _area(curve).centroid
    return bool(inside.covers(middle)) and 2 * curve.project((middle.x, middle.y))[1] >= mm


def narrower_than(curve: Curve, mm: float) -> bool:
    """Whether surely no circle of that diameter has room inside a closed curve, found where it costs little.

    No circle has a larger area than what it lies in, or is wider than the narrowest rectangle around that.
    False says nothing yet.

    Examples
    --------
    >>> slot = Curve.of([(0, 0), (50, 0), (50, 8), (0, 8)])
    >>> narrower_than(slot, 8), narrower_than(slot, 8.1)
    (False, True)
    """
    if abs(curve.signed_area_mm2) < math.pi * (mm / 2) ** 2 * (1 - SAME_MM):
        return True
    around = shapely.get_coordinates(shapely.minimum_rotated_rectangle(curve.line(_CHORD_MM)))
    sides_mm = np.hypot(*np.diff(around[:3], axis=0).T)
    return bool(len(sides_mm) == 2 and sides_mm.min() + 2 * _CHORD_MM < mm)


def largest_circle(curve: Curve) -> tuple[Point, float]:
    """Centre and diameter, mm, of the largest circle inside a closed curve.

    Exact for a circle, else to 0.001 mm. Of several that are as large, as in a slot, it is any.

    Examples
    --------
    >>> largest_circle(Curve.of([(-4, 0, 1), (4, 0, 1)]))
    ((0.0, 0.0), 8.0)
    >>> round(largest_circle(Curve.of([(0, 0), (50, 0), (50, 8), (0, 8)]))[1], 3)
    8.0
    """
    found = _as_circle(curve)
    if found is not None:
        return found
    x, y = shapely.get_coordinates(shapely.maximum_inscribed_circle(_area(curve), tolerance=_FOUND_MM))[0].tolist()
    best_mm = curve.project((x, y))[1]
    for step_mm in _STEPS_MM:
        better = True
        while better:
            around = [(x + a * step_mm, y + b * step_mm) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]
            to_mm, at = max((curve.project(p)[1], p) for p in around)
            better = to_mm > best_mm + SAME_MM
            if better:
                best_mm, (x, y) = to_mm, at
    return (x, y), 2 * best_mm


def middle_of(curve: Curve) -> tuple[Point, float]:
    """The centroid of the area inside a closed curve, and its distance from the curve, mm; 0 where it lies outside.

    Examples
    --------
    >>> middle_of(Curve.of([(0, 0), (50, 0), (50, 8), (0, 8)]))
    ((25.0, 4.0), 4.0)
    """
    found = _as_circle(curve)
    if found is not None:
        return found[0], found[1] / 2
    area, middle = _area(curve), _area(curve).centroid
    at = middle.x, middle.y
    return at, curve.project(at)[1] if area.covers(middle) else 0.0


def _as_circle(curve: Curve) -> tuple[Point, float] | None:
    """Centre and diameter where all of the curve is one circle."""
    segments = curve.segments
    if not segments or not all(s.is_arc for s in segments):
        return None
    (x, y), radius_mm = segments[0].centre, segments[0].radius_mm
    same = all(math.dist(s.centre, (x, y)) < SAME_MM and abs(s.radius_mm - radius_mm) < SAME_MM for s in segments)
    return ((x, y), 2 * radius_mm) if same else None


def _area(curve: Curve) -> shapely.Geometry:
    return shapely.make_valid(curve.polygon(_CHORD_MM))
