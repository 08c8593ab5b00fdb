"""Random blocks of rectangles that stand one kerf apart: grids, staggered rows, and edges of three parts in a T."""

from __future__ import annotations

import numpy as np

from kerfwise import Nest
from kerfwise.rule_kit import Part, circle, nest, part, rect

Box = tuple[float, float, float, float]
"""Left, lower, wide, high, mm."""

_EDGE_MM = 40.0


def block(rng: np.random.Generator, parts: int, kerf_mm: float, holes: bool = False) -> Nest:
    """A rectangle split again and again, with a kerf between all parts; some blocks have a gap where a part was."""
    wide, high = (float(rng.integers(120, 260)) for _ in range(2))
    boxes: list[Box] = [(_EDGE_MM, _EDGE_MM, wide, high)]
    gap = bool(rng.random() < 0.4)
    while len(boxes) < parts + gap:
        k = max(range(len(boxes)), key=lambda k: boxes[k][2] * boxes[k][3])
        boxes += _halves(rng, boxes.pop(k), kerf_mm)
    gone = int(rng.integers(len(boxes))) if gap else -1
    kept = [box for k, box in enumerate(sorted(boxes)) if k != gone]
    made = [_part(f"P{k}", box, holes and rng.random() < 0.4) for k, box in enumerate(kept, 1)]
    return nest(wide + 2 * _EDGE_MM, high + 2 * _EDGE_MM, *made)


def grid(columns: int, rows: int, kerf_mm: float, wide_mm: float = 100.0, high_mm: float = 60.0) -> Nest:
    """Equal rectangles in rows, one kerf apart."""
    step_x, step_y = wide_mm + kerf_mm, high_mm + kerf_mm
    parts = [
        part(f"P{row * columns + k + 1}", rect(_EDGE_MM + k * step_x, _EDGE_MM + row * step_y, wide_mm, high_mm))
        for row in range(rows)
        for k in range(columns)
    ]
    return nest(columns * step_x + 2 * _EDGE_MM, rows * step_y + 2 * _EDGE_MM, *parts)


def _halves(rng: np.random.Generator, box: Box, kerf_mm: float) -> list[Box]:
    x, y, wide, high = box
    share = float(rng.choice([0.35, 0.5, 0.62]))
    if wide >= high:
        first = round((wide - kerf_mm) * share, 1)
        return [(x, y, first, high), (x + first + kerf_mm, y, wide - first - kerf_mm, high)]
    first = round((high - kerf_mm) * share, 1)
    return [(x, y, wide, first), (x, y + first + kerf_mm, wide, high - first - kerf_mm)]


def _part(name: str, box: Box, hole: bool) -> Part:
    x, y, wide, high = box
    radius = min(wide, high) / 5
    return part(name, rect(x, y, wide, high), [circle(x + wide / 2, y + high / 2, radius)] if hole else [])
