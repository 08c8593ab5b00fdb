"""What a reader makes of a program: its burns as chains of points, and how far it moves otherwise."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

Point = tuple[float, float]


@dataclass(slots=True)
class Heard:
    """Burns as points, mm, arcs as chords; their lengths as the reader has them; the length of all other moves, mm.

    `powers` are the greatest power of each burn, where the reader knows of power. `over_tabs` says that it takes the
    way of the torch over a tab, unlit, for a part of the burn.
    """

    burns: list[list[Point]] = field(default_factory=list)
    lengths_mm: list[float] = field(default_factory=list)
    idle_mm: float = 0.0
    powers: list[float] = field(default_factory=list)
    over_tabs: bool = False


def length_mm(points: list[Point]) -> float:
    """Length of a chain of points."""
    return sum(math.dist(a, b) for a, b in pairwise(points))
