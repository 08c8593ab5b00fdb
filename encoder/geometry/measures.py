"""Where lines and circles meet, how often a path meets itself, how wide a curve is, how far points lie from a line."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats

from .curve import Curve
from .segment import Point

# Where unbounded lines and full circles meet: the corners of an offset curve.


@dataclass(frozen=True, slots=True)
class Line:
    """The line through `point` along the unit vector `direction`."""

    point: Point
    direction: Point


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle run counter-clockwise (`turn` 1) or clockwise (`turn` -1)."""

    centre: Point
    radius_mm: float
    turn: int


LineOrCircle = Line | Circle


def crossings(a: LineOrCircle, b: LineOrCircle) -> list[Point]:
    """The points that both tracks pass through: none, one or two.

    Examples
    --------
    >>> crossings(Line((0.0, 0.0), (1.0, 0.0)), Line((5.0, 5.0), (0.0, 1.0)))
    [(5.0, 0.0)]
    >>> crossings(Circle((0.0, 0.0), 5.0, 1), Line((0.0, 3.0), (1.0, 0.0)))
    [(-4.0, 3.0), (4.0, 3.0)]
    """
    if isinstance(a, Line):
        return _line_line(a, b) if isinstance(b, Line) else _line_circle(a, b)
    return _line_circle(b, a) if isinstance(b, Line) else _circle_circle(a, b)


def _line_line(a: Line, b: Line) -> list[Point]:
    (ax, ay), (bx, by) = a.direction, b.direction
    cross = ax * by - ay * bx
    if abs(cross) < 1e-9:
        return []
    dx, dy = b.point[0] - a.point[0], b.point[1] - a.point[1]
    t = (dx * by - dy * bx) / cross
    return [(a.point[0] + t * ax, a.point[1] + t * ay)]


def _line_circle(a: Line, b: Circle) -> list[Point]:
    (px, py), (ux, uy), (cx, cy) = a.point, a.direction, b.centre
    t = (cx - px) * ux + (cy - py) * uy
    fx, fy = px + t * ux, py + t * uy
    square = b.radius_mm**2 - (fx - cx) ** 2 - (fy - cy) ** 2
    if square < 0:
        return []
    half = math.sqrt(square)
    return [(fx - half * ux, fy - half * uy), (fx + half * ux, fy + half * uy)]


def _circle_circle(a: Circle, b: Circle) -> list[Point]:
    dx, dy = b.centre[0] - a.centre[0], b.centre[1] - a.centre[1]
    d = math.hypot(dx, dy)
    if d < 1e-9:
        return []
    along = (d * d + a.radius_mm**2 - b.radius_mm**2) / (2 * d)
    square = a.radius_mm**2 - along * along
    if square < 0:
        return []
    half = math.sqrt(square)
    fx, fy = a.centre[0] + along * dx / d, a.centre[1] + along * dy / d
    return [(fx - half * dy / d, fy + half * dx / d), (fx + half * dy / d, fy - half * dx / d)]


# How often a path meets itself: what is found on it takes time that goes with this number, and more.

MOST_MEETINGS = 10_000
"""No part is drawn so, and no torch runs so."""
_AT_ONCE = 200


def has_too_many_crossings(points: Floats, closed: bool, most: int) -> bool:
    """Whether a path along `points` (n, 2), mm, crosses, touches or runs along itself in more than `most` places.

    Neighbours meet at their common point; that does not count.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [9.0, 0.0]] * 100)
    >>> [has_too_many_crossings(along, closed=False, most=10_000) for along in (points, points[:100])]
    [True, False]
    """
    count = len(points) if closed else len(points) - 1
    if count * (count - 1) // 2 <= most:
        return False
    ends = np.roll(points, -1, axis=0)
    chords = np.stack([points, ends], axis=1)[:count]
    lines, met = shapely.linestrings(chords), 0
    tree = shapely.STRtree(lines)
    last = len(lines) - 1 if closed else len(lines)
    for begin in range(0, len(lines), _AT_ONCE):
        one, other = tree.query(lines[begin : begin + _AT_ONCE], predicate="intersects")
        apart = other - one - begin
        met += int(((apart > 1) & (apart < last)).sum())
        if met > most:
            return True
    return False


