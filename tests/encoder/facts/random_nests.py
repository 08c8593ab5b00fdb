"""Random small nests for properties, and nests moved and mirrored."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import strategies as st

from kerfwise import Nest
from kerfwise.rule_kit import Contour, Curve, Part, Sheet, circle, nest, part, rect

PITCH = 120


@st.composite
def nests(draw: st.DrawFn) -> Nest:
    """Parts on a grid of cells: plates, discs, brackets, channels and frames with a guest; whole millimetres."""
    columns, rows = draw(st.integers(1, 4)), draw(st.integers(1, 3))
    parts: list[Part] = []
    for column in range(columns):
        for row in range(rows):
            x, y = PITCH * column + draw(st.integers(1, 20)), PITCH * row + draw(st.integers(1, 20))
            parts += _cell(f"P{column}{row}", x, y, draw)
    return nest(PITCH * columns + draw(st.integers(0, 200)), PITCH * rows + draw(st.integers(0, 50)), *parts)


def _cell(name: str, x: int, y: int, draw: st.DrawFn) -> list[Part]:
    w, h = draw(st.integers(40, 98)), draw(st.integers(40, 98))
    match draw(st.sampled_from(["none", "plate", "disc", "bracket", "channel", "frame"])):
        case "plate":
            return [part(name, rect(x, y, w, h), marks=[[(x + 5, y + 5), (x + 30, y + 20)]])]
        case "disc":
            return [part(name, circle(x + w / 2, y + w / 2, w / 2), [circle(x + w / 2, y + w / 2, w / 6)])]
        case "bracket":
            return [part(name, [(x, y), (x + w, y), (x + w, y + 12), (x + 12, y + 12), (x + 12, y + h), (x, y + h)])]
        case "channel":
            return [part(name, _channel(x, y, w, h, draw)), part(f"{name}g", rect(x + 15, y + 15, w - 30, h - 30))]
        case "frame":
            guest = part(f"{name}g", rect(x + 12, y + 12, w - 24, h - 24))
            return [part(name, rect(x, y, w, h), [rect(x + 10, y + 10, w - 20, h - 20)]), guest]
    return []


def _channel(x: int, y: int, w: int, h: int, draw: st.DrawFn) -> Any:
    x2, y2 = x + w, y + h
    match draw(st.sampled_from(["right", "left", "top", "bottom"])):
        case "right":
            inner = [(x2, y), (x2, y + 10), (x + 10, y + 10), (x + 10, y2 - 10), (x2, y2 - 10), (x2, y2)]
            return [(x, y), *inner, (x, y2)]
        case "left":
            inner = [(x, y2), (x, y2 - 10), (x2 - 10, y2 - 10), (x2 - 10, y + 10), (x, y + 10), (x, y)]
            return [(x2, y), (x2, y2), *inner]
        case "top":
            inner = [(x2, y2), (x2 - 10, y2), (x2 - 10, y + 10), (x + 10, y + 10), (x + 10, y2), (x, y2)]
            return [(x, y), (x2, y), *inner]
        case _:
            inner = [(x, y), (x + 10, y), (x + 10, y2 - 10), (x2 - 10, y2 - 10), (x2 - 10, y), (x2, y)]
            return [*inner, (x2, y2), (x, y2)]


def moved(original: Nest, dx_mm: float, dy_mm: float) -> Nest:
    """The whole nest, sheet and all, shifted."""
    return _mapped(original, lambda curve: curve.moved(dx_mm, dy_mm))


def mirrored(original: Nest) -> Nest:
    """Left and right exchanged; every curve keeps its first point."""
    xmin, _, xmax, _ = original.sheet.bounds
    return _mapped(
        original, lambda c: Curve(c.vertices * np.array([-1.0, 1.0, -1.0]) + np.array([xmin + xmax, 0, 0]), c.closed)
    )


def _mapped(original: Nest, change: Callable[[Curve], Curve]) -> Nest:
    def contour(c: Contour) -> Contour:
        return Contour(c.id, c.part, c.kind, change(c.curve))

    parts = [
        Part(p.id, contour(p.outer), tuple(map(contour, p.holes)), tuple(map(contour, p.marks))) for p in original.parts
    ]
    return Nest(Sheet(change(original.sheet.outline), tuple(map(change, original.sheet.holes))), tuple(parts))
