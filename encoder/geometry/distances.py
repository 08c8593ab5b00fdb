"""Distances of many points from a line of many chords."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Floats

COMPARED = 1 << 20
"""Pairs of a point and a chord that are compared each; where there are more, the chords are looked up by place."""


def distances_mm(line: shapely.Geometry, points: Floats) -> Floats:
    """How far points (m, 2) are from a line, or from several, (m,).

    Examples
    --------
    >>> distances_mm(shapely.LineString([(0, 0), (9, 0)]), np.array([[4.0, 3.0], [9.0, 0.0]])).tolist()
    [3.0, 0.0]
    """
    at = shapely.points(points)
    if len(at) * shapely.get_num_coordinates(line) <= COMPARED:
        return np.asarray(shapely.distance(line, at))
    ends, of = shapely.get_coordinates(shapely.get_parts(line), return_index=True)
    follows = np.flatnonzero(of[1:] == of[:-1])
    chords = shapely.linestrings(np.stack([ends[follows], ends[follows + 1]], axis=1))
    _, far_mm = shapely.STRtree(chords).query_nearest(at, return_distance=True, all_matches=False)
    return np.asarray(far_mm)
