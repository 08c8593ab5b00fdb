"""Small nests made at random, the same for the same seed, with every shape that order rules are about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kerfwise.encoder.by_hand import circle, nest, part, rect
from kerfwise.encoder.nest import Nest, Part

PITCH = 110
SHAPES = ("plate", "marked", "ring", "disc", "host", "right", "up", "small")


def random_nest(rng: np.random.Generator, contours: int, least: int = 5) -> Nest:
    """Plates, rings, hosts with a guest, channels with a guest and marked plates, row after row of three."""
    parts: list[Part] = []
    while sum(len(list(p)) for p in parts) < min(least, contours):
        x, y = PITCH * (len(parts) % 3), PITCH * (len(parts) // 3)
        made = _shape(str(rng.choice(SHAPES)), f"P{len(parts)}", x + int(rng.integers(3, 12)), y + 5, rng)
        if sum(len(list(p)) for p in [*parts, *made]) <= contours:
            parts += made
    width, height = 3 * PITCH + int(rng.choice([0, 60, 300])), PITCH * (2 + (len(parts) > 6)) + int(rng.choice([0, 80]))
    return nest(width, height, *parts)


def _shape(shape: str, name: str, x: int, y: int, rng: np.random.Generator) -> list[Part]:
    w, h = int(rng.integers(70, 99)), int(rng.integers(70, 99))
    guest = part(f"{name}g", rect(x + 24, y + 24, 22, 22))
    u = [(0, 0), (w, 0), (w, 10), (10, 10), (10, h - 10), (w, h - 10), (w, h), (0, h)]
    match shape:
        case "plate":
            return [part(name, rect(x, y, w, h))]
        case "marked":
            return [part(name, rect(x, y, w, h), marks=[[(x + 9, y + 9), (x + 30, y + 9)]])]
        case "ring":
            return [part(name, rect(x, y, w, h), [rect(x + 12, y + 12, 20, 20), circle(x + 55, y + 50, 9)])]
        case "disc":
            return [part(name, circle(x + 40, y + 40, 38), [circle(x + 40, y + 40, 12)])]
        case "host":
            return [part(name, rect(x, y, w, h), [rect(x + 10, y + 10, 50, 50)]), guest]
        case "right":
            return [part(name, [(x + a, y + b) for a, b in u]), guest]
        case "up":
            return [part(name, [(x + b, y + a) for a, b in u][::-1]), guest]
        case _:
            return [part(name, rect(x, y, 30, 30)), part(f"{name}b", rect(x, y + 40, 30, 30))]


def trial_nest(seed: int, contours: int) -> Nest:
    """A nest of about so many contours; its parts have a priority, an order and a customer, and one may be a bar."""
    rng = np.random.default_rng([seed, 23])
    made = random_nest(rng, contours - 1)
    room = 2 * PITCH + 6
    parts = [*made.parts, *([part("Bar", rect(8, room, 100, 20))] if rng.random() < 0.7 else [])]
    known = [replace(p, attributes=_attributes(rng)) for p in parts]
    return nest(3 * PITCH + 60, room + 40, *known)


def _attributes(rng: np.random.Generator) -> dict[str, object]:
    priority, order = (int(rng.integers(1, most + 1)) for most in (3, 2))
    return {"priority": priority, "order": order, "customer": str(rng.choice(["A", "B"]))}
