"""Which part lies in the concavity of which (Pristupov 2016, fig. 4).

As there, convex hulls are tested, and only against the centroids of the other parts, so that a part which merely
reaches into a hull is left alone.
"""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.distinct import distinct

from .outlines import ROUNDING_MM, Outlines, well_inside

FLAT_MM = 0.05
"""A contour none of whose points lies deeper inside its hull is convex: drawings carry such rounding."""
SAME_AREA = 1e-9


def in_hull(outlines: Outlines, parent: Ints) -> Ints:
    """Array (k, 2) of all pairs (j, i), outer contours in the same place, i not convex and j's centroid in i's hull.

    A centroid on the hull counts as inside; one inside i itself does not: i then lies in that part's concavity.
    """
    outers = outlines.outers
    hollow = _hollow(outlines, outers)
    centroids = shapely.STRtree(shapely.points(outlines.centroid[outers]))
    hulls = shapely.convex_hull(outlines.line[hollow])
    which, j = centroids.query(hulls, predicate="dwithin", distance=ROUNDING_MM)
    i, j = hollow[which], outers[j]
    kept = (parent[i] == parent[j]) & (i != j)
    kept[kept] = ~well_inside(outlines, i[kept], outlines.centroid[j[kept]])
    i, j = i[kept], j[kept]
    return np.column_stack([j, i])[np.lexsort((i, j))]


def _hollow(outlines: Outlines, outers: Ints) -> Ints:
    """Those of the outer contours that are not convex: a point of theirs lies deeper than FLAT_MM inside the hull."""
    hull_area_mm2 = shapely.area(shapely.convex_hull(outlines.line[outers]))
    maybe = outers[hull_area_mm2 > outlines.area_mm2[outers] * (1 + SAME_AREA)]
    asked = np.isin(outlines.chord_contour, maybe)
    of = np.searchsorted(maybe, outlines.chord_contour[asked])
    rims = shapely.boundary(shapely.convex_hull(outlines.line[maybe]))
    depth_mm = shapely.distance(shapely.points(outlines.chord_start[asked]), rims[of])
    return distinct(maybe[of[depth_mm > FLAT_MM + ROUNDING_MM]])
