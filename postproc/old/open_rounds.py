"""Rounds that are open but for a tab: the torch goes off short of where it joined, on its way there."""

from __future__ import annotations

import math

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment

from .loops import CLOSED_MM, OPEN, NoRound, Round

_BEND_RAD = math.radians(25.0)
"""How far the way over a tab may turn at either end of it."""


def round_up_to_tab(path: Curve, most_mm: float) -> Round:
    """The round of a path that ends no more than `most_mm` before a block's end that it has passed, heading for it.

    What is missing is filled by the line or arc that goes on as the path ends, and comes to that block as it begins.

    Raises
    ------
    NoRound
        If there is no such block, or more than one.

    Examples
    --------
    >>> square = [(5, -3), (5, 0), (10, 0), (10, 10), (0, 10), (0, 0), (2, 0)]
    >>> found = round_up_to_tab(Curve.of(square, closed=False), 4.0)
    >>> found.lead_in.length_mm, found.ring.length_mm
    (3.0, 40.0)
    """
    last = path.segments[-1]
    begins = [k for k, segment in enumerate(path.segments[:-2]) if _heads_for(last, segment, most_mm)]
    if not begins:
        raise NoRound(OPEN)
    if len(begins) > 1:
        raise NoRound(f"{OPEN}, and nobody can be sure where a tab of it ends")
    begin_mm = float(path.starts_mm[begins[0]])
    rows = path.between(begin_mm, path.length_mm - begin_mm).as_rows()
    (tx, ty), (ux, uy) = last.tangent_at(1.0), path.segments[begins[0]].tangent_at(0.0)
    turn = math.atan2(tx * uy - ty * ux, tx * ux + ty * uy)
    *joined, (x, y, *_) = rows
    ring = Curve.of([*joined, (x, y, math.tan(turn / 4))])
    if not ring.polygon().is_valid:
        raise NoRound("its round crosses itself")
    return Round(ring, path.between(0.0, begin_mm), path.between(path.length_mm, 0.0))


def _heads_for(last: Segment, begins: Segment, most_mm: float) -> bool:
    """Whether a path that ends so is on its way to where a block begins, which goes on that way."""
    apart_mm = math.dist(last.end, begins.start)
    if not CLOSED_MM < apart_mm <= most_mm:
        return False
    way = (begins.start[0] - last.end[0]) / apart_mm, (begins.start[1] - last.end[1]) / apart_mm
    return max(_turn_rad(last.tangent_at(1.0), way), _turn_rad(way, begins.tangent_at(0.0))) <= _BEND_RAD


def _turn_rad(one: Point, then: Point) -> float:
    return math.acos(min(max(one[0] * then[0] + one[1] * then[1], -1.0), 1.0))
