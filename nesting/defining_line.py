"""Pavlov's method of the defining line: two polygons side by side in the least rectangle, among finitely many places.

Pavlov 1999: one part is fixed, one of its sides is the defining line, and the other part slides and turns along it. The
rectangle around both is least where a side of the second lies on the defining line, or is parallel to an axis. So the
turns that need trying are finite, two for each pair of sides; and of each turn the places are the corners of where the
second part may lie, that is, where it touches the first.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.nest import Part

from .nofit import forbidden
from .pose import Pose

_SAME_DEG = 1e-6
_SIDES = 4
"""So many sides of a part that may be turned at will are laid along axes, the longest."""
_PLACES = 6
"""Places of each turn that are told."""


@dataclass(frozen=True, slots=True)
class Beside:
    """How the second part lies: turned, then shifted; and the rectangle around both, its sides along the axes."""

    turn_deg: float
    shift: tuple[float, float]
    width_mm: float
    height_mm: float

    @property
    def area_mm2(self) -> float:
        """Of the rectangle."""
        return self.width_mm * self.height_mm


def usable_area_mm2(width_mm: float, height_mm: float, margins_mm: tuple[float, float], half_kerf_mm: float) -> float:
    """Pavlov's (D - 2 l_D + δ)(E - 2 l_E + δ): what a sheet D × E gives, with margins l and a kerf of 2 δ.

    Examples
    --------
    >>> usable_area_mm2(1500.0, 1000.0, (10.0, 5.0), 0.35)
    1466064.6225
    """
    across, up = margins_mm
    return (width_mm - 2 * across + half_kerf_mm) * (height_mm - 2 * up + half_kerf_mm)


def turns_to_try(fixed: shapely.Polygon, coming: shapely.Polygon) -> list[float]:
    """The turns of the second part, degrees: a side of it on a side of the first, or parallel to the x axis."""
    first, second = _directions(fixed), _directions(coming)
    on_line = ((a + 180.0 - b) % 360.0 for a in first for b in second)
    on_axis = ((axis - b) % 360.0 for axis in (0.0, 90.0, 180.0, 270.0) for b in second)
    return _different(round(turn, 9) for turn in (*on_line, *on_axis))


def _different(turns_deg: Iterable[float]) -> list[float]:
    """Turns, the least first, each once: a whole turn is none."""
    kept: list[float] = []
    for turn in sorted(turns_deg):
        if not kept or turn - kept[-1] > _SAME_DEG:
            kept.append(turn)
    return [turn for turn in kept if 360.0 - turn > _SAME_DEG]


def sides_on_axes(part: Part) -> tuple[float, ...]:
    """The turns, degrees, that lay one of the longest sides of a part's hull along an axis; the drawn one among them.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import part
    >>> sides_on_axes(part("A", [(0, 0), (40, 0), (0, 40)]))
    (0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0)
    """
    hull = shapely.geometry.polygon.orient(part.outer.polygon.convex_hull)
    ring = shapely.get_coordinates(hull.exterior)
    lengths = np.hypot(*np.diff(ring, axis=0).T)
    longest = np.argsort(-np.round(lengths, 6), kind="stable")[:_SIDES]
    found = {0.0, 90.0, 180.0, 270.0}
    for k in longest.tolist():
        dx, dy = (ring[k + 1] - ring[k]).tolist()
        along = -math.degrees(math.atan2(dy, dx))
        found |= {round((along + axis) % 360.0, 9) % 360.0 for axis in (0.0, 90.0, 180.0, 270.0)}
    return tuple(_different(found))


def best_beside(fixed: shapely.Polygon, coming: shapely.Polygon, turns_deg: Sequence[float] | None = None) -> Beside:
    """The place of the second part by which the rectangle around both is least; they may touch.

    Parameters
    ----------
    fixed, coming
        Polygons, mm, arcs as chords; grown by half the gap where there is to be one.
    turns_deg
        The turns that are allowed; those of the method where it is not given.

    Examples
    --------
    Two halves of a square:

    >>> half = shapely.Polygon([(0, 0), (10, 0), (0, 10)])
    >>> found = best_beside(half, half)
    >>> found.turn_deg, found.shift, round(found.area_mm2, 6)
    (180.0, (10.0, 10.0), 100.0)
    """
    return places_beside(fixed, coming, turns_deg)[0]


def places_beside(
    fixed: shapely.Polygon, coming: shapely.Polygon, turns_deg: Sequence[float] | None = None
) -> list[Beside]:
    """The places that `best_beside` chooses from, the best of each turn first: least area, then least perimeter."""
    tried = turns_to_try(fixed, coming) if turns_deg is None else turns_deg
    return sorted(_all_beside(fixed, coming, tried), key=_rank)


def _rank(one: Beside) -> tuple[float, float, float, tuple[float, float]]:
    return round(one.area_mm2, 6), round(one.width_mm + one.height_mm, 6), one.turn_deg, one.shift


def _all_beside(fixed: shapely.Polygon, coming: shapely.Polygon, turns_deg: Sequence[float]) -> Iterator[Beside]:
    x0, y0, x1, y1 = fixed.bounds
    for turn in turns_deg:
        turned = shapely.transform(coming, Pose(turn).moved)
        touching = forbidden(fixed, turned)
        shifts = _where(touching, turned, fixed)
        a0, b0, a1, b1 = turned.bounds
        wide = np.maximum(x1, a1 + shifts[:, 0]) - np.minimum(x0, a0 + shifts[:, 0])
        high = np.maximum(y1, b1 + shifts[:, 1]) - np.minimum(y0, b0 + shifts[:, 1])
        ranked = np.lexsort((shifts[:, 1], shifts[:, 0], np.round(wide + high, 6), np.round(wide * high, 6)))
        for k in ranked[:_PLACES].tolist():
            dx, dy = (round(float(by), 9) + 0.0 for by in shifts[k])
            yield Beside(turn, (dx, dy), float(wide[k]), float(high[k]))


def _where(touching: shapely.Geometry, coming: shapely.Polygon, fixed: shapely.Polygon) -> Floats:
    """Shifts by which the two touch and the rectangle may be least: corners, and where sides of boxes are level.

    On an edge of the border the rectangle's area has its least value at an end, or where a side of the one box passes
    a side of the other.
    """
    corners = shapely.get_coordinates(touching)
    x0, y0, x1, y1 = fixed.bounds
    a0, b0, a1, b1 = coming.bounds
    far = 1e6
    level = [shapely.LineString([(x, -far), (x, far)]) for x in (x0 - a0, x1 - a1)]
    level += [shapely.LineString([(-far, y), (far, y)]) for y in (y0 - b0, y1 - b1)]
    met = [shapely.get_coordinates(touching.boundary.intersection(line)) for line in level]
    shifts: Floats = np.concatenate([corners, *met])
    return shifts


def _directions(shape: shapely.Polygon) -> list[float]:
    """Directions of the sides, degrees, the outline run counter-clockwise."""
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(shape).exterior)
    sides = np.diff(ring, axis=0)
    return [math.degrees(math.atan2(dy, dx)) % 360.0 for dx, dy in sides.tolist() if math.hypot(dx, dy) > 1e-9]
