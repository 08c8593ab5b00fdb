"""What of a ring nobody has to burn: its rounds at corners, and its tabs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.nest import Contour

from .intervals import NONE, union

_SAME_MM = 1e-4
_CHORD_MM = 0.005


def rounds(ring: shapely.LineString, contour: Contour) -> Floats:
    """The stretches of a ring that go round corners of its contour, as a set of intervals.

    Once the torch has been at both ends of such a round, the corner is cut. Whether it goes round in between, or
    straight on until its next way crosses, is the same to the part.
    """
    points = shapely.points(shapely.get_coordinates(ring))
    at_mm = shapely.line_locate_point(ring, points)
    at_mm[-1] = ring.length if contour.encloses else at_mm[-1]
    beside = shapely.line_locate_point(contour.curve.line(_CHORD_MM), points)
    turns = np.abs(np.diff(beside)) < _SAME_MM
    return union(np.stack([at_mm[:-1][turns], at_mm[1:][turns]], axis=1), _SAME_MM) if turns.any() else NONE


def at_tabs(ring: shapely.LineString, tabs: Sequence[Tab], more_mm: float) -> Floats:
    """The stretches of a closed ring that its tabs take, each `more_mm` wider at both ends, as a set of intervals.

    Here a tab is as wide as the ring is not burnt: as its metal and the kerf.
    """
    rows: list[tuple[float, float]] = []
    length_mm = float(ring.length)
    for tab in tabs:
        middle = float(shapely.line_locate_point(ring, shapely.Point(tab.at)))
        half = min(tab.width_mm / 2 + more_mm, length_mm / 2)
        low, high = middle - half, middle + half
        rows += [(max(low, 0.0), min(high, length_mm))]
        rows += [(length_mm + low, length_mm)] if low < 0 else []
        rows += [(0.0, high - length_mm)] if high > length_mm else []
    return union(np.array(rows)) if rows else NONE
