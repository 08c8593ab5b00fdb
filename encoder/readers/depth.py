"""Which ring lies in which: even depth is the outside of a part, odd depth a hole."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.arrays import Ints


def surrounding(areas: Sequence[shapely.Geometry]) -> tuple[Ints, Ints]:
    """The depth of every area, and the number of the smallest one around it (-1 for none).

    The areas may touch but not cross: one that has an inner point in a larger one lies in it.

    Examples
    --------
    >>> depth, parent = surrounding([shapely.box(0, 0, 9, 9), shapely.box(1, 1, 8, 8), shapely.box(2, 2, 3, 3)])
    >>> depth.tolist(), parent.tolist()
    ([0, 1, 2], [-1, 0, 1])
    """
    shapes = np.array(areas, dtype=object)
    size = shapely.area(shapes)
    inside, around = shapely.STRtree(shapes).query(shapely.point_on_surface(shapes), predicate="within")
    larger = size[around] > size[inside]
    inside, around = inside[larger], around[larger]
    parent = np.full(len(shapes), -1, dtype=np.int64)
    from_largest = np.argsort(-size[around], kind="stable")
    parent[inside[from_largest]] = around[from_largest]  # the last to be written is the smallest
    return np.bincount(inside, minlength=len(shapes)).astype(np.int64), parent
