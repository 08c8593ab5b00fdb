"""Rounds of filling sheets, each in another order and taste; the best layout stays."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from .allot import Layout, allot
from .fill import TASTES, Taste, by_size
from .purchase import Purchase
from .shapes import Shapes
from .wanted import Spacing, Wanted

Told = Callable[[int, Layout], bool]
"""Called after each round with its number and the best layout so far; whether to go on."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How long to look: so many rounds, or so many seconds where they are given; `seed` decides the random orders."""

    rounds: int = 12
    time_s: float | None = None
    seed: int = 1


def best_layout(wanted: Wanted, spacing: Spacing, effort: Effort, told: Told = lambda n, best: True) -> Layout:
    """The best layout of all rounds: the same list, spacing, rounds and seed give the same one.

    A limit in seconds ends the look wherever it is; the first round is always finished.
    """
    return layouts(wanted, spacing, effort, told)[0]


def layouts(
    wanted: Wanted,
    spacing: Spacing,
    effort: Effort,
    told: Told = lambda n, best: True,
    stopped: Callable[[], bool] = lambda: False,
) -> list[Layout]:
    """The layouts of all rounds, the best first, each once: see `best_layout`. Once `stopped`, a round breaks off."""
    shapes = Shapes(wanted.types, spacing.gap_mm)
    found: list[Layout] = []
    ends = None if effort.time_s is None else time.monotonic() + effort.time_s
    best: Layout | None = None
    purchase = Purchase(wanted, shapes, spacing)
    for number, (order, taste) in enumerate(_ways(shapes, effort), 1):

        def going() -> bool:
            over = stopped() or (ends is not None and time.monotonic() >= ends)
            return best is None or not over  # noqa: B023 - called in this round only

        made = allot(wanted, shapes, spacing, order, taste, going, buy=purchase.next(best))
        if all(made.alike != other.alike for other in found):
            found.append(made)
        if best is None or made.score < best.score:
            best = made
        if not told(number, best) or (ends is not None and time.monotonic() >= ends):
            break
    return sorted(found, key=lambda layout: layout.score)


def _ways(shapes: Shapes, effort: Effort) -> Iterator[tuple[list[int], Taste]]:
    """Orders and tastes: largest area first, longest first, then such orders shuffled a little."""
    kinds, chance = range(len(shapes.types)), random.Random(effort.seed)
    plain = by_size(shapes, kinds)
    boxes = [shapes.types[k].part.outer.polygon.bounds for k in kinds]
    longest = [max(x1 - x0, y1 - y0) for x0, y0, x1, y1 in boxes]
    rounds = effort.rounds if effort.time_s is None else 1_000_000
    for number in range(rounds):
        taste = TASTES[number % len(TASTES)]
        if number < len(TASTES):
            yield plain, taste
        elif number < 2 * len(TASTES):
            yield sorted(plain, key=lambda k: (shapes.types[k].priority, -longest[k], k)), taste
        else:
            weight = {k: (shapes.types[k].area_mm2 ** 0.5) * chance.uniform(0.6, 1.4) for k in plain}
            yield sorted(plain, key=lambda k: (shapes.types[k].priority, -weight[k], k)), taste
