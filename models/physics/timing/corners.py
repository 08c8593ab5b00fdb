"""How fast a machine may pass from one segment of a path to the next."""

from __future__ import annotations

import math

from kerfwise.encoder.geometry.segment import Segment

_STRAIGHT_RAD = 1e-6


def corner_mm_s(before: Segment, after: Segment, acceleration_mm_s2: float, deviation_mm: float) -> float:
    """The speed, mm/s, at which the corner between two segments may be taken.

    A corner that turns by an angle phi is taken as the arc that touches both segments and stays within `deviation_mm`
    of the corner (Jeon 2011, "junction deviation", as in Grbl): its radius is deviation cos(phi/2) / (1 - cos(phi/2)),
    and the speed on it is that at which the acceleration towards its centre is the one given, v² = a r. The arc also
    takes no more than half of either segment, so that a circle drawn in chords is not faster than the circle.

    Examples
    --------
    >>> right_angle = Segment((0, 0), (50, 0)), Segment((50, 0), (50, 50))
    >>> round(corner_mm_s(*right_angle, 1000.0, 0.05), 2)
    10.99
    >>> corner_mm_s(Segment((0, 0), (50, 0)), Segment((50, 0), (90, 0)), 1000.0, 0.05)
    inf
    """
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    half = abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by)) / 2
    if half < _STRAIGHT_RAD:
        return math.inf
    rounded_mm = deviation_mm * math.cos(half) / (1 - math.cos(half))
    fits_mm = min(before.length_mm, after.length_mm) / 2 / math.tan(half)
    return math.sqrt(acceleration_mm_s2 * max(min(rounded_mm, fits_mm), 0.0))
