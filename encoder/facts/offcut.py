"""Distances to the sheet's sides and the empty strips along them (Petunin 2009, section 2.2)."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Floats
from kerfwise.encoder.geometry.segment import Box

from .facts import SIDES
from .outlines import SAME_SHARE, Outlines
from .sides import AXIS


def edge_gaps(outlines: Outlines, sheet_mm: Box) -> Floats:
    """Array (n, 4): how far each contour is from each side of the sheet's bounding rectangle, in the order of SIDES."""
    xmin, ymin, xmax, ymax = outlines.bounds_mm.T
    return np.column_stack([xmin - sheet_mm[0], sheet_mm[2] - xmax, ymin - sheet_mm[1], sheet_mm[3] - ymax])


def extents(sheet_mm: Box) -> Floats:
    """Array (4,): how far the sheet reaches away from each side."""
    size = (sheet_mm[2] - sheet_mm[0], sheet_mm[3] - sheet_mm[1])
    return np.array([size[AXIS[side]] for side in SIDES])


def offcuts(edge_gap_mm: Floats, sheet_mm: Box, offcut_share: float) -> tuple[Floats, Bools]:
    """Depth of the empty strip along each side, and whether it is over `offcut_share` of the extent that way.

    Examples
    --------
    >>> depth, large = offcuts(np.array([[10.0, 300.0, 10.0, 10.0]]), (0, 0, 1000, 500), 0.15)
    >>> depth.tolist(), large.tolist()
    ([10.0, 300.0, 10.0, 10.0], [False, True, False, False])
    """
    extent = extents(sheet_mm)
    depth = np.minimum(edge_gap_mm.min(axis=0, initial=np.inf), extent)
    return depth, depth > (offcut_share + SAME_SHARE) * extent
