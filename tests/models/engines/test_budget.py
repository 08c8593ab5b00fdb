"""What may be spent: work, seconds by the clock, and shares of both."""

from __future__ import annotations

import math

import pytest

from kerfwise.models.engines.solution import Budget, SolveOptions


def test_work_is_counted_in_operations() -> None:
    budget = Budget(work=2.0, per_s=100.0)
    budget.spend(50)
    assert (budget.spent, budget.left, budget.share_spent, budget.timed) == (0.5, 1.5, 0.25, False)
    mark = budget.mark()
    budget.spend(30)
    assert budget.times(mark) == 4.0


def test_the_clock_counts_by_itself_and_what_is_spent_first_counts() -> None:
    now = 0.0
    budget = Budget(work=10.0, time_s=8.0, clock=lambda: now)
    budget.spend(3.0)
    assert (budget.left, budget.share_spent) == (7.0, 0.3)
    now = 6.0
    assert (budget.left, budget.share_spent) == (2.0, 0.75)
    assert budget.part(0.5).left == 1.0
    now = 9.0
    assert budget.left == -1.0


def test_a_part_leaves_the_whole_alone() -> None:
    budget = Budget(work=2.0, per_s=10.0)
    part = budget.part(0.5)
    part.spend(4)
    assert (part.left, budget.left) == (pytest.approx(0.6), 2.0)


@pytest.mark.parametrize(("time_s", "left"), [(None, 30.0), (5.0, 5.0)])
def test_where_seconds_are_limited_work_is_not(time_s: float | None, left: float) -> None:
    budget = Budget.of(SolveOptions(work=30.0, time_s=time_s))
    assert budget.left == pytest.approx(left, abs=1.0)
    budget.spend(29.5)
    assert budget.left == pytest.approx(left if time_s else 0.5, abs=1.0)
    assert math.isfinite(budget.left)
