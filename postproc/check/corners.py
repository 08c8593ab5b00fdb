"""Feeds at corners, as the check finds them: in the lines and arcs of a program, without the planner's own stretches.

Where a program's digits leave open whether a path turns far enough, or where exactly a stretch ends, both feeds may
stand.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.options.by_thickness import length_at
from kerfwise.rules.profile.profile import Profile

from .program_rules import step_mm

_LEAST_MM, _MOST_MM = 0.01, 0.03
"""Shorter lines and arcs make no corners; what lies between the two may."""
_ANGLE_DEG, _ROUNDED_MM = 1.0, 0.005
_PLACE_MM, _STEP_MM = 0.15, 0.5
_FEED_SHARE = 1e-3


def slow_at_corners(profile: Profile) -> bool:
    """Whether the profile has corners cut more slowly."""
    return profile.corners.corner_feed < 1 and _reach_mm(profile) > 0


def wrong_at_corners(
    burn: Burn, asked_mm_s: tuple[float, float], profile: Profile, slack_mm_s: float = 0.0
) -> Iterator[str]:
    """What is wrong with the feeds of a burn, `asked_mm_s` being the least and the greatest away from corners.

    A control of whole feeds rounds them by `slack_mm_s`.
    """
    segments, feeds = burn.path.segments, burn.step_feeds_mm_s
    ends_mm = np.concatenate([[0.0], np.cumsum([s.length_mm for s in segments])])
    sure, maybe = (np.array(list(found)) for found in _corners(segments, ends_mm, profile.corners.corner_angle))
    share, reach_mm = profile.corners.corner_feed, _reach_mm(profile)
    place_mm = _PLACE_MM + 2 * step_mm()
    low, high = asked_mm_s[0] * (1 - _FEED_SHARE), asked_mm_s[1] * (1 + _FEED_SHARE)
    for k, feed in enumerate(feeds):
        at_mm = _samples(ends_mm[k], ends_mm[k + 1])
        slow = low * share - slack_mm_s <= feed <= high * share + slack_mm_s
        full = low - slack_mm_s <= feed <= high + slack_mm_s
        if slow and full:
            continue
        if full:
            bad = at_mm[_apart_mm(at_mm, sure) < reach_mm - place_mm]
            says = f"{high / (1 + _FEED_SHARE) * share * 60:.0f} mm/min near this corner"
        elif slow:
            bad = at_mm[_apart_mm(at_mm, maybe) > reach_mm + place_mm]
            says = f"{high / (1 + _FEED_SHARE) * 60:.0f} mm/min, no corner being near"
        else:
            bad, says = at_mm[:1], f"{low * 60:.0f} mm/min, {share:g} of it at corners"
        if len(bad):
            x, y = burn.path.point_at(float(bad[0]))
            yield f"it cuts at {feed * 60:.0f} mm/min at ({x:.2f}, {y:.2f}), the profile says {says}"
            return


def slowness_of(points: Floats, profile: Profile) -> Floats | None:
    """How many times longer each step (k - 1,) of a plan's path of chords (k, 2) takes; None where all are alike."""
    if not slow_at_corners(profile) or len(points) < 3:
        return None
    steps_mm = np.hypot(*np.diff(points, axis=0).T)
    ends_mm = np.concatenate([[0.0], np.cumsum(steps_mm)])
    lines = [Segment(*pair) for pair in pairwise((x, y) for x, y in points.tolist())]
    known = [(line, end) for line, end in zip(lines, ends_mm.tolist(), strict=False) if line.length_mm > _MOST_MM]
    limit = profile.corners.corner_angle
    at_mm = np.array([end for (a, _), (b, end) in pairwise(known) if _turn_deg(a, b) >= limit - _ANGLE_DEG])
    if not len(at_mm):
        return None
    reach_mm = _reach_mm(profile)  # a long step is partly near a corner at each of its ends
    near_mm = np.zeros(len(steps_mm))
    for at in at_mm.tolist():
        near_mm += np.clip(np.minimum(ends_mm[1:], at + reach_mm) - np.maximum(ends_mm[:-1], at - reach_mm), 0.0, None)
    slow = np.clip(near_mm / np.maximum(steps_mm, 1e-12), 0.0, 1.0)
    return np.asarray(1.0 + slow * (1.0 / profile.corners.corner_feed - 1.0))


def _reach_mm(profile: Profile) -> float:
    return length_at(profile.corners.corner_reach, profile.material.thickness_mm)


def _corners(segments: tuple[Segment, ...], ends_mm: Floats, limit_deg: float) -> tuple[set[float], set[float]]:
    """Where the path surely turns as far as a corner does, and where it may, mm along it."""
    found = []
    rounded_mm = max(_ROUNDED_MM, step_mm() / math.sqrt(2))
    for least_mm in (_LEAST_MM, _MOST_MM + 2 * step_mm()):
        sure: set[float] = set()
        maybe: set[float] = set()
        known = [(s, at) for s, at in zip(segments, ends_mm.tolist(), strict=False) if s.length_mm > least_mm]
        for (before, _), (after, at) in pairwise(known):
            turn_deg = _turn_deg(before, after)
            shortest_mm = min(before.length_mm, after.length_mm)
            off_deg = _ANGLE_DEG + math.degrees(2 * rounded_mm / shortest_mm)
            if turn_deg >= limit_deg + off_deg:
                sure.add(at)
            if turn_deg >= limit_deg - off_deg:
                maybe.add(at)
        found.append((sure, maybe))
    (sure_a, maybe_a), (sure_b, maybe_b) = found
    return sure_a & sure_b, maybe_a | maybe_b


def _samples(begin_mm: float, end_mm: float) -> Floats:
    """Places along a line or arc, its ends among them."""
    return np.linspace(begin_mm, end_mm, max(3, math.ceil((end_mm - begin_mm) / _STEP_MM) + 1))


def _apart_mm(at_mm: Floats, corners_mm: Floats) -> Floats:
    """How far each place is from the nearest corner along the path."""
    if not len(corners_mm):
        return np.full(len(at_mm), np.inf)
    return np.asarray(np.abs(at_mm[:, None] - corners_mm[None, :]).min(axis=1))


def _turn_deg(before: Segment, after: Segment) -> float:
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    return math.degrees(abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by)))
