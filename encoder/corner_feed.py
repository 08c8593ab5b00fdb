"""Slower feeds at corners: which stretches of a path are cut at which share of its feed.

One definition for the program, the clock and the heat: they all take the stretches from here. The check finds corners
by itself, in the program that it reads.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Floats

from .geometry.curve import Curve
from .geometry.segment import Segment

Paced = tuple[Segment, float]
"""A line or arc, and the share of the feed that it is cut at."""

SPECK_MM = 0.02
"""Segments shorter than this, which rounding leaves, have no direction that means anything, and make no corners."""
CRUMB_MM = 0.05
"""No stretch begins or ends this near the end of a line or arc, but there."""


@dataclass(frozen=True, slots=True)
class CornerFeed:
    """Where a path turns by `angle_deg` or more, it is cut at a `share` of its feed, `reach_mm` before and behind.

    Examples
    --------
    >>> law = CornerFeed(0.5, 45.0, 2.0)
    >>> path = Curve.of([(0, 0), (10, 0), (10, 10)], closed=False)
    >>> [(round(segment.length_mm, 6), share) for segment, share in law.stretches(path)]
    [(8.0, 1.0), (2.0, 0.5), (2.0, 0.5), (8.0, 1.0)]
    """

    share: float
    angle_deg: float
    reach_mm: float

    def corners_mm(self, path: Curve) -> list[float]:
        """How far along the path each of its corners lies, mm; the ends of an open path are none."""
        known = [(s, at) for s, at in zip(path.segments, path.starts_mm.tolist(), strict=False)]
        sound = [(s, at) for s, at in known if s.length_mm > SPECK_MM]
        pairs = [*pairwise(sound), *([(sound[-1], sound[0])] if path.closed and len(sound) > 1 else [])]
        return [at for (before, _), (after, at) in pairs if _turn_deg(before, after) >= self.angle_deg - 1e-6]

    def stretches(self, path: Curve) -> tuple[Paced, ...]:
        """The path as lines and arcs, cut where the feed changes."""
        slow = list(self._slow(path))
        if not slow:
            return paced(path, None)
        found: list[Paced] = []
        for segment, begin in zip(path.segments, path.starts_mm.tolist(), strict=False):
            length = segment.length_mm
            inner = {x - begin for span in slow for x in span}
            cuts = [0.0, *sorted(x for x in inner if CRUMB_MM < x < length - CRUMB_MM), length]
            for a, b in pairwise(cuts):
                middle = begin + (a + b) / 2
                share = self.share if any(low <= middle <= high for low, high in slow) else 1.0
                whole = (a, b) == (0.0, length)
                found.append((segment if whole else segment.between(a / length, b / length), share))
        return tuple(found)

    def more_mm(self, path: Curve) -> float:
        """By how much longer a path is that takes as long at its full feed."""
        slow_mm = math.fsum(segment.length_mm for segment, share in self.stretches(path) if share < 1)
        return slow_mm * (1 / self.share - 1)

    def _slow(self, path: Curve) -> Iterator[tuple[float, float]]:
        """The stretches near corners as path lengths, in order, each apart from the next."""
        total = path.length_mm
        spans = [(at - self.reach_mm, at + self.reach_mm) for at in self.corners_mm(path)]
        if path.closed:
            spans += [(a + by, b + by) for a, b in spans for by in (-total, total)]
        last: tuple[float, float] | None = None
        for a, b in sorted((max(a, 0.0), min(b, total)) for a, b in spans if a < total and b > 0):
            if last is not None and a <= last[1] + CRUMB_MM:
                last = (last[0], max(b, last[1]))
                continue
            if last is not None:
                yield last
            last = (a, b)
        if last is not None:
            yield last


def paced(path: Curve, law: CornerFeed | None) -> tuple[Paced, ...]:
    """The lines and arcs of a path with their shares of its feed; all of it without a law."""
    return tuple((segment, 1.0) for segment in path.segments) if law is None else law.stretches(path)


def chords(path: Curve, pieces: Sequence[Paced], tolerance_mm: float) -> tuple[Floats, Floats | None]:
    """A path as points (k, 2), and how many times longer than at its full feed it takes for each step (k - 1,).

    `pieces` are all of the path. None where the feed does not change on the way.

    Examples
    --------
    >>> path = Curve.of([(0, 0), (10, 0), (10, 10)], closed=False)
    >>> points, slowness = chords(path, paced(path, CornerFeed(0.5, 45.0, 2.0)), 0.1)
    >>> points.tolist(), slowness.tolist()
    ([[0.0, 0.0], [8.0, 0.0], [10.0, 0.0], [10.0, 2.0], [10.0, 10.0]], [1.0, 2.0, 2.0, 1.0])
    """
    if len({share for _, share in pieces}) < 2:
        return path.flatten(tolerance_mm), None
    steps = [segment.flatten(tolerance_mm) for segment, _ in pieces]
    slowness = np.repeat([1 / share for _, share in pieces], [len(step) for step in steps])
    return np.concatenate([[pieces[0][0].start], *steps]), slowness


def _turn_deg(before: Segment, after: Segment) -> float:
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    return math.degrees(abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by)))
