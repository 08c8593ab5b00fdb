"""Acceleration-limited motion: the machine speeds up, cruises and slows down, and takes corners and arcs no faster
than its axes allow."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kerfwise.encoder.corner_feed import SPECK_MM, paced
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment

from .constant import Feeds
from .corners import corner_mm_s


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
