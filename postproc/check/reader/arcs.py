"""Arcs as a program spells them: end with centre, or end with radius."""

from __future__ import annotations

import math

from kerfwise.encoder.geometry.segment import Point, Segment

from .words import Block

MISMATCH_MM = 0.005
"""Radius at an arc's end against that at its start, at most: LinuxCNC takes 0.0283 mm, and 0.1 % of large radii; what
lies between the two is the control's choice."""
_SHORT_MM = 0.001
"""How far LinuxCNC (0.00127 mm) lets the ends of an arc by R be further apart than twice its radius, and less."""
_ALL_OR_NOTHING_MM, _ALL_OR_NOTHING_RAD = 0.001, 1e-5
"""Nearer to no turn or a full one, the last digit of a number decides which of the two a control makes."""
_UNCLEAR = (
    "the arc ends so near its start that controls make nothing or a full circle of it: not supported here; write a "
    "line, or for a full circle exactly the same point"
)


def arc_by_centre(
    start: Point, end: Point, centre: Point, ccw: bool, block: Block, mismatch_mm: float = MISMATCH_MM
) -> tuple[Segment, ...]:
    """An arc about a centre, a full circle when it ends where it starts; beyond a half turn it comes in two.

    Its radius may differ by `mismatch_mm` between its ends.

    Raises
    ------
    InputError
        If the radius at the end is not that at the start within what controls accept.

    Examples
    --------
    >>> [segment.length_mm for segment in arc_by_centre((10, 0), (10, 0), (0, 0), True, Block(1))]
    [31.41592653589793, 31.41592653589793]
    """
    r, r_end = math.dist(start, centre), math.dist(end, centre)
    error = abs(r - r_end)
    if min(r, r_end) < mismatch_mm:
        raise block.refused(f"an arc of no radius ({r:.4f} mm): not supported here; write a line")
    if error > mismatch_mm:
        raise block.refused(
            f"the arc's radius is {r:.4f} mm at its start and {r_end:.4f} mm at its end: not supported here; correct "
            "its centre or its end"
        )
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    turn = math.atan2(end[1] - centre[1], end[0] - centre[0]) - a
    sweep = turn % math.tau if ccw else -(-turn % math.tau)
    if start == end:
        sweep = math.tau if ccw else -math.tau
    elif math.dist(start, end) < _ALL_OR_NOTHING_MM or min(abs(sweep), math.tau - abs(sweep)) < _ALL_OR_NOTHING_RAD:
        raise block.refused(_UNCLEAR)
    if abs(sweep) <= math.pi:
        return (Segment(start, end, math.tan(sweep / 4)),)
    middle = (centre[0] + r * math.cos(a + sweep / 2), centre[1] + r * math.sin(a + sweep / 2))
    bulge = math.tan(sweep / 8)
    return Segment(start, middle, bulge), Segment(middle, end, bulge)


def arc_by_radius(
    start: Point, end: Point, radius_mm: float, ccw: bool, block: Block, short_mm: float = _SHORT_MM
) -> tuple[Segment, ...]:
    """An arc by its radius: the shorter way round, or the longer one when the radius is negative.

    Its ends may be further apart than twice the radius by twice `short_mm`.

    Raises
    ------
    InputError
        If the ends are the same point, or further apart than the radius allows.

    Examples
    --------
    >>> [round(arc.sweep_rad, 4) for arc in arc_by_radius((0, 0), (10, 10), -10, True, Block(1))]
    [4.7124]
    """
    half = math.dist(start, end) / 2
    if half == 0:
        raise block.refused("an arc by R that ends where it starts; write its centre as I and J", block.words.get("R"))
    if half < _ALL_OR_NOTHING_MM or abs(radius_mm) > half / _ALL_OR_NOTHING_RAD:
        raise block.refused(_UNCLEAR)
    if half > abs(radius_mm) + short_mm:
        raise block.refused(
            f"R{radius_mm:g} is too small, the arc's ends are {2 * half:.4f} mm apart: not supported here; correct it",
            block.words.get("R"),
        )
    quarter = math.asin(min(half / abs(radius_mm), 1.0)) / 2
    bulge = math.tan(quarter if radius_mm > 0 else math.pi / 2 - quarter)
    return (Segment(start, end, bulge if ccw else -bulge),)
