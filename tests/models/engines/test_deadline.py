"""How long something may go on: work, seconds by the clock, parts of both, and when a solve stops."""

from __future__ import annotations

import math

import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import SolveOptions


def test_work_is_counted_in_operations() -> None:
    deadline = Deadline(work=2.0, per_s=100.0)
    deadline.spend(50)
    assert (deadline.spent, deadline.left, deadline.timed) == (0.5, 1.5, False)
    mark = deadline.mark()
    deadline.spend(30)
    assert deadline.times(mark) == 4.0


def test_the_clock_counts_by_itself_and_what_is_spent_first_counts() -> None:
    now = 0.0
    deadline = Deadline(work=10.0, time_s=8.0, clock=lambda: now)
    deadline.spend(3.0)
    assert deadline.left == 7.0
    now = 6.0
    assert deadline.left == 2.0
    assert deadline.part(0.5).left == 1.0
    now = 9.0
    assert deadline.left == -1.0


def test_a_part_leaves_the_whole_alone() -> None:
    deadline = Deadline(work=2.0, per_s=10.0)
    part = deadline.part(0.5)
    part.spend(4)
    assert (part.left, deadline.left) == (pytest.approx(0.6), 2.0)


@pytest.mark.parametrize(("time_s", "left"), [(None, 30.0), (5.0, 5.0)])
def test_where_seconds_are_limited_work_is_not(time_s: float | None, left: float) -> None:
    deadline = Deadline.of(SolveOptions(work=30.0, time_s=time_s))
    assert deadline.left == pytest.approx(left, abs=1.0)
    deadline.spend(29.5)
    assert deadline.left == pytest.approx(left if time_s else 0.5, abs=1.0)
    assert math.isfinite(deadline.left)


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_time_limit() -> None:
    clock = Clock()
    deadline = Deadline.of(SolveOptions(time_s=2.0), clock=clock)
    assert deadline("search", None, None)
    clock.now = 1.9
    assert deadline("search", 5, None)
    clock.now = 2.0
    assert not deadline("search", 5, None)
    part = deadline.within(9.0)
    assert not part("search", 5, None), "whatever a part has, it ends with the whole"
    assert part.stopped


def test_a_part_has_as_many_seconds_as_work_where_they_count() -> None:
    clock = Clock()
    whole = Deadline(time_s=9.0, clock=clock)
    one, other = whole.within(2.0, most_bytes=7.0), whole.counting(2.0, per_s=10.0)
    assert (one.time_s, one.most_bytes, other.time_s) == (2.0, 7.0, None)
    assert other.within(1.0).time_s == 1.0
    assert Deadline(9.0).within(2.0).time_s is None
    clock.now = 3.0
    assert not one("search", None, None)
    assert other("search", None, None)


def test_gap_joins_what_different_engines_found() -> None:
    deadline = Deadline.of(SolveOptions(gap=0.05))
    assert deadline("search", 100, None)
    assert deadline("cp-sat", None, 94)
    assert not deadline("search", 98, None)


def test_a_bound_without_a_plan_is_no_reason_to_stop() -> None:
    assert Deadline.of(SolveOptions(gap=0.5))("cp-sat", None, 10)


def test_no_improvement_counts_from_the_last_better_plan() -> None:
    clock = Clock()
    deadline = Deadline.of(SolveOptions(no_improvement_s=1.0), clock=clock)
    clock.now = 5.0
    assert deadline("search", None, None), "there is no plan yet that could be taken"
    assert deadline("search", 10, None)
    clock.now = 5.9
    assert deadline("search", 9, None)
    clock.now = 6.8
    assert deadline("search", 9, None)
    clock.now = 6.9
    assert not deadline("search", 9, None)


def test_once_stopped_it_stays_stopped() -> None:
    answers = iter([False, True])
    deadline = Deadline.of(SolveOptions(), lambda engine, cost_um, bound_um: next(answers))
    assert not deadline("search", None, None)
    assert not deadline("search", None, None)


def test_another_problem_begins_without_costs() -> None:
    deadline = Deadline.of(SolveOptions(gap=0.0))
    deadline("ideals", 7, None)
    deadline.begin()
    assert deadline("ideals", None, 7)
    assert deadline("ideals", 8, 7)


def test_a_preview_is_told_and_counts_for_nothing_else() -> None:
    clock, told = Clock(), list[tuple[int | None, int | None]]()

    def listen(engine: str, cost: int | None, bound: int | None) -> bool:
        told.append((cost, bound))
        return cost != 80

    deadline = Deadline.of(SolveOptions(gap=0.5, no_improvement_s=2.0), listen, clock=clock)
    assert deadline.preview("search", 100, None)
    clock.now = 5.0
    assert deadline("ideals", None, 90)
    assert deadline("search", 300, None)
    assert told == [(100, None), (100, 90), (100, 90)]
    assert not deadline.preview("search", 80, None)
    assert deadline.stopped
    deadline.begin()
    assert not deadline("search", 400, None)
    assert told[-1] == (400, None)
