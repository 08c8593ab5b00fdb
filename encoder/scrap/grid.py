"""A grid of lines in a skeleton: straight, and only where there is metal.

Lines up and down go from void to void. Lines across end at them, so that no line crosses another.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.validate.tolerances import TOUCH_MM

_TRIED = 20
"""Places that are tried in each width of the grid."""
_PIERCE_MM = 30.0
"""What a line more costs, in mm of lines."""

Row = list[Point]
Span = tuple[float, float]


def grid_lines(metal: shapely.Geometry, grid_mm: float) -> list[Row]:
    """Lines that cut metal into pieces no larger than the grid, either way, placed where little is cut.

    Examples
    --------
    >>> grid_lines(shapely.box(0, 0, 900, 400), 500)
    [[(400.0, 0.0), (400.0, 400.0)]]
    >>> grid_lines(shapely.box(0, 0, 400, 600).difference(shapely.box(50, 50, 350, 550)), 500)
    [[(0.0, 100.0), (50.0, 100.0)], [(350.0, 100.0), (400.0, 100.0)]]
    """
    if metal.is_empty:
        return []
    x0, y0, x1, y1 = metal.bounds
    shapely.prepare(metal)
    upright = {x: _spans(metal, x, 0) for x in _places(metal, x0, x1, grid_mm, 0)}
    rows: list[Row] = [[(x, a), (x, b)] for x, spans in upright.items() for a, b in spans]
    for y in _places(metal, y0, y1, grid_mm, 1):
        at = [x for x, spans in upright.items() if any(a <= y <= b for a, b in spans)]
        for a, b in _spans(metal, y, 1):
            ends = [a, *(x for x in at if a < x < b), b]
            rows += [[(p, y), (q, y)] for p, q in pairwise(ends) if q - p > TOUCH_MM]
    return rows


def _places(metal: shapely.Geometry, low: float, high: float, grid_mm: float, axis: int) -> list[float]:
    """Where lines stand: no further apart than the grid, and what they cut costs least."""
    if high - low <= grid_mm:
        return []
    steps = int(np.ceil((high - low) / grid_mm * _TRIED))
    at: Floats = np.linspace(low, high, steps + 1)
    price = np.array([0.0, *(_price(_spans(metal, float(v), axis)) for v in at[1:-1]), 0.0])
    most = int(np.floor(grid_mm / (at[1] - at[0]) + 1e-9))
    cost, before = np.full(len(at), np.inf), np.zeros(len(at), dtype=np.int64)
    cost[0] = 0.0
    for k in range(1, len(at)):
        first = max(0, k - most)
        chosen = first + int(np.argmin(cost[first:k]))
        cost[k], before[k] = cost[chosen] + price[k], chosen
    found: list[float] = []
    k = int(before[-1])
    while k > 0:
        found.append(float(at[k]))
        k = int(before[k])
    return found[::-1]


def _price(spans: Sequence[Span]) -> float:
    return sum(b - a + _PIERCE_MM for a, b in spans)


def _spans(metal: shapely.Geometry, at: float, axis: int) -> list[Span]:
    """Where a line upright (axis 0) at x, or across (axis 1) at y, runs over metal, in order."""
    x0, y0, x1, y1 = metal.bounds
    ends = [(at, y0 - 1), (at, y1 + 1)] if axis == 0 else [(x0 - 1, at), (x1 + 1, at)]
    pieces = shapely.get_parts(shapely.intersection(metal, shapely.LineString(ends)))
    bounds = shapely.bounds(pieces)[:, [1 - axis, 3 - axis]] if len(pieces) else np.empty((0, 2))
    return [(a, b) for a, b in sorted(bounds.tolist()) if b - a > TOUCH_MM]
