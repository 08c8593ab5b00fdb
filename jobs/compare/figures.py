"""The figures of two sides: lengths, pierces, times, cost and heat."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

from kerfwise.jobs.resequence_table import clock_text

from .side import Side

Unit = Literal["m", "count", "s", "money", "C"]


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
        yield Figure("excuses", "excuses", "count", excuses[0], excuses[1])
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
