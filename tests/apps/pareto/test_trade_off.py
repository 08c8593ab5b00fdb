"""Which plans no other beats."""

from __future__ import annotations

from typing import cast

from hypothesis import given
from hypothesis import strategies as st

from kerfwise.apps.pareto.pareto import Trade, front
from kerfwise.models.plan.plan import Totals
from kerfwise.pipeline import VerifiedPlan


class _Made:
    def __init__(self, idle_mm: float, ok: bool = True) -> None:
        self.verdict, self.ok = self, ok
        self.plan = self
        self.totals = Totals(0.0, idle_mm, 0, 0.0, 0.0)


def trade(price_mm: float, overheats: int, idle_mm: float, ok: bool = True, off_mm: float | None = None) -> Trade:
    return Trade(price_mm, cast(VerifiedPlan, _Made(idle_mm, ok)), overheats, 0.0, off_mm)


def test_beaten_plans_and_the_second_of_equals_are_not_on_the_front() -> None:
    cheap, even, dear, beaten, twin = (
        trade(0, 90, 1000), trade(10, 60, 1200), trade(30, 50, 2000), trade(100, 70, 1500), trade(300, 60, 1200),
    )  # fmt: skip
    assert front([dear, twin, beaten, even, cheap]) == [cheap, even, dear]
    assert front([]) == []


def test_a_plan_that_the_check_refuses_is_not_on_the_front() -> None:
    lawful, unlawful = trade(0, 90, 1000), trade(10, 1, 500, ok=False)
    assert front([unlawful, lawful]) == [lawful]


def test_a_plan_with_straighter_parts_is_on_the_front_though_it_travels_more() -> None:
    short, straight, beaten = (
        trade(0, 5, 1000, off_mm=0.3),
        trade(0, 5, 2000, off_mm=0.1),
        trade(9, 5, 2100, off_mm=0.2),
    )
    assert front([beaten, straight, short]) == [short, straight]


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9), st.integers(0, 9)), max_size=12))
def test_the_front_is_what_nothing_beats(points: list[tuple[int, int, int]]) -> None:
    trades = [trade(k, hot, float(idle), off_mm=float(off)) for k, (hot, idle, off) in enumerate(points)]
    kept = front(trades)
    for one, point in zip(trades, points, strict=True):
        beaten = any(all(a <= b for a, b in zip(other, point, strict=True)) and other != point for other in points)
        same = any((k.overheats, k.idle_mm, k.off_mm) == (one.overheats, one.idle_mm, one.off_mm) for k in kept)
        assert same is not beaten
