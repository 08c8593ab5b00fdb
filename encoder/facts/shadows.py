"""Which part lies ahead of which on the same level (Pristupov 2016, fig. 3).

Let d be the direction away from the start side. The shadow of contour i is every point from which a ray in
direction d meets i: the space between the start side and i. Contour j lies ahead of i when the centroid of j is in
the shadow of i and outside i; a ray that only grazes i meets it (a centroid inside i, of a trough that i lies in,
is in no space between i and a side). Both are outer contours in the same place: straight on the sheet,
or in the same hole.
"""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.cut import Side

from .outlines import ROUNDING_MM, Outlines, well_inside
from .sides import AWAY, AXIS


def level_ahead(outlines: Outlines, parent: Ints, start_side: Side) -> Ints:
    """Array (k, 2) of all pairs (j, i) where j lies ahead of i, sorted.

    An STRtree finds the bounding rectangles that each ray passes. A contour is one closed curve, so a ray that
    begins in front of its rectangle and passes the rectangle meets the curve; only where the ray begins beside the
    curve (in a mouth, between two arms) is the curve itself asked.
    """
    outers = outlines.outers
    axis, away = AXIS[start_side], AWAY[start_side]
    along = away * outlines.centroid[outers, axis]
    across = outlines.centroid[outers, 1 - axis]
    faces = away * outlines.bounds_mm[outers][:, [axis, axis + 2]]
    near, far = faces.min(axis=1), faces.max(axis=1)
    low, high = outlines.bounds_mm[outers, 1 - axis], outlines.bounds_mm[outers, 3 - axis]

    boxes = shapely.STRtree(shapely.box(near, low, far, high))
    end = np.full(len(outers), far.max(initial=0.0))
    j, i = boxes.query(shapely.box(along, across - ROUNDING_MM, end, across + ROUNDING_MM))
    at = parent[outers]
    same_place = (at[j] == at[i]) & (j != i)
    j, i = j[same_place], i[same_place]

    meets = along[j] <= near[i]
    beside = np.flatnonzero(~meets)
    ray_from = outlines.centroid[outers[j[beside]]]
    ray_to = ray_from.copy()
    ray_to[:, axis] = away * far[i[beside]] + away
    rays = shapely.linestrings(np.stack([ray_from, ray_to], axis=1))
    meets[beside] = shapely.dwithin(rays, outlines.line[outers[i[beside]]], ROUNDING_MM)
    # a centroid inside the outline is in the mouth of a part, not between it and the start side
    met = np.flatnonzero(meets)
    meets[met] = ~well_inside(outlines, outers[i[met]], outlines.centroid[outers[j[met]]])
    j, i = outers[j[meets]], outers[i[meets]]
    return np.column_stack([j, i])[np.lexsort((i, j))]
