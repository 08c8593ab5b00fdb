"""Which part lies in the concavity of which (Pristupov 2016, fig. 4).

As there, convex hulls are tested, and only against the centroids of the other parts, so that a part which merely
reaches into a hull is left alone.
"""

from __future__ import annotations

import numpy as np
import shapely

from .facts import Bools, Ints
from .outlines import Outlines

FLAT_MM = 0.05
"""A contour none of whose points lies deeper inside its hull is convex: drawings carry such rounding."""
ON_HULL_MM = 1e-6


def in_hull(outlines: Outlines, parent: Ints) -> Ints:
    """Array (k, 2) of all pairs (j, i), outer contours in the same place, i not convex and j's centroid in i's hull.

    A centroid on the hull counts as inside.
    """
    outers = outlines.outers
    hulls = shapely.convex_hull(outlines.line[outers])
    hollow = np.flatnonzero(_is_hollow(outlines, outers, hulls))
    centroids = shapely.STRtree(shapely.points(outlines.centroid[outers]))
    which, j = centroids.query(hulls[hollow], predicate="dwithin", distance=ON_HULL_MM)
    i, j = outers[hollow[which]], outers[j]
    kept = (parent[i] == parent[j]) & (i != j)
    i, j = i[kept], j[kept]
    return np.column_stack([j, i])[np.lexsort((i, j))]


def _is_hollow(outlines: Outlines, outers: Ints, hulls: object) -> Bools:
    """Which of the outer contours have a point deeper than FLAT_MM inside their hull."""
    row = np.full(outlines.n, -1)
    row[outers] = np.arange(len(outers))
    points_of = row[outlines.chord_contour]
    held = points_of >= 0
    points_of = points_of[held]
    rims = shapely.boundary(hulls)
    depth = shapely.distance(shapely.points(outlines.chord_start[held]), rims[points_of])
    return np.bincount(points_of, weights=depth > FLAT_MM, minlength=len(outers)) > 0
