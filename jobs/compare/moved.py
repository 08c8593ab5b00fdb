"""Which cuts are made elsewhere in the order, begun at another place, or run the other way round."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from kerfwise.encoder.cut import Cut, CutSequence, Tab

ENTRY_MM = 0.01
"""Places nearer than this, and lengths that differ by less, are the same: programs write decimals."""


@dataclass(frozen=True, slots=True)
class CutPair:
    """One contour in both: its positions, from 1, and what differs.

    `moved` is a cut that changed places with others that stay in order; `entry_mm` is how far its entry moved, 0 where
    it is the same. `lead` is said of a cut that is pierced, led in or led out otherwise from the same entry. `a` or `b`
    is None where that side does not cut it.
    """

    contour: str
    a: int | None
    b: int | None
    moved: bool = False
    entry_mm: float = 0.0
    turned: bool = False
    linked: bool = False
    lead: bool = False
    tabs: bool = False

    @property
    def same(self) -> bool:
        """Whether nothing but its position's number differs."""
        differs = self.moved or self.entry_mm or self.turned or self.linked or self.lead or self.tabs
        return None not in (self.a, self.b) and not differs

    @property
    def told(self) -> str:
        """What differs, in words."""
        if self.b is None:
            return "in A only"
        if self.a is None:
            return "in B only"
        return ", ".join(
            [
                *(["moved"] if self.moved else []),
                *([f"entry {self.entry_mm:.1f} mm away"] if self.entry_mm else []),
                *(["other way round"] if self.turned else []),
                *(["linked in one only"] if self.linked else []),
                *(["another lead"] if self.lead else []),
                *(["other tabs"] if self.tabs else []),
            ]
        )

    def as_json(self) -> dict[str, Any]:
        """The same as data; `position_a` and `position_b` are null where a side does not cut it."""
        return {
            "contour": self.contour,
            "position_a": self.a,
            "position_b": self.b,
            "moved": self.moved,
            "entry_mm": round(self.entry_mm, 3),
            "other_direction": self.turned,
            "linked_in_one_only": self.linked,
            "other_lead": self.lead,
            "other_tabs": self.tabs,
        }


def cut_pairs(first: CutSequence, second: CutSequence) -> tuple[CutPair, ...]:
    """Every contour that either cuts, in the order of the first, then what only the second cuts.

    The fewest cuts are taken as moved: all others follow each other alike in both.
    """
    a, b = _by_contour(first), _by_contour(second)
    kept = set(longest_rising([b[name][0] for name in a if name in b]))
    pairs = [
        _pair(cut, position, *b[name], kept) if name in b else CutPair(cut.contour, position, None)
        for name, (position, cut) in a.items()
    ]
    pairs += [CutPair(cut.contour, None, position) for name, (position, cut) in b.items() if name not in a]
    return tuple(pairs)


def _pair(cut: Cut, position: int, there: int, other: Cut, kept: Collection[int]) -> CutPair:
    away_mm = math.dist(cut.entry, other.entry)
    entry_mm = away_mm if away_mm > ENTRY_MM else 0.0
    turned, linked = cut.direction != other.direction, cut.linked != other.linked
    lead = not (entry_mm or turned or cut.linked or other.linked) and not _led_alike(cut, other)
    return CutPair(
        cut.contour, position, there, there not in kept, entry_mm, turned, linked, lead, not _held_alike(cut, other)
    )


def _led_alike(cut: Cut, other: Cut) -> bool:
    """Whether both begin in one place, and their leads are as long; what leads a linked cut in depends on the order."""
    leads = ((cut.lead_in, other.lead_in), (cut.lead_out, other.lead_out))
    lengths_mm = [[0.0 if lead is None else lead.length_mm for lead in pair] for pair in leads]
    return math.dist(cut.pierce, other.pierce) <= ENTRY_MM and all(abs(a - b) <= ENTRY_MM for a, b in lengths_mm)


def _held_alike(cut: Cut, other: Cut) -> bool:
    """Whether both leave the same tabs."""
    return len(cut.tabs) == len(other.tabs) and all(any(_alike(a, b) for b in other.tabs) for a in cut.tabs)


def _alike(tab: Tab, other: Tab) -> bool:
    return math.dist(tab.at, other.at) <= ENTRY_MM and abs(tab.width_mm - other.width_mm) <= ENTRY_MM


def _by_contour(cuts: CutSequence) -> dict[tuple[str, int], tuple[int, Cut]]:
    """Contour id, and 2 where a program cuts it a second time, → position and cut."""
    times = Counter[str]()
    found: dict[tuple[str, int], tuple[int, Cut]] = {}
    for position, cut in enumerate(cuts, 1):
        times[cut.contour] += 1
        found[cut.contour, times[cut.contour]] = position, cut
    return found


def longest_rising(numbers: Sequence[int]) -> list[int]:
    """A longest subsequence that rises, of numbers that are all different.

    Examples
    --------
    >>> longest_rising([1, 2, 5, 3, 4])
    [1, 2, 3, 4]
    """
    ends: list[int] = []  # the least last number of a rising row of each length
    at: list[int] = []  # the place of that number
    before: list[int] = []
    for k, number in enumerate(numbers):
        length = bisect_left(ends, number)
        before.append(at[length - 1] if length else -1)
        ends[length : length + 1], at[length : length + 1] = [number], [k]
    row, k = [], at[-1] if at else -1
    while k >= 0:
        row.append(numbers[k])
        k = before[k]
    return row[::-1]
