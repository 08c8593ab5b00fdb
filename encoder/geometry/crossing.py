"""Where unbounded lines and full circles meet: the corners of an offset curve."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .segment import Point


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
