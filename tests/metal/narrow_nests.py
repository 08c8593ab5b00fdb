"""Made nests of plates and square holes with narrow slots: straight, leaning, round at the end, tapering."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from kerfwise.tests.metal.arcs import Floats

WIDTHS_MM = (0.1, 0.5, 0.8, 1.0, 1.2, 1.4, 1.45, 1.5, 2.0)
DEPTHS_MM = (0.7, 1.5, 3.0, 10.0, 20.0)
LEANS_DEG = (0, 0, 0, 15, -30, 40)
ENDS = ("flat", "flat", "round", "taper")


def narrow_nest(rnd: random.Random) -> dict[str, Any]:
    """One to three plates side by side, some with a hole, up to two slots in each."""
    parts: list[dict[str, Any]] = []
    gap_mm, x = rnd.choice([6.0, 10.0, 20.0]), 20.0
    for k in range(rnd.randint(1, 3)):
        wide, high = rnd.choice([80.0, 100.0, 140.0]), rnd.choice([80.0, 100.0])
        plate: dict[str, Any] = {"id": f"N{k}", "outer": _ring(rnd, x, 20, wide, high, 20.0, outer=True)}
        if wide >= 100 and high >= 100 and rnd.random() < 0.6:
            plate["holes"] = [_ring(rnd, x + wide / 2 - 15, 55, 30, 30, 3.0, outer=False)]
        parts.append(plate)
        x += wide + gap_mm
    sheet = {"width": x + 20, "height": 150}
    return {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}


def _ring(
    rnd: random.Random, x: float, y: float, wide: float, high: float, deepest: float, outer: bool
) -> list[list[float]]:
    """A rectangle with slots from the middle of one or two sides that are opposite to each other, into the part."""
    corners = [np.array(xy) for xy in ((x, y), (x + wide, y), (x + wide, y + high), (x, y + high))]
    first = rnd.randrange(4)
    sides = {first, (first + 2) % 4} if rnd.random() < 0.4 else {first}
    rows: list[list[float]] = []
    for k, (a, b) in enumerate(zip(corners, [*corners[1:], corners[0]], strict=True)):
        rows.append([*a.tolist()])
        if k in sides:
            along = (b - a) / np.hypot(*(b - a))
            into = np.array([-along[1], along[0]]) * (1 if outer else -1)
            rows += _slot(rnd, (a + b) / 2, along, into, deepest, -1.0 if outer else 1.0)
    return [[round(v, 4) for v in row] for row in rows]


def _slot(
    rnd: random.Random, mouth: Floats, along: Floats, into: Floats, deepest: float, bulge: float
) -> list[list[float]]:
    """Its points, from one edge of the mouth to the other; `bulge` is that of a round end."""
    wide, deep = rnd.choice(WIDTHS_MM), min(rnd.choice(DEPTHS_MM), deepest)
    lean, end = math.radians(rnd.choice(LEANS_DEG)), rnd.choice(ENDS)
    axis = math.cos(lean) * into + math.sin(lean) * along
    across = (math.cos(lean) * along - math.sin(lean) * into) * wide / 2 * (0.8 if end == "taper" else 1.0)
    edge, bottom = along * wide / 2 / math.cos(lean), mouth + deep * axis
    round_ = [bulge] if end == "round" else []
    far = [*(bottom - across).tolist(), *round_]
    return [(mouth - edge).tolist(), far, (bottom + across).tolist(), (mouth + edge).tolist()]
