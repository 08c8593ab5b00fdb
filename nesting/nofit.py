"""Where one shape may lie beside another, or in a room: exact on polygons, concave ones and those with holes too.

A shape B at t meets A where t lies in the Minkowski sum of A and -B. Of two shapes without holes that is what the sums
of their edges cover, and A + (-b) and a + (-B) for any points a and b of theirs: either their borders meet, or one lies
in the other. Where one has room in a hole of the other, that is taken out again.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats

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
    if _convex(b):
        swept = _hulls(_edges(a), _corners(b)[None, :, :])
    elif _convex(a):
        swept = _hulls(_edges(b), _corners(a)[None, :, :])
    else:
        one, other = _edges(a), _edges(b)
        swept = _hulls(np.repeat(one, len(other), axis=0), np.tile(other, (len(one), 1, 1)))
    return _whole(shapely.union_all([*swept, *inside]))


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
    swept = _sum_of_border(room, _turned(b))
    inside = _shifted(shapely.Polygon(room.exterior), -_corners(b)[0])
    return box.intersection(inside).difference(swept)


def _sum_of_border(room: shapely.Polygon, b: shapely.Polygon) -> shapely.Geometry:
    """What the edges of a room sweep, and its holes."""
    if _convex(b):
        swept = _hulls(_edges(room), _corners(b)[None, :, :])
    else:
        one, other = _edges(room), _edges(b)
        swept = _hulls(np.repeat(one, len(other), axis=0), np.tile(other, (len(one), 1, 1)))
    return shapely.union_all([*swept, *(_sum(shapely.Polygon(ring), b) for ring in room.interiors)])


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
