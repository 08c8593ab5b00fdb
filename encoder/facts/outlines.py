"""The contours of a nest as arrays, made once for all families of facts, and the four sides of its sheet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Side
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.geometry.tolerances import ROUNDING_MM as ROUNDING_MM
from kerfwise.encoder.nest import Nest

Geometries = NDArray[Any]
SAME_SHARE = 1e-6
"""Amounts that differ by less than this share of the larger one are equal: where a drawing lies must not tell."""


@dataclass(frozen=True, eq=False, slots=True)
class Outlines:
    """Contours flattened within 0.01 mm. n contours, indexed like `Nest.contours`; m chords, contour after contour.

    `polygon` is the area inside an outer contour or a hole, None for what encloses none; `centroid` its centre of mass
    (Pristupov 2016), else nan. `own_outer` is the outer contour of the part that a contour belongs to, itself for a
    scrap line; `around` is for a slit the contour that its slot is of, else the same.
    `length_mm` is exact on arcs. `chord_start`, `chord_end` (m, 2) and `chord_contour` (m,) are the chords.
    """

    line: Geometries
    polygon: Geometries
    centroid: Floats
    bounds_mm: Floats
    length_mm: Floats
    area_mm2: Floats
    is_ccw: Bools
    is_outer: Bools
    is_mark: Bools
    is_scrap: Bools
    encloses: Bools
    own_outer: Ints
    around: Ints
    chord_start: Floats
    chord_end: Floats
    chord_contour: Ints

    @property
    def n(self) -> int:
        """Number of contours."""
        return len(self.length_mm)

    @property
    def outers(self) -> Ints:
        """Indices of the outer contours."""
        return np.flatnonzero(self.is_outer)


def outlines_of(nest: Nest) -> Outlines:
    """The arrays of a nest."""
    contours = nest.contours
    n = len(contours)
    line: Geometries = np.array([c.line for c in contours], dtype=object)
    encloses = np.array([c.encloses for c in contours], dtype=bool)
    points, contour_of_point = shapely.get_coordinates(line, return_index=True)

    polygon: Geometries = np.full(n, None, dtype=object)
    enclosing = encloses[contour_of_point]
    polygon[encloses] = shapely.polygons(
        shapely.linearrings(points[enclosing], indices=(np.cumsum(encloses) - 1)[contour_of_point[enclosing]])
    )
    centroid = shapely.centroid(polygon)

    within = contour_of_point[1:] == contour_of_point[:-1]
    start, end, of = points[:-1][within], points[1:][within], contour_of_point[1:][within].astype(np.int64)
    cross = start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1]
    outer_at = {p.id: nest.index[p.outer.id] for p in nest.parts}
    own_outer = [outer_at.get(c.part, k) for k, c in enumerate(contours)]
    return Outlines(
        line=line,
        polygon=polygon,
        centroid=np.column_stack([shapely.get_x(centroid), shapely.get_y(centroid)]),
        bounds_mm=shapely.bounds(line).reshape(n, 4),
        length_mm=np.array([c.curve.length_mm for c in contours], dtype=np.float64),
        area_mm2=np.nan_to_num(shapely.area(polygon)),
        is_ccw=sum_by_owner(of, cross, n) > 0,
        is_outer=np.array([c.kind == "outer" for c in contours], dtype=bool),
        is_mark=np.array([c.kind == "mark" for c in contours], dtype=bool),
        is_scrap=np.array([c.kind == "scrap" for c in contours], dtype=bool),
        encloses=encloses,
        own_outer=np.array(own_outer, dtype=np.int64),
        around=np.array(
            [nest.index.get(c.slot_of, own) for c, own in zip(contours, own_outer, strict=True)], dtype=np.int64
        ),
        chord_start=start,
        chord_end=end,
        chord_contour=of,
    )


# Lengths added up by whose they are.


def sum_by_owner(owner: Ints, length_mm: Floats, count: int) -> Floats:
    """Array (count,): the total length of each owner 0…count - 1.

    Examples
    --------
    >>> sum_by_owner(np.array([2, 0, 2]), np.array([1.0, 5.0, 2.0]), 3).tolist()
    [5.0, 0.0, 3.0]
    """
    return np.bincount(owner, weights=length_mm, minlength=count).astype(np.float64)


def sum_by_pair(row: Ints, neighbour: Ints, length_mm: Floats, count: int) -> tuple[Ints, Ints, Floats]:
    """Each (row, neighbour) pair that occurs, sorted, with its total length; neighbours are below `count`.

    Examples
    --------
    >>> row, neighbour, total = sum_by_pair(np.array([1, 0, 1]), np.array([0, 2, 0]), np.array([1.0, 2.0, 3.0]), 3)
    >>> row.tolist(), neighbour.tolist(), total.tolist()
    ([0, 1], [2, 0], [2.0, 4.0])
    """
    pairs, which = np.unique(row * count + neighbour, return_inverse=True)
    return pairs // count, pairs % count, sum_by_owner(which, length_mm, len(pairs))


# The four sides of a sheet as directions: everything that follows the start side reads these tables.

AXIS: dict[Side, int] = {"left": 0, "right": 0, "bottom": 1, "top": 1}
"""The coordinate (0 for x, 1 for y) that changes as one walks away from the side."""

AWAY: dict[Side, int] = {"left": 1, "right": -1, "bottom": 1, "top": -1}
"""+1 where that coordinate grows on the way into the sheet, -1 where it shrinks."""

OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}


def narrow_sides(bounds_mm: Box) -> tuple[Side, Side]:
    """The two short sides of the sheet's bounding rectangle; left and right of a square, a millionth more or less.

    Examples
    --------
    >>> narrow_sides((0, 0, 6000, 1500))
    ('left', 'right')
    """
    xmin, ymin, xmax, ymax = bounds_mm
    return ("left", "right") if xmax - xmin >= (ymax - ymin) * (1 - SAME_SHARE) else ("bottom", "top")
