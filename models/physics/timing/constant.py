"""Time of a program at constant feeds: T = L_on / V_on + L_off / V_off + N_pt · t_pt (Tavaeva and Petunin)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from kerfwise.encoder.corner_feed import CornerFeed
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point


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
