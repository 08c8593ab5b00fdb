"""Cutting feed by the length of the program: how fast a machine really cuts when its program has n blocks.

Tavaeva and Petunin measured that the feed of a laser machine is not the one that was set but falls with the number of
NC blocks. A plant states its own machine in the same two ways: by formulas for ranges of n, or by measured points.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kerfwise.rules.options.quantities import SPEED

LONGEST = 100_000
"""Blocks up to which a polynomial may hold: beyond it nothing has been measured."""


@dataclass(frozen=True, slots=True)
class LawPiece:
    """A formula for programs of up to `up_to` blocks, or, where that is None, of any more.

    Either `polynomial`, its coefficients from the constant up, or `power`, a factor and an exponent of n; the feed in
    the law's unit.
    """

    up_to: int | None
    polynomial: tuple[float, ...] = ()
    power: tuple[float, float] | None = None

    def at(self, blocks: float) -> float:
        """The formula's value at n = `blocks`, whatever range it is for."""
        if self.power is not None:
            return float(self.power[0] * blocks ** self.power[1])
        return float(sum(c * blocks**k for k, c in enumerate(self.polynomial)))


@dataclass(frozen=True, slots=True)
class FeedLaw:
    """V_on as a function of n, by `pieces` in ascending order of n or by `points` (n, mm/s), one of the two.

    `name` is that of a shipped law, "" for a plant's own; `unit` is the one that the formulas give. Between points the
    feed is interpolated, beyond the first and last it stays as it is there.

    Examples
    --------
    >>> FeedLaw(points=((10, 100.0), (20, 80.0))).mm_s(15)
    90.0
    >>> law = FeedLaw(unit="m/s", pieces=(LawPiece(70, (0.1,)), LawPiece(None, power=(0.2572, -0.222))))
    >>> law.mm_s(1), round(law.mm_s(120), 2)
    (100.0, 88.86)
    """

    name: str = ""
    source: str = ""
    unit: str = "mm/s"
    pieces: tuple[LawPiece, ...] = ()
    points: tuple[tuple[int, float], ...] = ()

    def mm_s(self, blocks: int) -> float:
        """The cutting feed of a program of so many blocks, mm/s."""
        if self.points:
            known, feeds = np.array(self.points).T
            return float(np.interp(blocks, known, feeds))
        piece = next(p for p in self.pieces if p.up_to is None or blocks <= p.up_to)
        return piece.at(max(blocks, 1)) * self.unit_mm_s

    @property
    def unit_mm_s(self) -> float:
        """The size of the formulas' unit, mm/s."""
        return float(SPEED.units[self.unit])

    @property
    def fastest_mm_s(self) -> float:
        """The fastest feed of any program, mm/s."""
        return max(self._marks())

    def wrong(self) -> str | None:
        """What keeps the law from giving a feed for every program, in words; None where nothing does."""
        if bool(self.pieces) == bool(self.points):
            return "give either points or pieces"
        ends = [n for n, _ in self.points] if self.points else [p.up_to for p in self.pieces[:-1]]
        if any(n is None for n in ends):
            return "only the last piece holds for all longer programs: give the others up_to"
        numbers = [n for n in ends if n is not None]
        if any(b <= a for a, b in pairwise(numbers)):
            return f"numbers of blocks are expected in ascending order, got {', '.join(map(str, numbers))}"
        if self.pieces:
            last = self.pieces[-1]
            falls = len(last.polynomial) == 1 if last.power is None else last.power[1] <= 0
            if last.up_to is not None or not falls:
                return (
                    "the last piece holds for all longer programs: expected a constant (polynomial: [0.1]) or a power "
                    "that does not rise, without up_to"
                )
        slowest = min(self._marks())
        return None if slowest > 0 else f"the feed must be over 0 for every n, it falls to {slowest:.6g} mm/s"

    def _marks(self) -> list[float]:
        """The feed at every n where it can be largest or smallest."""
        if self.points:
            return [v for _, v in self.points]
        found, first = [], 1
        for piece in self.pieces:
            last = first if piece.up_to is None else piece.up_to
            values = [piece.at(blocks) for blocks in range(first, last + 1)]
            found += [min(values), max(values)]
            first = last + 1
        return [v * self.unit_mm_s for v in found]
