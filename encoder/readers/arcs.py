"""Lines and arcs through a dense row of points: a flattened spline becomes a few arcs again."""

from __future__ import annotations

import math

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve

from .limits import checked_curve

FLATTEN_MM = 0.003
"""Chord error when a spline, an ellipse or a Bézier curve is turned into points."""

FIT_MM = 0.007
"""How far a fitted line or arc may lie off those points; with `FLATTEN_MM`, within 0.01 mm of the drawing."""


def fitted(points: Floats) -> Curve | None:
    """Lines and arcs through dense points in mm, closed where they end as they began; None for fewer than two."""
    if len(points) < 2:
        return None
    closed = bool(np.hypot(*(points[0] - points[-1])) < 1e-6)
    dense = checked_curve(np.column_stack([points, np.zeros(len(points))]), closed=False).vertices[:, :2]
    rows = fit_arcs(dense)
    return checked_curve(rows[:-1] if closed and len(rows) > 2 else rows, closed and len(rows) > 2)


def fit_arcs(points: Floats, tolerance_mm: float = FIT_MM) -> Floats:
    """The vertices of an open curve of lines and arcs that stays within `tolerance_mm` of a polyline.

    Parameters
    ----------
    points
        Array (n, 2), mm, neighbours distinct. The fitted curve's vertices are some of them, the first and the
        last included, so that curves which met still meet.
    tolerance_mm
        Largest distance between the fitted curve and the polyline's vertices and edge middles.

    Returns
    -------
    Array (m, 3) of x, y and bulge, the last bulge 0.

    Examples
    --------
    >>> a = np.linspace(0, math.pi / 2, 100)
    >>> fit_arcs(np.column_stack([10 * np.cos(a), 10 * np.sin(a)])).round(3).tolist()
    [[10.0, 0.0, 0.414], [0.0, 10.0, 0.0]]
    """
    rows, first = [], 0
    while first < len(points) - 1:
        last, bulge = _longest(points, first, tolerance_mm)
        rows.append((*points[first].tolist(), bulge))
        first = last
    rows.append((*points[-1].tolist(), 0.0))
    return np.array(rows)


def _longest(points: Floats, first: int, tolerance_mm: float) -> tuple[int, float]:
    """The last point, and the bulge, of the longest line or arc from `first`: doubled, then halved back."""
    good, bulge, reach = first + 1, 0.0, 2
    while first + reach < len(points):
        fitted = _bulge(points[first : first + reach + 1], tolerance_mm)
        if fitted is None:
            break
        good, bulge = first + reach, fitted
        reach *= 2
    bad = min(first + reach, len(points))
    while bad - good > 1:
        last = (good + bad) // 2
        fitted = _bulge(points[first : last + 1], tolerance_mm)
        if fitted is None:
            bad = last
        else:
            good, bulge = last, fitted
    return good, bulge


def _bulge(points: Floats, tolerance_mm: float) -> float | None:
    """The bulge of the one line or arc that fits all the points, or None."""
    start, end, middle = points[0], points[-1], points[len(points) // 2]
    chord = end - start
    length = math.hypot(*chord.tolist())
    if length < 1e-9:
        return None
    along = chord / length
    across = np.array([-along[1], along[0]])
    tested = np.concatenate([points, (points[1:] + points[:-1]) / 2]) - start
    s, h = tested @ along, tested @ across
    if s.min() < -tolerance_mm or s.max() > length + tolerance_mm:
        return None
    to_ends = np.hypot(np.minimum(np.abs(s), np.abs(s - length)), h)
    if np.abs(h).max() <= tolerance_mm / 2 and to_ends[(s < 0) | (s > length)].max(initial=0.0) <= tolerance_mm:
        return 0.0
    ms, mh = float((middle - start) @ along), float((middle - start) @ across)
    if abs(mh) <= tolerance_mm / 2:
        return None
    # The circle through both ends and the middle point: its centre is (length / 2, k) in chord coordinates.
    k = (ms * (ms - length) + mh * mh) / (2 * mh)
    radius = math.hypot(length / 2, k)
    if k * mh > 0:
        return None  # more than half round: the bend of a cusp, finer than the tolerance
    u, v, side = s - length / 2, h - k, math.copysign(1.0, mh)
    beyond = (side * (k * u - length / 2 * v) > 0) | (side * (k * u + length / 2 * v) < 0)  # past an end of the arc
    off = np.where(beyond, to_ends, np.abs(np.hypot(u, v) - radius))
    if off.max() > tolerance_mm or (h * mh < -tolerance_mm * abs(mh)).any():
        return None
    sagitta = k + math.copysign(radius, mh)
    return -2 * sagitta / length
