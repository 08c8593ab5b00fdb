"""When a solve stops."""

from __future__ import annotations

from kerfwise.models.engines.solution import SolveOptions, Watch


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_time_limit() -> None:
    clock = Clock()
    watch = Watch(SolveOptions(time_s=2.0), clock=clock)
    assert watch("search", None, None)
    clock.now = 1.9
    assert watch("search", 5, None)
    clock.now = 2.0
    assert not watch("search", 5, None)
    assert watch.stopped


def test_gap_joins_what_different_engines_found() -> None:
    watch = Watch(SolveOptions(gap=0.05))
    assert watch("search", 100, None)
    assert watch("cp-sat", None, 94)
    assert not watch("search", 98, None)


def test_a_bound_without_a_plan_is_no_reason_to_stop() -> None:
    assert Watch(SolveOptions(gap=0.5))("cp-sat", None, 10)


def test_no_improvement_counts_from_the_last_better_plan() -> None:
    clock = Clock()
    watch = Watch(SolveOptions(no_improvement_s=1.0), clock=clock)
    clock.now = 5.0
    assert watch("search", None, None), "there is no plan yet that could be taken"
    assert watch("search", 10, None)
    clock.now = 5.9
    assert watch("search", 9, None)
    clock.now = 6.8
    assert watch("search", 9, None)
    clock.now = 6.9
    assert not watch("search", 9, None)


def test_once_stopped_it_stays_stopped() -> None:
    answers = iter([False, True])
    watch = Watch(SolveOptions(), lambda engine, cost_um, bound_um: next(answers))
    assert not watch("search", None, None)
    assert not watch("search", None, None)


def test_another_problem_begins_without_costs() -> None:
    watch = Watch(SolveOptions(gap=0.0))
    watch("ideals", 7, None)
    watch.begin()
    assert watch("ideals", None, 7)
    assert watch("ideals", 8, 7)


def test_a_preview_is_told_and_counts_for_nothing_else() -> None:
    clock, told = Clock(), list[tuple[int | None, int | None]]()

    def listen(engine: str, cost: int | None, bound: int | None) -> bool:
        told.append((cost, bound))
        return cost != 80

    watch = Watch(SolveOptions(gap=0.5, no_improvement_s=2.0), listen, clock)
    assert watch.preview("search", 100, None)
    clock.now = 5.0
    assert watch("ideals", None, 90)
    assert watch("search", 300, None)
    assert told == [(100, None), (100, 90), (100, 90)]
    assert not watch.preview("search", 80, None)
    assert watch.stopped
    watch.begin()
    assert not watch("search", 400, None)
    assert told[-1] == (400, None)
