"""Arcs as a program spells them: end with centre, or end with radius."""

from __future__ import annotations

import math

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point, Segment

# Radius at the arc's end against that at its start: GRBL's limits, tighter than LinuxCNC's 0.0283 mm.
MISMATCH_MM, MISMATCH_SHARE, MISMATCH_MOST_MM = 0.005, 0.001, 0.5


def arc_by_centre(start: Point, end: Point, centre: Point, ccw: bool, line: int) -> tuple[Segment, ...]:
    """An arc about a centre, a full circle when it ends where it starts; beyond a half turn it comes in two.

    Raises
    ------
    InputError
        If the radius at the end is not that at the start within what controls accept.

    Examples
    --------
    >>> [segment.length_mm for segment in arc_by_centre((10, 0), (10, 0), (0, 0), True, 1)]
    [31.41592653589793, 31.41592653589793]
    """
    r, r_end = math.dist(start, centre), math.dist(end, centre)
    error = abs(r - r_end)
    if r == 0 or r_end == 0:
        raise InputError("an arc of no radius", line=line)
    if error > MISMATCH_MOST_MM or (error > MISMATCH_MM and error > MISMATCH_SHARE * r):
        raise InputError(f"the arc's radius is {r:.4f} mm at its start and {r_end:.4f} mm at its end", line=line)
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    turn = math.atan2(end[1] - centre[1], end[0] - centre[0]) - a
    sweep = turn % math.tau if ccw else -(-turn % math.tau)
    if start == end:
        sweep = math.tau if ccw else -math.tau
    if abs(sweep) <= math.pi:
        return (Segment(start, end, math.tan(sweep / 4)),)
    middle = (centre[0] + r * math.cos(a + sweep / 2), centre[1] + r * math.sin(a + sweep / 2))
    bulge = math.tan(sweep / 8)
    return Segment(start, middle, bulge), Segment(middle, end, bulge)


def arc_by_radius(start: Point, end: Point, radius_mm: float, ccw: bool, line: int) -> tuple[Segment, ...]:
    """An arc by its radius: the shorter way round, or the longer one when the radius is negative.

    Raises
    ------
    InputError
        If the ends are the same point, or further apart than the radius allows.

    Examples
    --------
    >>> [round(arc.sweep_rad, 4) for arc in arc_by_radius((0, 0), (10, 10), -10, True, 1)]
    [4.7124]
    """
    half = math.dist(start, end) / 2
    if half == 0:
        raise InputError("an arc by R that ends where it starts", line=line)
    if half > abs(radius_mm) + MISMATCH_MM:
        raise InputError(f"R{radius_mm:g} is too small: the arc's ends are {2 * half:.4f} mm apart", line=line)
    quarter = math.asin(min(half / abs(radius_mm), 1.0)) / 2
    bulge = math.tan(quarter if radius_mm > 0 else math.pi / 2 - quarter)
    return (Segment(start, end, bulge if ccw else -bulge),)
