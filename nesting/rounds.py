"""Rounds of filling sheets, each in another order and taste; what they found is combined, and the best layout stays."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Literal, get_args

from .allot import Layout, allot
from .cover import Patterns
from .fill import PAVLOV, TASTES, Taste, by_size
from .purchase import Purchase
from .shapes import Shapes
from .squeeze import squeezed
from .wanted import Spacing, Wanted

Told = Callable[[int, Layout], bool]
"""Called after each round with its number and the best layout so far; whether to go on."""
Method = Literal["own", "pavlov"]
METHODS: tuple[Method, ...] = get_args(Method)
"""own: all tastes. pavlov: the least rectangle around all, and blocks by the defining line."""
_PRICED = 3
"""Every so many rounds, sheets are filled by what the cover of all patterns would pay for each part."""
_LOOK_SHARE = 0.8
"""Share of a limit in seconds that rounds have; the rest is for the cover, and for the last sheet."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How long to look: so many rounds, or so many seconds where they are given; `seed` decides the random orders."""

    rounds: int = 12
    time_s: float | None = None
    seed: int = 1
    method: Method = "own"


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
    """The layouts of all rounds, the best first, each once: see `best_layout`.

    Once `stopped`, a round breaks off: what lies there after a broken first round is told as it is, parts missing.
    """
    look = _Look(wanted, spacing, effort, stopped)
    for number, (order, taste) in enumerate(_ways(look.shapes, effort), 1):
        look.round(number, order, taste)
        if not told(number, look.best) or stopped() or look.over():
            break
    if not stopped():
        look.finish(effort.rounds)
    return sorted(look.found.values(), key=lambda layout: layout.score)


class _Look:
    """What was found so far."""

    def __init__(self, wanted: Wanted, spacing: Spacing, effort: Effort, stopped: Callable[[], bool]) -> None:
        self.shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
        self.found: dict[tuple[object, ...], Layout] = {}
        self._wanted, self._spacing, self._effort, self._stopped = wanted, spacing, effort, stopped
        now = time.monotonic()
        self._ends = None if effort.time_s is None else now + effort.time_s * _LOOK_SHARE
        self._last = None if effort.time_s is None else now + effort.time_s
        self._purchase = Purchase(wanted, self.shapes, spacing)
        self._patterns = Patterns(wanted, self.shapes, spacing)
        self._best: Layout | None = None

    @property
    def best(self) -> Layout:
        """The best layout so far; one with nothing laid before the first round."""
        return Layout(self._wanted, self._spacing, ()) if self._best is None else self._best

    def over(self) -> bool:
        """Whether the time is over."""
        return self._ends is not None and time.monotonic() >= self._ends

    def _going(self) -> bool:
        return not self._stopped() and (self._best is None or not self.over())

    def round(self, number: int, order: list[int], taste: Taste) -> None:
        """Fill sheets once, or fill those that the cover misses most."""
        if number % _PRICED == 0 and self._patterns.worth_pricing(self.best):
            self._patterns.price(taste, self._going)
            self._keep(self._patterns.cover(self.best, self._effort.seed), "patterns")
            return
        buy = self._purchase.next(self._best)
        seen = self._patterns.add
        made = allot(self._wanted, self.shapes, self._spacing, order, taste, self._going, buy=buy, seen=seen)
        self._keep(made, f"round {number}")

    def finish(self, tries: int) -> None:
        """Combine what all rounds laid, and lay the last sheet so that the largest rectangle is left."""

        def going() -> bool:
            return not self._stopped() and (self._last is None or time.monotonic() < self._last)

        self._keep(self._patterns.cover(self.best, self._effort.seed), "patterns")
        if self.shapes.common is None:  # blocks with common edges would break up where they are in the way
            self._keep(squeezed(self.best, self.shapes, tries, self._effort.seed, going), "squeezed")

    def _keep(self, made: Layout, by: str) -> None:
        if made.alike not in self.found:
            made = replace(made, by=by if self._effort.method == "own" else f"{self._effort.method}, {by}")
            self.found[made.alike] = made
            if self._best is None or made.score < self._best.score:
                self._best = made


def _ways(shapes: Shapes, effort: Effort) -> Iterator[tuple[list[int], Taste]]:
    """Orders and tastes: largest area first, longest first, then such orders shuffled a little."""
    kinds, chance = range(len(shapes.types)), random.Random(effort.seed)
    plain = by_size(shapes, kinds)
    boxes = [shapes.types[k].part.outer.polygon.bounds for k in kinds]
    longest = [max(x1 - x0, y1 - y0) for x0, y0, x1, y1 in boxes]
    tastes: tuple[Taste, ...] = TASTES if effort.method == "own" else PAVLOV
    if shapes.common is not None:  # edges that can be cut once are to lie a kerf apart
        tastes = tuple(dict.fromkeys(replace(taste, blocks=True) for taste in tastes))
    rounds = effort.rounds if effort.time_s is None else 1_000_000
    for number in range(rounds):
        taste = tastes[number % len(tastes)]
        if number < len(tastes):
            yield plain, taste
        elif number < 2 * len(tastes):
            yield sorted(plain, key=lambda k: (shapes.types[k].priority, -longest[k], k)), taste
        else:
            weight = {k: (shapes.types[k].area_mm2 ** 0.5) * chance.uniform(0.6, 1.4) for k in plain}
            yield sorted(plain, key=lambda k: (shapes.types[k].priority, -weight[k], k)), taste
