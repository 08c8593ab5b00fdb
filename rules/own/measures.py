"""What own rules measure of contours: the metal and how it is cut, sizes, places."""

from __future__ import annotations

import math

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.nest import Nest
from kerfwise.rules.rule import Plate


def cut_seconds(nest: Nest, plate: Plate) -> list[float]:
    """What each contour takes by itself, s: its start and its length at its feed, without leads and travel."""
    return [
        plate.mark_s + c.curve.length_mm / plate.mark_mm_s
        if c.kind == "mark"
        else plate.pierce_s + (c.curve.length_mm + c.corner_mm) / (plate.cut_mm_s * c.feed_share)
        for c in nest.contours
    ]


def weights_kg(nest: Nest, plate: Plate) -> list[float]:
    """What the part of each contour weighs: area, thickness, density; 0 for scrap lines."""
    per_mm2 = plate.thickness_mm * plate.density_kg_m3 * 1e-9
    of_part = {part.id: float(part.polygon.area) * per_mm2 for part in nest.parts}
    return [of_part.get(c.part, 0.0) for c in nest.contours]


def middles_mm(nest: Nest, axis: int) -> list[float]:
    """The middle of each contour's extent along x (axis 0) or y (axis 1), in the coordinates of the drawing."""
    bounds = extents_mm(nest)
    return [float(v) for v in (bounds[:, axis] + bounds[:, axis + 2]) / 2]


def corner_distances_mm(nest: Nest) -> list[float]:
    """How far the middle of each contour is from the sheet's lower left corner."""
    x0, y0, *_ = nest.sheet.bounds
    return [math.hypot(x - x0, y - y0) for x, y in zip(middles_mm(nest, 0), middles_mm(nest, 1), strict=True)]


def extents_mm(nest: Nest) -> Floats:
    """The bounding box (n, 4) of every contour: x and y from, x and y to."""
    return np.asarray(shapely.bounds([c.line for c in nest.contours]), dtype=np.float64).reshape(-1, 4)


def areas_mm2(nest: Nest) -> list[float]:
    """Area inside every contour, 0 for a mark or a slit."""
    return [float(c.polygon.area) if c.encloses else 0.0 for c in nest.contours]


def lengths_mm(nest: Nest) -> list[float]:
    """Length of every contour."""
    return [c.curve.length_mm for c in nest.contours]


def sizes_mm(nest: Nest, axis: int) -> list[float]:
    """Extent of every contour along x (axis 0) or y (axis 1)."""
    bounds = extents_mm(nest)
    return _listed(bounds[:, axis + 2] - bounds[:, axis])


def rectangle_sides_mm(nest: Nest, longer: bool) -> list[float]:
    """The longer or the shorter side of the smallest rectangle, at any angle, around every contour."""
    sides = rectangles_mm(nest)
    return _listed(sides.max(axis=1) if longer else sides.min(axis=1))


def edge_gaps_mm(nest: Nest, side: str) -> list[float]:
    """Distance of every contour from a side of the sheet, from the nearest of the four where side is `edge`."""
    xmin, ymin, xmax, ymax = nest.sheet.bounds
    bounds = extents_mm(nest)
    gaps = {
        "left": bounds[:, 0] - xmin,
        "right": xmax - bounds[:, 2],
        "bottom": bounds[:, 1] - ymin,
        "top": ymax - bounds[:, 3],
    }
    return _listed(np.min(list(gaps.values()), axis=0) if side == "edge" else gaps[side])


def rectangles_mm(nest: Nest) -> Floats:
    """Two sides (n, 2) of the smallest rectangle around every contour."""
    lines = np.array([c.line for c in nest.contours], dtype=object)
    hulls = shapely.convex_hull(lines)
    flat = shapely.get_dimensions(hulls) < 2
    sides = np.zeros((len(lines), 2))
    corners = shapely.get_coordinates(shapely.oriented_envelope(lines[~flat])).reshape(-1, 5, 2)
    for k in (0, 1):
        sides[~flat, k] = np.hypot(*(corners[:, k + 1] - corners[:, k]).T)
    sides[flat, 0] = shapely.length(hulls[flat])
    return sides


def _listed(values: Floats) -> list[float]:
    return [float(v) for v in values]
