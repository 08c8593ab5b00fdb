"""The middle of a slot, found from its wall by sections across it.

A first guess, square to the mouth or towards the farthest point of the wall, is straightened: sections across it give
points halfway between the two sides, and a line through those the next guess.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.segment import Point

STRAIGHT_MM = 0.02
"""The middle of a slot may leave a straight line by this much."""
_SECTIONS = 33
_ROUNDS = 6


@dataclass(frozen=True, eq=False, slots=True)
class Middle:
    """The straight middle of a slot: a point on it, and the unit vector into the slot.

    Lengths along it count from that point: where the mouth and the bottom lie, and sections across the slot (m,) with
    their widths.
    """

    origin: Floats
    along: Floats
    mouth_mm: float
    bottom_mm: float
    at_mm: Floats
    widths_mm: Floats

    @property
    def opening(self) -> float:
        """By how much it grows wider, a length along it."""
        return float(np.polyfit(self.at_mm, self.widths_mm, 1)[0])

    def narrowest_mm(self, until_mm: float) -> float:
        """The narrowest width up to a place along it."""
        slope, at_zero_mm = np.polyfit(self.at_mm, self.widths_mm, 1).tolist()
        there_mm = at_zero_mm + slope * max(until_mm, float(self.at_mm[0]))
        before = self.widths_mm[: max(int((self.at_mm <= until_mm).sum()), 1)]
        return max(min(float(before.min()), float(there_mm)), 0.0)

    def point(self, at_mm: float) -> Point:
        """A point of it."""
        x, y = (self.origin + at_mm * self.along).tolist()
        return x, y


def middle_of_slot(wall: Floats) -> Middle | None:
    """The straight middle of a slot with this wall (n, 2), a line from one side of its mouth to the other.

    None where there is none: of a slot that is bent, forked or wider behind its mouth on one side.

    Examples
    --------
    >>> found = middle_of_slot(np.array([(0.0, 10.0), (0.0, 0.0), (1.0, 0.0), (1.0, 10.0)]))
    >>> found.point(found.bottom_mm), found.narrowest_mm(found.bottom_mm)
    ((0.5, 0.0), 1.0)
    """
    origin, mouth = (wall[0] + wall[-1]) / 2, wall[-1] - wall[0]
    farthest = wall[np.argmax(np.hypot(*(wall - origin).T))]
    square = np.array([-mouth[1], mouth[0]]) * np.sign(
        mouth[0] * (farthest - origin)[1] - mouth[1] * (farthest - origin)[0]
    )
    for first in (square, farthest - origin):
        found = _straightened(wall, origin, _unit(first))
        if found is not None:
            return found
    return None


def _straightened(wall: Floats, origin: Floats, along: Floats) -> Middle | None:
    """The straight middle, found step by step from a first guess."""
    for _ in range(_ROUNDS):
        found = _sections(wall, origin, along)
        if found is None:
            return None
        at_mm, sides, mouth_mm, bottom_mm = found
        middle = sides.mean(axis=1)
        slope, offset = np.polyfit(at_mm, middle, 1)
        across = np.array([-along[1], along[0]])
        origin, along = origin + float(offset) * across, _unit(along + float(slope) * across)
    found = _sections(wall, origin, along)
    if found is None or float(np.abs(found[1].mean(axis=1)).max()) > STRAIGHT_MM:
        return None
    at_mm, sides, mouth_mm, bottom_mm = found
    return Middle(origin, along, mouth_mm, bottom_mm, at_mm, np.ptp(sides, axis=1))


def _sections(wall: Floats, origin: Floats, along: Floats) -> tuple[Floats, Floats, float, float] | None:
    """Sections of a slot across a line: where along it, the two sides, and where its mouth and its bottom are."""
    across = np.array([-along[1], along[0]])
    u, v = (wall - origin) @ along, (wall - origin) @ across
    bottoms = _crossings(v, u, 0.0)
    mouth_mm = float(max(u[0], u[-1]))
    if not len(bottoms) or (bottom_mm := float(bottoms.min())) <= mouth_mm:
        return None
    width_mm = float(abs(v[0] - v[-1]))
    far_mm = max(bottom_mm - width_mm, mouth_mm + 0.5 * (bottom_mm - mouth_mm))
    at_mm = np.linspace(mouth_mm, far_mm, _SECTIONS + 2)[1:-1]
    rows = [np.sort(_crossings(u, v, float(at))) for at in at_mm]
    if any(len(row) != 2 for row in rows):
        return None
    return at_mm, np.array(rows), mouth_mm, bottom_mm


def _crossings(x: Floats, y: Floats, at: float) -> Floats:
    """Where a line of points (x, y) passes `at` in x: the y there."""
    before, after = x[:-1] - at, x[1:] - at
    passes = (before < 0) != (after < 0)
    share = before[passes] / (before[passes] - after[passes])
    return np.asarray(y[:-1][passes] + share * (y[1:] - y[:-1])[passes])


def _unit(vector: Floats) -> Floats:
    return np.asarray(vector / max(math.hypot(*vector.tolist()), 1e-12))
