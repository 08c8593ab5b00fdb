"""Kerf that the control adds (G41, G42): the torch's paths from what a program names, by this judge's own geometry.

Each line or arc is shifted half the kerf to the torch's side, an arc about its own centre; at a corner that the torch
goes round outside it follows a circle about the corner, at any other the shifted lines end where they meet.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely.ops import substring

from kerfwise.tests.metal.arcs import Floats, Point, chords, sweep_rad
from kerfwise.tests.metal.tolerances import CHORD_MM

JOINED_MM = 2 * CHORD_MM
"""Shifted moves whose ends are so near go on into each other: what is named has four decimals."""


class NoRoom(ValueError):
    """The torch cannot follow beside the path: no control does it."""


@dataclass(frozen=True, slots=True)
class Move:
    """One move as a program names it; an arc has a centre, and `turn_rad` counts against the clock."""

    start: Point
    end: Point
    centre: Point | None = None
    turn_rad: float = 0.0

    @staticmethod
    def arc(start: Point, centre: Point, end: Point, ccw: bool) -> Move:
        """An arc by its ends and its centre; the same start and end are a full turn."""
        return Move(start, end, centre, sweep_rad(start, centre, end, ccw))

    def heading(self, at: Point) -> Point:
        """The direction of the move at one of its ends, of length 1."""
        if self.centre is None:
            dx, dy = self.end[0] - self.start[0], self.end[1] - self.start[1]
        else:
            way = math.copysign(1.0, self.turn_rad)
            dx, dy = -(at[1] - self.centre[1]) * way, (at[0] - self.centre[0]) * way
        length = math.hypot(dx, dy)
        return dx / length, dy / length

    def shifted(self, aside_mm: float) -> Floats:
        """Array (n, 2) of the torch's way so far to the left of the move (to the right, if negative)."""
        first, last = (_aside(at, self.heading(at), aside_mm) for at in (self.start, self.end))
        if self.centre is None:
            return np.array([first, last])
        if math.dist(self.start, self.centre) <= math.copysign(aside_mm, self.turn_rad * aside_mm):
            raise NoRoom(f"an arc of {math.dist(self.start, self.centre):.4f} mm is no more than half the kerf")
        return np.concatenate([[first], chords(first, self.centre, self.turn_rad, last)])


def torch_ways(moves: Sequence[Move], aside_mm: float) -> list[Floats]:
    """For each named move the points that the torch goes through after its start; the first move only leads up to it.

    Raises
    ------
    NoRoom
        For an arc, or a line shorter than half the kerf, as the first move, and where the torch does not fit.
    """
    if moves[0].centre is not None or math.dist(moves[0].start, moves[0].end) < abs(aside_mm):
        raise NoRoom("the first move is no line of half the kerf or more")
    first = np.array([_aside(moves[0].end, moves[0].heading(moves[0].end), aside_mm)])
    ways, rounded = [np.concatenate([[moves[0].start], first])], [np.empty((0, 2))]
    for before, move in pairwise(moves):
        way, corner = move.shifted(aside_mm), np.empty((0, 2))
        last = _point(ways[-1][-1])
        (ax, ay), (bx, by) = before.heading(before.end), move.heading(move.start)
        turn = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
        if math.dist(last, way[0]) > JOINED_MM:
            if turn * aside_mm < 0:
                corner = chords(last, move.start, turn, _point(way[0]))
            else:
                ways[-1], way = _until_they_meet(ways[-1], way)
        ways.append(way)
        rounded.append(corner)
    return [np.concatenate([corner, way[1:]]) for corner, way in zip(rounded, ways, strict=True)]


def _until_they_meet(one: Floats, other: Floats) -> tuple[Floats, Floats]:
    """Two ways, the first up to where they cross, the second from there on."""
    a, b = shapely.LineString(one), shapely.LineString(other)
    crossings = shapely.get_coordinates(a.intersection(b)).tolist()
    if not crossings:
        raise NoRoom(f"half the kerf has no room in the corner at ({one[-1][0]:.3f}, {one[-1][1]:.3f})")
    at = shapely.Point(min(crossings, key=lambda xy: math.dist(xy, one[-1])))
    head, tail = substring(a, 0.0, a.project(at)), substring(b, b.project(at), b.length)
    return shapely.get_coordinates(head), shapely.get_coordinates(tail)


def _aside(at: Point, heading: Point, aside_mm: float) -> Point:
    return at[0] - heading[1] * aside_mm, at[1] + heading[0] * aside_mm


def _point(row: Floats) -> Point:
    return float(row[0]), float(row[1])
