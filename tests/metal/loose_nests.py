"""Nests in which the kerfs of whole rounds meet around others: windmills of four bars, hooks shut by a bar, rings."""

from __future__ import annotations

import numpy as np

from kerfwise import Nest
from kerfwise.rule_kit import Part, nest, part, rect


def windmill(name: str, x: float, y: float, side: float, wide: float, gap: float) -> list[Part]:
    """Four bars round a square pocket, each a gap from the next."""
    return [
        part(f"{name}W", rect(x, y, wide, side - wide)),
        part(f"{name}N", rect(x, y + side - wide + gap, side - wide, wide - gap)),
        part(f"{name}E", rect(x + side - wide + gap, y + wide, wide - gap, side - wide)),
        part(f"{name}S", rect(x + wide + gap, y, side - wide - gap, wide - gap)),
    ]


def hook(name: str, x: float, y: float, side: float, wide: float, gap: float) -> list[Part]:
    """A channel that opens to the right, and a bar that shuts it."""
    s, w = side, wide
    u = [(x, y), (x + s, y), (x + s, y + w), (x + w, y + w), (x + w, y + s - w), (x + s, y + s - w), (x + s, y + s)]
    return [part(f"{name}U", [*u, (x, y + s)]), part(f"{name}B", rect(x + s + gap, y, wide, side))]


def enclosing(seed: int, kerf_mm: float, copies: int = 1, step_mm: float = 0.0) -> Nest:
    """One or two walls around a pocket, in each other or side by side, with one to three parts in each pocket.

    Gaps in the walls are from one kerf to a little over two: kerfs meet there, or just do not.
    """
    rnd = np.random.default_rng(seed)
    parts: list[Part] = []
    x = 25.0
    for n in range(int(rnd.integers(1, 3))):
        gap = float(kerf_mm * rnd.choice([1.05, 1.3, 1.6, 1.9, 2.0, 2.2]))
        wall = (windmill, hook)[int(rnd.integers(2))]
        side = float(rnd.integers(180, 260))
        parts += wall(f"{'AB'[n]}", x, 25.0, side, 30.0, gap)
        room = side - 2 * 30.0 - 2 * 18.0
        many = int(rnd.integers(1, 4))
        wide = (room - 16.0 * (many - 1)) / many
        if rnd.random() < 0.3:
            inner = windmill if rnd.random() < 0.5 else hook
            parts += inner(f"{'AB'[n]}i", x + 52.0, 77.0, room - 40.0, 12.0, gap)
        else:
            boxes = [(x + 48.0 + k * (wide + 16.0), 73.0, wide, room) for k in range(many)]
            holes = [
                [rect(x + wide / 2 - 6, y + 20, 12, 12)] if wide > 30 and k == 0 else []
                for k, (x, y, *_) in enumerate(boxes)
            ]
            parts += [
                part(f"{'AB'[n]}{k}", rect(*box), hole) for k, (box, hole) in enumerate(zip(boxes, holes, strict=True))
            ]
        x += side + 70.0
    return nest(x, 310.0, *parts)
