"""The figures of two sides, and which cuts are made elsewhere, begun elsewhere, or run the other way."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from kerfwise.encoder.cut import Cut, CutSequence, Tab
from kerfwise.postproc.report.legend import clock_text

from .sides import Side

# The figures of two sides: lengths, pierces, times, cost and heat.

Unit = Literal["m", "mm", "count", "s", "money", "C"]


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of both sides; None where a side does not have it. Lengths are in mm, times in s.

    Examples
    --------
    >>> figure = Figure("idle_mm", "idle travel", "m", 4000.0, 3000.0)
    >>> figure.texts
    ('4.000 m', '3.000 m', '-25.0%')
    """

    key: str
    label: str
    unit: Unit
    a: float | None
    b: float | None
    currency: str = ""

    @property
    def texts(self) -> tuple[str, str, str]:
        """Both for people, and the change from A to B."""
        return self._text(self.a), self._text(self.b), self._change()

    def as_json(self) -> dict[str, Any]:
        """Both as numbers."""
        a, b = (None if value is None else round(value, 4) for value in (self.a, self.b))
        return {"a": a, "b": b} | ({"currency": self.currency} if self.currency else {})

    def _text(self, value: float | None) -> str:
        if value is None:
            return "-"
        match self.unit:
            case "m":
                return f"{value / 1000:.3f} m"
            case "mm":
                return f"{value:.2f} mm"
            case "count":
                return f"{value:.0f}"
            case "s":
                return clock_text(value)
            case "C":
                return f"{value:.0f} °C"
            case "money":
                return f"{value:.2f} {self.currency}"

    def _change(self) -> str:
        if self.a is None or self.b is None or self._text(self.a) == self._text(self.b):
            return ""
        if self.unit == "C":
            return f"{self.b - self.a:+.0f} °C"
        if self.unit == "count" or self.a <= 0:
            return f"{self.b - self.a:+g}" if self.unit == "count" else ""
        return f"{(self.b - self.a) / self.a:+.1%}"


def figures(a: Side, b: Side) -> tuple[Figure, ...]:
    """Every figure that one of them has, measured alike on plans and programs."""
    return tuple(_figures(a, b))


def _figures(a: Side, b: Side) -> Iterator[Figure]:
    jobs, reports = (a.times.timed.job, b.times.timed.job), (a.times.report, b.times.report)
    yield Figure("cut_mm", "torch on", "m", jobs[0].on_mm, jobs[1].on_mm)
    yield Figure("idle_mm", "idle travel", "m", jobs[0].idle_mm, jobs[1].idle_mm)
    yield Figure("pierces", "pierces", "count", jobs[0].pierces, jobs[1].pierces)
    yield Figure("time_s", "time", "s", reports[0].total_s, reports[1].total_s)
    for key, label in (("cut_s", "  cutting"), ("idle_s", "  travelling"), ("pierce_s", "  piercing"),
                       ("dwell_s", "  waiting")):  # fmt: skip
        first, second = (getattr(report, key) for report in reports)
        if first or second:
            yield Figure(key, label, "s", first, second)
    yield from _costs(a, b)
    objectives = [None if side.plan is None else side.plan.solve.objective - side.plan.heavy_mm for side in (a, b)]
    if any(value is not None for value in objectives):
        yield Figure("objective_mm", "objective", "m", objectives[0], objectives[1])
    excuses = [sum(len(judged.excused) for judged in side.verdict.rules) for side in (a, b)]
    if any(excuses):
        yield Figure("excuses", "places not kept", "count", excuses[0], excuses[1])
    if a.heat is not None and b.heat is not None:
        yield Figure("peak_c", "hottest", "C", a.heat.peak_c, b.heat.peak_c)
        yield Figure("overheats", "overheats", "count", a.heat.overheats, b.heat.overheats)


def _costs(a: Side, b: Side) -> Iterator[Figure]:
    first, second = a.times.cost, b.times.cost
    currencies = {cost.currency for cost in (first, second) if cost is not None}
    if len(currencies) == 1:
        totals = [None if cost is None else cost.total for cost in (first, second)]
        currency = currencies.pop()
        yield Figure("cost", "cost", "money", totals[0], totals[1], currency)
        parts = [{} if cost is None else dict(cost.parts) for cost in (first, second)]
        for name in dict.fromkeys([*parts[0], *parts[1]]):
            yield Figure(f"cost_{name}", f"  {name}", "money", parts[0].get(name), parts[1].get(name), currency)


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
