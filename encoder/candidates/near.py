"""Which lines of a tree shapes come too near to."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.side_by_side import in_halves

EXACT_MM = 1e-6
"""Distances that fall short by no more than this do not."""

Lines = NDArray[np.object_]


def nearer(lines: shapely.STRtree, shapes: Lines, distance_mm: Floats | float) -> tuple[Ints, Ints]:
    """Numbers of shapes and of lines, in pairs that are nearer to each other than a distance, one for all or for each.

    Examples
    --------
    >>> street = shapely.STRtree([shapely.LineString([(0, 0), (10, 0)])])
    >>> [rows.tolist() for rows in nearer(street, shapely.points([(5, 1.5), (5, 1.4)]), 1.5)]
    [[1], [0]]
    """
    within_mm = np.broadcast_to(np.maximum(distance_mm - EXACT_MM, 0.0), len(shapes))

    def of(some: slice) -> tuple[Ints, Ints]:
        row, line = lines.query(shapes[some], "dwithin", distance=within_mm[some])
        return row + some.start, line

    rows, met = zip(*in_halves(of, len(shapes)), strict=True)
    return np.concatenate(rows), np.concatenate(met)
