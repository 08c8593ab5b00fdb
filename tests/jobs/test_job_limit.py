"""The limit of a job: what its planning is given, and what is told of seconds that the limit does not count."""

from __future__ import annotations

import pytest

from kerfwise.jobs import time_limits
from kerfwise.jobs.time_limits import CommandLimit, JobLimit
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.tuning import LIMITS_LEAST_SHARE as LEAST_SHARE

TEN_S = SolveOptions(seed=3, time_s=10.0)


class Clocks:
    """Seconds of running and of compiling, which the tests wind on themselves."""

    running_s = compiled_s = 0.0


@pytest.fixture
def clocks(monkeypatch: pytest.MonkeyPatch) -> Clocks:
    wound = Clocks()
    monkeypatch.setattr(time_limits, "running_s", lambda: wound.running_s)
    monkeypatch.setattr(time_limits, "made_s", lambda: wound.compiled_s)
    monkeypatch.setattr(time_limits, "compiled_s", lambda: wound.compiled_s)
    return wound


def test_rules_are_inside_the_limit_of_a_planning_and_facts_are_not(clocks: Clocks) -> None:
    told: list[str] = []
    limit = JobLimit()
    limit.begin(TEN_S, told.append)
    clocks.running_s += 7.0
    assert limit.facts_made() == TEN_S
    assert told == ["the facts of the nest took 7 s, which the limit does not count"]
    clocks.running_s += 3.0
    assert limit.stated() == SolveOptions(seed=3, time_s=7.0)
    assert limit.without_plan() == TEN_S


def test_a_planning_keeps_its_least_share(clocks: Clocks) -> None:
    limit = JobLimit()
    limit.begin(TEN_S, lambda text: None)
    limit.facts_made()
    clocks.running_s += 30.0
    assert limit.stated().time_s == LEAST_SHARE * 10.0


def test_what_a_limit_of_the_planning_did_not_count_is_told_at_its_end(clocks: Clocks) -> None:
    told: list[str] = []
    limit = JobLimit()
    limit.begin(TEN_S, told.append)
    limit.facts_made()
    limit.stated()
    clocks.running_s += 10.0 + 6.0 + 8.0
    clocks.compiled_s += 12.0
    limit.ended(judging_s=8.0)
    assert told == [
        "kernels were compiled, which is done once: 12 s, not counted by the limit",
        "ending the planning took 6 s, which the limit does not count",
        "writing and checking the program took 8 s, which the limit does not count",
    ]


@pytest.mark.parametrize("limits", [SolveOptions(), SolveOptions(work=5.0)])
def test_nothing_is_told_where_no_limit_is_in_seconds(clocks: Clocks, limits: SolveOptions) -> None:
    told: list[str] = []
    limit = JobLimit()
    limit.begin(limits, told.append)
    clocks.running_s += 90.0
    assert limit.stated() == limit.facts_made() == limits
    clocks.running_s += 90.0
    clocks.compiled_s += 90.0
    limit.ended(judging_s=80.0)
    assert told == []


def test_a_limit_of_the_command_counts_all_but_compiling(clocks: Clocks) -> None:
    told: list[str] = []
    limit = CommandLimit(10.0, clock=lambda: clocks.running_s)
    limit.begin(TEN_S, told.append)
    clocks.running_s += 2.0
    first_s = limit.facts_made().time_s
    clocks.running_s += 1.0
    assert first_s is not None
    assert limit.stated().time_s == pytest.approx(first_s - 1.0)
    clocks.running_s += 5.0
    assert limit.without_plan().time_s == LEAST_SHARE * 10.0
    clocks.compiled_s += 12.0
    limit.ended(judging_s=1.0)
    assert limit.planned_s == pytest.approx(4.0)
    assert told == ["kernels were compiled, which is done once: 12 s, not counted by the limit"]
