"""Models of motion: constant feeds (Tavaeva and Petunin), and acceleration-limited moves round corners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.torch_path import SPECK_MM, CornerFeed, paced

# What every time model answers: how long the machine moves along a torch-on path, and over an idle move.


class Motion(Protocol):
    """How a machine moves; paths begin and end at rest."""

    @property
    def words(self) -> str:
        """The model in a few words, as plans and programs state it."""
        ...

    def run_s(self, path: Curve, marks: bool, feed_share: float = 1.0) -> float:
        """Time along an open torch-on path, s, at a share of its feed."""
        ...

    def travel_s(self, length_mm: float) -> float:
        """Time of a straight idle move, s."""
        ...


# Time of a program at constant feeds: T = L_on / V_on + L_off / V_off + N_pt · t_pt (Tavaeva and Petunin).


@dataclass(frozen=True, slots=True)
class Feeds:
    """Speeds in mm/s and the time to pierce, to start marking, and to preheat for an edge start, s.

    `corners` says how much slower corners are cut, None for not at all.
    """

    cut_mm_s: float
    mark_mm_s: float
    travel_mm_s: float
    pierce_s: float
    mark_start_s: float = 0.0
    edge_s: float = 0.0
    corners: CornerFeed | None = None

    def at_full_mm(self, path: Curve, marks: bool) -> float:
        """The length that takes as long at the full feed as a path does with its corners, mm."""
        more_mm = 0.0 if marks or self.corners is None else self.corners.more_mm(path)
        return path.length_mm + more_mm


@dataclass(frozen=True, slots=True)
class ConstantFeed:
    """Every path at its feed from the first millimetre to the last; a model of motion (see `motion.py`).

    Examples
    --------
    >>> ConstantFeed(Feeds(10, 20, 50, 0.5)).run_s(Curve.of([(0, 0), (30, 40)], closed=False), marks=False)
    5.0
    """

    feeds: Feeds
    words: str = "constant feed"

    def run_s(self, path: Curve, marks: bool, feed_share: float = 1.0) -> float:
        """Time along an open torch-on path, s, at a share of its feed."""
        return self.feeds.at_full_mm(path, marks) / (
            feed_share * (self.feeds.mark_mm_s if marks else self.feeds.cut_mm_s)
        )

    def travel_s(self, length_mm: float) -> float:
        """Time of an idle move, s."""
        return length_mm / self.feeds.travel_mm_s


@dataclass(frozen=True, slots=True)
class Leg:
    """One torch-on path: where it starts and ends, its length, whether it marks or enters from the edge, its feed.

    A `linked` one begins where the last ended, with the torch on.
    """

    start: Point
    end: Point
    length_mm: float
    marks: bool = False
    pierced: bool = True
    feed_share: float = 1.0
    linked: bool = False


def schedule(legs: Sequence[Leg], feeds: Feeds, home: Point) -> list[tuple[float, float]]:
    """Seconds from the program's start at which each leg begins (pierce included) and ends.

    Examples
    --------
    >>> schedule([Leg((30, 40), (30, 40), 100)], Feeds(10, 10, 50, 0.5), (0, 0))
    [(1.0, 11.5)]
    """
    now, at = 0.0, home
    times = []
    for leg in legs:
        begin = now + math.dist(at, leg.start) / feeds.travel_mm_s
        speed = feeds.mark_mm_s if leg.marks else feeds.cut_mm_s
        wait = feeds.mark_start_s if leg.marks else feeds.pierce_s if leg.pierced else feeds.edge_s
        wait = 0.0 if leg.linked else wait
        now, at = begin + wait + leg.length_mm / (speed * leg.feed_share), leg.end
        times.append((begin, now))
    return times


def idle_mm(legs: Sequence[Leg], home: Point) -> float:
    """Idle travel from home through all legs and back, mm."""
    ends = [home, *(leg.end for leg in legs)]
    starts = [*(leg.start for leg in legs), home]
    return sum(map(math.dist, ends, starts))


# Acceleration-limited motion: the machine speeds up, cruises and slows down, and takes corners and arcs no faster
# than its axes allow.


def trapezoid_s(length_mm: float, start_mm_s: float, end_mm_s: float, top_mm_s: float, acceleration: float) -> float:
    """Time over a length from one speed to another, as fast as `top_mm_s` and the acceleration (mm/s²) allow.

    The two speeds must be reachable from each other: |end² - start²| ≤ 2 a length. Where the length is too short to
    reach the top speed the trapezoid is a triangle.

    Examples
    --------
    >>> trapezoid_s(100, 0, 0, 100, 1000)
    1.1
    >>> round(trapezoid_s(4, 0, 0, 100, 1000), 4)
    0.1265
    """
    if length_mm <= 0:
        return 0.0
    squares = start_mm_s**2 + end_mm_s**2
    peak = min(top_mm_s, math.sqrt((2 * acceleration * length_mm + squares) / 2))
    ramps_mm = (2 * peak**2 - squares) / (2 * acceleration)
    return (2 * peak - start_mm_s - end_mm_s) / acceleration + max(length_mm - ramps_mm, 0.0) / peak


@dataclass(frozen=True, slots=True)
class Accelerated:
    """A machine whose acceleration is limited, in any direction, to `acceleration_mm_s2`; a model of motion.

    Every path and every idle move begins and ends at rest. Along a path the control looks ahead as far as it must: the
    speed at each corner is the highest from which it can still slow down for all that follows.
    """

    feeds: Feeds
    acceleration_mm_s2: float
    corner_deviation_mm: float

    @property
    def words(self) -> str:
        """The model in a few words."""
        return f"acceleration {self.acceleration_mm_s2 / 1000:g} m/s2, corners {self.corner_deviation_mm:g} mm"

    def run_s(self, path: Curve, marks: bool, feed_share: float = 1.0) -> float:
        """Time along an open torch-on path, s, at a share of its feed.

        Examples
        --------
        >>> machine = Accelerated(Feeds(100, 100, 100, 0), 1000, 0.05)
        >>> machine.run_s(Curve.of([(0, 0), (100, 0)], closed=False), marks=False)
        1.1
        """
        feed = feed_share * (self.feeds.mark_mm_s if marks else self.feeds.cut_mm_s)
        pieces = paced(path, None if marks else self.feeds.corners)
        sound = [(s, feed * share) for s, share in pieces if s.length_mm > SPECK_MM]
        segments = [s for s, _ in sound]
        specks_mm = path.length_mm - sum(s.length_mm for s in segments)
        if not segments:
            return self.travel_s(path.length_mm, feed)
        tops = [min(top, math.sqrt(self.acceleration_mm_s2 * s.radius_mm)) for s, top in sound]
        speeds = self._speeds(segments, tops)
        times = (
            trapezoid_s(s.length_mm, speeds[k], speeds[k + 1], tops[k], self.acceleration_mm_s2)
            for k, s in enumerate(segments)
        )
        return sum(times) + specks_mm / feed

    def travel_s(self, length_mm: float, top_mm_s: float | None = None) -> float:
        """Time of a straight idle move, s, from rest to rest."""
        return trapezoid_s(length_mm, 0.0, 0.0, top_mm_s or self.feeds.travel_mm_s, self.acceleration_mm_s2)

    def _speeds(self, segments: list[Segment], tops: list[float]) -> list[float]:
        """Speed at the start of every segment and at the end of the last, mm/s."""
        a = self.acceleration_mm_s2
        speeds = [0.0]
        for k in range(1, len(segments)):
            corner = corner_mm_s(segments[k - 1], segments[k], a, self.corner_deviation_mm)
            reached = math.sqrt(speeds[-1] ** 2 + 2 * a * segments[k - 1].length_mm)
            speeds.append(min(corner, reached, tops[k - 1], tops[k]))
        speeds.append(0.0)
        for k in range(len(segments) - 1, -1, -1):
            speeds[k] = min(speeds[k], math.sqrt(speeds[k + 1] ** 2 + 2 * a * segments[k].length_mm))
        return speeds


# How fast a machine may pass from one segment of a path to the next.

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