# The largest circle inside a closed curve: how wide a hole is.

SAME_MM = 1e-6
"""Arcs whose centres and radii differ by less are arcs of one circle."""

_CHORD_MM = 0.005
_FOUND_MM = 1e-4
_STEPS_MM = (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)


def wider_than(curve: Curve, mm: float) -> bool:
    """Whether a circle of that diameter has room inside a closed curve, found where it costs little.

    In what one line encloses a circle has room whose diameter is twice the area by the length of the line (Bonnesen).
    False says nothing yet.

    Examples
    --------
    >>> slot = Curve.of([(0, 0), (50, 0), (50, 8), (0, 8)])
    >>> wider_than(slot, 8), wider_than(slot, 8.1)
    (True, False)
    """
    if 2 * abs(curve.signed_area_mm2) >= mm * curve.length_mm:
        return True
    if (found := _as_circle(curve)) is not None:
        return found[1] >= mm
    inside = _area(curve)
    middle = inside.centroid
    return bool(inside.covers(middle)) and 2 * curve.project((middle.x, middle.y))[1] >= mm


def narrower_than(curve: Curve, mm: float) -> bool:
    """Whether surely no circle of that diameter has room inside a closed curve, found where it costs little.

    No circle has a larger area than what it lies in, or is wider than the narrowest rectangle around that, which is no
    longer than half the curve.
    False says nothing yet.

    Examples
    --------
    >>> slot = Curve.of([(0, 0), (50, 0), (50, 8), (0, 8)])
    >>> narrower_than(slot, 8), narrower_than(slot, 8.1)
    (False, True)
    """
    area_mm2 = abs(curve.signed_area_mm2)
    if area_mm2 < math.pi * (mm / 2) ** 2 * (1 - SAME_MM):
        return True
    if 2 * area_mm2 >= mm * curve.length_mm:
        return False
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


# Distances of many points from a line of many chords.

COMPARED = 1 << 20
"""Pairs of a point and a chord that are compared each; where there are more, the chords are looked up by place."""


def distances_mm(line: shapely.Geometry, points: Floats) -> Floats:
    """How far points (m, 2) are from a line, or from several, (m,).

    Examples
    --------
    >>> distances_mm(shapely.LineString([(0, 0), (9, 0)]), np.array([[4.0, 3.0], [9.0, 0.0]])).tolist()
    [3.0, 0.0]
    """
    at = shapely.points(points)
    if len(at) * shapely.get_num_coordinates(line) <= COMPARED:
        return np.asarray(shapely.distance(line, at))
    ends, of = shapely.get_coordinates(shapely.get_parts(line), return_index=True)
    follows = np.flatnonzero(of[1:] == of[:-1])
    chords = shapely.linestrings(np.stack([ends[follows], ends[follows + 1]], axis=1))
    _, far_mm = shapely.STRtree(chords).query_nearest(at, return_distance=True, all_matches=False)
    return np.asarray(far_mm)


def beyond_mm(line: shapely.Geometry, points: Floats, within_mm: float) -> float:
    """How far the farthest of points (m, 2) is from a line; 0 where none is farther than `within_mm`.

    Whether points are near is looked up far sooner than how near they are.

    Examples
    --------
    >>> line = shapely.LineString([(0, 0), (9, 0)])
    >>> beyond_mm(line, np.array([[4.0, 3.0], [9.0, 0.0]]), 2.0), beyond_mm(line, np.array([[4.0, 1.5]]), 2.0)
    (3.0, 0.0)
    """
    shapely.prepare(line)
    if shapely.dwithin(line, shapely.points(points), within_mm).all():
        return 0.0
    return float(distances_mm(line, points).max())
