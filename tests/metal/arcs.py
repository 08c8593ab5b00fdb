"""Arcs as chords: the only curve that drawings and programs have."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kerfwise.tests.metal.tolerances import CHORD_MM

Point = tuple[float, float]
Floats = NDArray[np.float64]


def chords(start: Point, centre: Point, sweep_rad: float, end: Point) -> Floats:
    """Array (n, 2) of the points after `start` along an arc, `end` the last; a radius that drifts is spread evenly."""
    r0, r1 = math.dist(start, centre), math.dist(end, centre)
    widest = 2 * math.acos(max(1 - CHORD_MM / max(r0, r1, CHORD_MM), -1.0))
    count = max(1, math.ceil(abs(sweep_rad) / min(widest, math.pi / 8)))
    share = np.arange(1, count + 1) / count
    angle = math.atan2(start[1] - centre[1], start[0] - centre[0]) + sweep_rad * share
    radius = r0 + (r1 - r0) * share
    points = np.column_stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)])
    points[-1] = end
    return points


def sweep_rad(start: Point, centre: Point, end: Point, ccw: bool) -> float:
    """The angle an arc turns through; the same start and end are a full turn."""
    turn = math.atan2(end[1] - centre[1], end[0] - centre[0]) - math.atan2(start[1] - centre[1], start[0] - centre[0])
    if math.dist(start, end) < 1e-4:
        return math.tau if ccw else -math.tau
    return turn % math.tau if ccw else -(-turn % math.tau)


def bulged(vertices: Floats, closed: bool) -> Floats:
    """Array (n, 2) along lines and arcs given as rows of x, y, bulge (tangent of a quarter of the sweep)."""
    rows = [tuple(map(float, row)) for row in vertices]
    ends = rows[1:] + rows[:1] if closed else rows[1:]
    points = [np.array([rows[0][:2]])]
    for (x0, y0, bulge), (x1, y1, _) in zip(rows, ends, strict=False):
        if bulge == 0 or (x0, y0) == (x1, y1):
            points.append(np.array([[x1, y1]]))
            continue
        k = (1 - bulge * bulge) / (4 * bulge)
        centre = ((x0 + x1) / 2 - (y1 - y0) * k, (y0 + y1) / 2 + (x1 - x0) * k)
        points.append(chords((x0, y0), centre, 4 * math.atan(bulge), (x1, y1)))
    return np.concatenate(points)
