"""Two rings and the sides of a strip become one ring, or a ring and a pocket: lines stay lines, arcs stay arcs."""

from __future__ import annotations

import math

from kerfwise.encoder.geometry.crossing import Circle, Line, crossings
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.validate.tolerances import TOUCH_MM

from .bridge import Bridge

BEYOND_MM = 2 * TOUCH_MM
"""A strip that ends on an edge goes on by so much, so that its sides meet the edge."""
_SAME_MM = 1e-6

Met = tuple[float, float]
"""How far along a side, and how far along the ring, mm."""


def joined_rings(bridge: Bridge, one: Curve, other: Curve) -> Curve:
    """The counter-clockwise outline of what two such outlines enclose, and the strip between them.

    Raises
    ------
    InputError
        If a side of the strip leaves the one, or enters the other, more or less than once.

    Examples
    --------
    >>> a, b = (Curve.of([(x, 0), (x + 10, 0), (x + 10, 10), (x, 10)]) for x in (0, 15))
    >>> joined_rings(Bridge(("A", "B"), (10, 5), (15, 5), 4, 1), a, b).signed_area_mm2
    220.0
    """
    names = bridge.parts
    leaves = {left: _once(bridge, met(bridge, one, left), names[0]) for left in (False, True)}
    enters = {left: _once(bridge, met(bridge, other, left), names[1]) for left in (False, True)}
    for left in (False, True):
        _expect_a_gap(bridge, leaves[left], enters[left])
    first = _stretch(one, leaves[True][1], leaves[False][1])
    second = _stretch(other, enters[False][1], enters[True][1])
    return Curve.of([*first.vertices.tolist(), *second.vertices.tolist()])


def ring_and_pocket(bridge: Bridge, ring: Curve) -> tuple[Curve, Curve]:
    """The counter-clockwise outline, and the waste that it encloses then, of an outline with a strip across its waste.

    Raises
    ------
    InputError
        If a side of the strip meets the outline more or less often than twice.
    """
    found = {}
    for left in (False, True):
        sides = met(bridge, ring, left)
        if len(sides) != 2:
            raise bridge.refused(_too_often(len(sides), " and ".join(bridge.parts)))
        _expect_a_gap(bridge, *sides)
        found[left] = sides
    (_, one_right), (_, other_right) = found[False]
    (_, one_left), (_, other_left) = found[True]
    loops = [_stretch(ring, one_left, other_left), _stretch(ring, other_right, one_right)]
    curves = sorted((Curve.of(loop.vertices.tolist()) for loop in loops), key=lambda c: c.signed_area_mm2)
    return curves[1], curves[0]


def met(bridge: Bridge, ring: Curve, left: bool) -> list[Met]:
    """Where a side of a strip meets a ring, in the order along the side."""
    begin, end = bridge.side(left, BEYOND_MM)
    length_mm = math.dist(begin, end)
    along = ((end[0] - begin[0]) / length_mm, (end[1] - begin[1]) / length_mm)
    found: list[Met] = []
    for start_mm, segment in zip(ring.starts_mm.tolist(), ring.segments, strict=False):
        for x, y in crossings(Line(begin, along), _track(segment)):
            at_mm = (x - begin[0]) * along[0] + (y - begin[1]) * along[1]
            share, off_mm = segment.project((x, y))
            if off_mm <= _SAME_MM and -_SAME_MM <= at_mm <= length_mm + _SAME_MM:
                found.append((at_mm, (start_mm + share * segment.length_mm) % ring.length_mm))
    found.sort()
    return [one for k, one in enumerate(found) if k == 0 or one[0] - found[k - 1][0] > _SAME_MM]


def _track(segment: Segment) -> Line | Circle:
    if segment.is_arc:
        return Circle(segment.centre, segment.radius_mm, 1 if segment.bulge > 0 else -1)
    return Line(segment.start, segment.tangent_at(0.0))


def _once(bridge: Bridge, found: list[Met], part: str) -> Met:
    if len(found) != 1:
        raise bridge.refused(_too_often(len(found), part))
    return found[0]


def _too_often(times: int, part: str) -> str:
    if not times:
        return f"does not meet the outline of {part}: begin and end it in the parts, on both sides of the gap"
    return (
        f"crosses the outline of {part} more often than once on one side: it may be too wide there, or run through a "
        "notch; begin it nearer to the gap, or make it narrower"
    )


def _expect_a_gap(bridge: Bridge, leaves: Met, enters: Met) -> None:
    if enters[0] - leaves[0] <= TOUCH_MM:
        raise bridge.refused("crosses no gap: the parts touch there, or overlap")


def _stretch(ring: Curve, begin_mm: float, end_mm: float) -> Curve:
    """The stretch of a closed ring from one place to another, the way it runs."""
    return ring.between(begin_mm, (end_mm - begin_mm) % ring.length_mm)


def ends_of(bridge: Bridge) -> tuple[tuple[Point, Point], tuple[Point, Point]]:
    """The two corners at either end of a strip."""
    right, left = bridge.side(left=False), bridge.side(left=True)
    return (right[0], left[0]), (right[1], left[1])
