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


def beyond_mm(line: shapely.Geometry, points: Floats, within_mm: float) -> float:
    """How far the farthest of points (m, 2) is from a line; 0 where none is farther than `within_mm`.

    Whether points are near is looked up far sooner than how near they are.

    Examples
    --------
    >>> line = shapely.LineString([(0, 0), (9, 0)])
    >>> beyond_mm(line, np.array([[4.0, 3.0], [9.0, 0.0]]), 2.0), beyond_mm(line, np.array([[4.0, 1.5]]), 2.0)
    (3.0, 0.0)
    """
    shapely.prepare(line)
    if shapely.dwithin(line, shapely.points(points), within_mm).all():
        return 0.0
    return float(distances_mm(line, points).max())
