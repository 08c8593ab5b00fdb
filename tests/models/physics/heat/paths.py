"""Torch paths made by hand: `from kerfwise.tests.models.physics.heat.paths import …`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.timed_path import in_order, torch_on

Points = Sequence[tuple[float, float]]


def along(points: Points, begin_s: float, end_s: float, pierce_s: float = 0.0) -> TimedPath:
    """One stretch along these points."""
    return in_order([torch_on("P.outer", np.array(points, dtype=float), begin_s, end_s, pierce_s)], end_s)


def rounds(corners: Sequence[Points], feed_mm_s: float, pause_s: float = 1.0) -> TimedPath:
    """Once round each of these, one after the other, with a pause before each."""
    now_s, burns = 0.0, []
    for k, ring in enumerate(corners):
        closed = np.array([*ring, ring[0]], dtype=float)
        length_mm = float(np.hypot(*np.diff(closed, axis=0).T).sum())
        begin_s = now_s + pause_s
        now_s = begin_s + length_mm / feed_mm_s
        burns.append(torch_on(f"P{k}.outer", closed, begin_s, now_s))
    return in_order(burns, now_s)


def beside(path: TimedPath, away_mm: tuple[float, float]) -> TimedPath:
    """What two torches burn that are so far apart: the path, and the same beside it at the same time."""
    burns = [one for burn in path.burns for one in (burn, burn.by(2, f"{burn.contour}'", away_mm))]
    return in_order(burns, path.end_s)


def circle(x: float, y: float, r: float, points: int = 90) -> Points:
    """Corners of a polygon that is nearly a circle."""
    turns = (math.tau * k / points for k in range(points))
    return [(x + r * math.cos(t), y + r * math.sin(t)) for t in turns]
