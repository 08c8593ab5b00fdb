"""Which contour lies inside which (Pristupov 2016, fig. 1; Verkhoturov et al.).

Holes and marks lie in the outer contour of their part, as the nest says, and a slit in the contour that its slot is of.
A part lies in the smallest hole of another part that its outer contour fits in. Marks and slits contain nothing.
Scrap lines lie in no contour, and contain nothing.
"""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Ints

from .outlines import Outlines


def parents_of(outlines: Outlines) -> Ints:
    """Array (n,): the contour that immediately contains each contour, -1 for a part straight on the sheet.

    One point inside each outer contour is looked up among the holes, near-linear in the number of contours. Parts
    may touch the hole they lie in: a point well inside decides, and the smaller area is the one inside.
    """
    parent = np.where(outlines.is_outer | outlines.is_scrap, -1, outlines.around)
    outers, holes = outlines.outers, np.flatnonzero(~outlines.is_outer & outlines.encloses)
    inside = shapely.STRtree(shapely.point_on_surface(outlines.polygon[outers]))
    which_hole, which_outer = inside.query(outlines.polygon[holes], predicate="intersects")
    hole, outer = holes[which_hole], outers[which_outer]
    # The hole's own outer contour is asked too: areas then grow from parent to parent, and nothing goes in circles.
    room_mm2 = np.minimum(outlines.area_mm2[hole], outlines.area_mm2[outlines.own_outer[hole]])
    fits = room_mm2 > outlines.area_mm2[outer]
    hole, outer = hole[fits], outer[fits]
    by_area = np.argsort(-outlines.area_mm2[hole], kind="stable")
    parent[outer[by_area]] = hole[by_area]  # the last one written, the smallest hole, stays
    return parent


def closure_of(parent: Ints) -> Ints:
    """Array (k, 2) of all pairs (container, contained), direct or not, sorted.

    Examples
    --------
    >>> closure_of(np.array([1, 2, -1])).tolist()
    [[1, 0], [2, 0], [2, 1]]
    """
    contained, container = np.arange(len(parent)), parent
    levels = [np.empty((0, 2), dtype=np.int64)]
    while (nested := container >= 0).any():
        contained, container = contained[nested], container[nested]
        levels.append(np.column_stack([container, contained]))
        container = parent[container]
    pairs = np.concatenate(levels)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def outermost_of(parent: Ints) -> Ints:
    """Array (n,): the outer contour straight on the sheet that each contour lies in, itself for such a one.

    Examples
    --------
    >>> outermost_of(np.array([1, 2, -1])).tolist()
    [2, 2, 2]
    """
    top = np.where(parent < 0, np.arange(len(parent)), parent)
    while not np.array_equal(above := top[top], top):
        top = above
    return top
