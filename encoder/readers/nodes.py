"""Where the ends of loose lines meet."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.components import weak_components

from .limits import SNAP_MM


def meeting_points(ends: Floats, lengths_mm: Floats, tolerance_mm: float) -> Ints:
    """The number of the meeting point of every end.

    Ends within `SNAP_MM` meet, however many. An end still alone then meets the nearest other lone end within
    `tolerance_mm`, closest pairs first. The two ends of one piece may meet if the piece is long beside the gap.

    Parameters
    ----------
    ends
        Array (2 n, 2): start and end of piece k in rows 2 k and 2 k + 1, mm.
    lengths_mm
        Array (n,): the length of each piece.
    tolerance_mm
        Widest gap between two ends that meet.

    Examples
    --------
    >>> ends = np.array([[0, 0], [10, 0], [10.05, 0], [20, 0]])
    >>> meeting_points(ends, np.array([10.0, 9.95]), 0.1).tolist()
    [0, 1, 1, 2]
    """
    points = _clusters(ends, min(SNAP_MM, tolerance_mm))
    lone = np.flatnonzero(np.bincount(points)[points] == 1)
    if len(lone) > 1 and tolerance_mm > SNAP_MM:
        pairs = lone[cKDTree(ends[lone]).query_pairs(tolerance_mm, output_type="ndarray")].reshape(-1, 2)
        pairs.sort(axis=1)
        gaps = np.hypot(*(ends[pairs[:, 0]] - ends[pairs[:, 1]]).T)
        own = pairs[:, 0] // 2 == pairs[:, 1] // 2
        keep = ~own | (lengths_mm[pairs[:, 0] // 2] > 4 * gaps)
        taken: set[int] = set()
        for k in np.lexsort((pairs[:, 1], pairs[:, 0], gaps)).tolist():
            i, j = pairs[k].tolist()
            if keep[k] and i not in taken and j not in taken:
                taken |= {i, j}
                points[j] = points[i]
    return np.unique(points, return_inverse=True)[1].astype(np.int64)


def _clusters(ends: Floats, within_mm: float) -> Ints:
    distinct, index = np.unique(ends, axis=0, return_inverse=True)
    pairs = cKDTree(distinct).query_pairs(within_mm, output_type="ndarray").reshape(-1, 2)
    return weak_components(len(distinct), pairs)[index.ravel()]
