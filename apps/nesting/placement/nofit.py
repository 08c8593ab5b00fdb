"""How a part is turned, and where it may lie beside another or in a room, exact on polygons."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.bevels.bevel import Bevel, EdgeBevel
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Part

# Where one shape may lie beside another, or in a room: exact on polygons, concave ones and those with holes too.
#
# A shape B at t meets A where t lies in the Minkowski sum of A and -B. Of two shapes without holes that is what the
# sums of their edges cover, and A + (-b) and a + (-B) for any points a and b of theirs: either their borders meet, or
# one lies in the other. Where one has room in a hole of the other, that is taken out again.

SLIVER_MM2 = 1e-8
"""What is smaller than this comes of rounding; what fits exactly has 1e-7 mm² to lie in."""


def forbidden(a: shapely.Polygon, b: shapely.Polygon) -> shapely.Geometry:
    """Every shift of `b` by which it overlaps `a`.

    Examples
    --------
    >>> forbidden(shapely.box(0, 0, 4, 4), shapely.box(0, 0, 1, 2)).bounds
    (-1.0, -2.0, 4.0, 4.0)
    """
    meets = _sum(shapely.Polygon(a.exterior), _turned(shapely.Polygon(b.exterior)))
    free = [*_in_holes(a, b), *(_turned(room) for room in _in_holes(b, a))]
    return meets.difference(shapely.union_all(free)) if free else meets


def _in_holes(host: shapely.Polygon, guest: shapely.Polygon) -> Iterator[shapely.Geometry]:
    """Shifts of the guest by which it lies in a hole of the host."""
    for ring in host.interiors:
        room = allowed(shapely.Polygon(ring), guest)
        if not room.is_empty:
            yield room


def _turned(shape: shapely.Geometry) -> shapely.Geometry:
    return shapely.transform(shape, lambda points: -points)


def _sum(a: shapely.Polygon, b: shapely.Polygon) -> shapely.Geometry:
    """The Minkowski sum of two shapes without holes."""
    if _convex(a) and _convex(b):
        return _hulls(_corners(a)[None, :, :], _corners(b)[None, :, :])[0]
    inside = [_shifted(a, _corners(b)[0]), _shifted(b, _corners(a)[0])]
    swept = _swept(b, a) if _convex(a) else _swept(a, b)
    return _whole(shapely.union_all([*swept, *inside]))


def _swept(a: shapely.Polygon, b: shapely.Polygon) -> Any:
    """What the edges of one shape sweep with another that goes along them, in convex pieces."""
    if _convex(b):
        return _hulls(_edges(a), _corners(b)[None, :, :])
    one, other = _edges(a), _edges(b)
    return _hulls(np.repeat(one, len(other), axis=0), np.tile(other, (len(one), 1, 1)))


def _whole(area: shapely.Geometry) -> shapely.Geometry:
    """The area without the slivers that rounding leaves between pieces of it."""
    return shapely.union_all(
        [
            shapely.Polygon(
                piece.exterior, [ring for ring in piece.interiors if shapely.Polygon(ring).area > SLIVER_MM2]
            )
            for piece in shapely.get_parts(area)
            if piece.geom_type == "Polygon"
        ]
    )


def allowed(room: shapely.Geometry, b: shapely.Polygon) -> shapely.Geometry:
    """Every shift of `b` by which it lies in a room: any polygon, with holes too, or several.

    Examples
    --------
    >>> allowed(shapely.box(0, 0, 10, 5), shapely.box(0, 0, 4, 4)).bounds
    (0.0, 0.0, 6.0, 1.0)
    >>> allowed(shapely.Polygon(), shapely.box(0, 0, 4, 4)).is_empty
    True
    """
    outline = shapely.Polygon(b.exterior)
    pieces = [_in_piece(piece, outline) for piece in shapely.get_parts(room) if not piece.is_empty]
    return shapely.union_all([piece for piece in pieces if not piece.is_empty])


def _in_piece(room: shapely.Polygon, b: shapely.Polygon) -> shapely.Geometry:
    x0, y0, x1, y1 = room.bounds
    bx0, by0, bx1, by1 = b.bounds
    if x1 - x0 < bx1 - bx0 or y1 - y0 < by1 - by0:
        return shapely.Polygon()
    box = shapely.box(x0 - bx0, y0 - by0, x1 - bx1, y1 - by1)
    if abs(room.area - (x1 - x0) * (y1 - y0)) < 1e-9 * room.area:
        return box
    turned = _turned(b)
    barred = [*_swept(room, turned), *(_sum(shapely.Polygon(ring), turned) for ring in room.interiors)]
    inside = _shifted(shapely.Polygon(room.exterior), -_corners(b)[0])
    return box.intersection(inside).difference(shapely.union_all(barred))


def _convex(shape: shapely.Polygon) -> bool:
    return not shape.interiors and shape.convex_hull.area - shape.area <= 1e-9 * shape.area


def _corners(shape: shapely.Polygon) -> Floats:
    corners: Floats = shapely.get_coordinates(shape)[:-1]
    return corners


def _edges(shape: shapely.Polygon) -> Floats:
    """Array (edges, 2, 2) of the ends of every edge, those of holes too."""
    rings = [shapely.get_coordinates(ring) for ring in (shape.exterior, *shape.interiors)]
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])


def _hulls(one: Floats, other: Floats) -> Any:
    """The sums of convex shapes (n or 1, corners, 2) pair by pair."""
    sums = one[:, :, None, :] + other[:, None, :, :]
    sums = sums.reshape(len(sums), -1, 2)
    return shapely.convex_hull(shapely.multipoints(sums))


def _shifted(shape: shapely.Geometry, by: Floats) -> shapely.Geometry:
    return shapely.transform(shape, lambda points: points + by)


# How a part is turned, and where it lies: curves and areas moved exactly, arcs as arcs.

_EXACT = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


@dataclass(frozen=True, slots=True, order=True)
class Pose:
    """A turn in degrees, counter-clockwise, after a mirroring at the y axis where it is mirrored.

    Examples
    --------
    >>> Pose(90.0).moved(np.array([[2.0, 0.0]])).tolist()
    [[0.0, 2.0]]
    """

    turn_deg: float = 0.0
    mirrored: bool = False

    @property
    def matrix(self) -> Floats:
        """Array (2, 2) that points (n, 2) are multiplied by, from the right."""
        turn = self.turn_deg % 360.0
        c, s = _EXACT.get(turn) or (math.cos(math.radians(turn)), math.sin(math.radians(turn)))
        flip = -1.0 if self.mirrored else 1.0
        return np.array([[flip * c, flip * s], [-s, c]])

    def moved(self, points: Floats, dx_mm: float = 0.0, dy_mm: float = 0.0) -> Floats:
        """Points (n, 2), mm, turned and then shifted; no zero is negative."""
        moved: Floats = points @ self.matrix + np.array([dx_mm, dy_mm]) + 0.0
        return moved


@dataclass(frozen=True, slots=True)
class Placed:
    """A copy of a part type where it lies: `kind` is the number of the type in the list, from 0 on."""

    kind: int
    pose: Pose
    dx_mm: float
    dy_mm: float

    def area(self, polygon: shapely.Geometry) -> shapely.Geometry:
        """An area of the part type where this copy lies."""
        return shapely.transform(polygon, lambda points: self.pose.moved(points, self.dx_mm, self.dy_mm))

    def curve(self, curve: Curve) -> Curve:
        """A curve of the part type where this copy lies, coordinates to a millionth of a millimetre."""
        points = self.pose.moved(curve.vertices[:, :2], self.dx_mm, self.dy_mm).round(6)
        bulges = -curve.vertices[:, 2] if self.pose.mirrored else curve.vertices[:, 2]
        return Curve(np.column_stack([points, bulges]) + 0.0, curve.closed)

    def part(self, part: Part, name: str) -> Part:
        """The part type's part where this copy lies, under another name."""
        return Part(
            name,
            self._contour(part.outer, name, "outer"),
            tuple(self._contour(hole, name, f"hole{k}") for k, hole in enumerate(part.holes, 1)),
            tuple(self._contour(mark, name, f"mark{k}") for k, mark in enumerate(part.marks, 1)),
            {**part.attributes, "turned": self.pose.turn_deg, "mirrored": self.pose.mirrored},
            tabs=tuple(Tab(self._point(tab.at), tab.width_mm) for tab in part.tabs),
        )

    def _point(self, at: tuple[float, float]) -> tuple[float, float]:
        x, y = self.pose.moved(np.array([at]), self.dx_mm, self.dy_mm).round(6)[0].tolist()
        return x, y

    def _contour(self, contour: Contour, name: str, what: str) -> Contour:
        def laid(bevel: Bevel) -> Bevel:
            return bevel.turned_over if self.pose.mirrored else bevel

        made = Contour(f"{name}.{what}", name, contour.kind, self.curve(contour.curve), source=contour.source)
        edges = tuple(EdgeBevel(laid(one.bevel), self.curve(one.edge)) for one in contour.edge_bevels)
        return replace(made, bevel=contour.bevel and laid(contour.bevel), edge_bevels=edges)
