"""Which outlines sit in the concavities of others (Pristupov 2016, fig. 4).

As there, convex hulls are tested, and only against the centroids of the other parts, so that a part which merely
reaches into a hull is left alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Ints, unique

from .tolerances import ROUNDING_MM

Geometries = NDArray[Any]
FLAT_MM = 0.05
"""An outline none of whose points lies deeper inside its hull is convex: drawings carry such rounding."""
SAME_AREA = 1e-9


def concavity_pairs(line: Geometries, polygon: Geometries) -> Ints:
    """Array (k, 2) of all pairs (j, i), sorted, of closed lines and their areas: j sits in the concavity of i.

    i is not convex, and the centroid of j lies in its hull. A centroid on the hull counts as inside; one inside i does
    not: i then lies in the concavity of j.
    """
    hulls = shapely.convex_hull(line)
    hollow = np.flatnonzero(_hollow(line, polygon, hulls))
    middles = shapely.centroid(polygon)
    which, j = shapely.STRtree(middles).query(hulls[hollow], predicate="dwithin", distance=ROUNDING_MM)
    i = hollow[which]
    kept = i != j
    kept[kept] = ~well_inside(polygon[i[kept]], line[i[kept]], middles[j[kept]])
    i, j = i[kept], j[kept]
    return np.column_stack([j, i])[np.lexsort((i, j))]


def well_inside(polygon: Geometries, line: Geometries, point: Geometries) -> Bools:
    """Which of the points (k,) lie in the area of the same row; none that lies on its line."""
    within = shapely.contains(polygon, point)
    within[within] = ~shapely.dwithin(point[within], line[within], ROUNDING_MM)
    return np.asarray(within, dtype=np.bool_)


def _hollow(line: Geometries, polygon: Geometries, hulls: Geometries) -> Bools:
    """Which outlines are not convex: a point of theirs lies deeper than FLAT_MM inside the hull."""
    maybe = np.flatnonzero(shapely.area(hulls) > shapely.area(polygon) * (1 + SAME_AREA))
    points, of = shapely.get_coordinates(line[maybe], return_index=True)
    depth_mm = shapely.distance(shapely.points(points), shapely.boundary(hulls[maybe])[of])
    hollow = np.zeros(len(line), dtype=np.bool_)
    hollow[unique(maybe[of[depth_mm > FLAT_MM + ROUNDING_MM]])] = True
    return hollow
