"""What a reader makes of a program: its burns as chains of points, and how far it moves otherwise."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

Point = tuple[float, float]


@dataclass(slots=True)
class Heard:
    """Burns as points, mm, arcs as chords; their lengths as the reader has them; the length of all other moves, mm.

    `powers` are the greatest power of each burn, where the reader knows of power.
    """

    burns: list[list[Point]] = field(default_factory=list)
    lengths_mm: list[float] = field(default_factory=list)
    idle_mm: float = 0.0
    powers: list[float] = field(default_factory=list)


def length_mm(points: list[Point]) -> float:
    """Length of a chain of points."""
    return sum(math.dist(a, b) for a, b in pairwise(points))


def sweep_rad(start: Point, end: Point, centre: Point, ccw: bool) -> float:
    """How far an arc turns, counter-clockwise positive; one that ends where it starts is a full circle."""
    if math.dist(start, end) < 1e-9:
        return math.tau if ccw else -math.tau
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    turn = math.atan2(end[1] - centre[1], end[0] - centre[0]) - a
    return turn % math.tau if ccw else -(-turn % math.tau)


def arc_points(start: Point, end: Point, centre: Point, ccw: bool, tolerance_mm: float = 0.002) -> list[Point]:
    """An arc as chords, its start left out."""
    r = math.dist(start, centre)
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    sweep = sweep_rad(start, end, centre, ccw)
    step = 2 * math.acos(max(1 - tolerance_mm / r, 0.0)) if r > tolerance_mm else math.tau
    count = max(math.ceil(abs(sweep) / step), 1)
    inner = [a + sweep * k / count for k in range(1, count)]
    return [*((centre[0] + r * math.cos(t), centre[1] + r * math.sin(t)) for t in inner), end]
