"""A limit for a whole command: what is left for the planning, by clocks that the tests wind on themselves."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

import kerfwise as package
from kerfwise import InputError, NoPlan, RulesConflict, load_profile, pipeline
from kerfwise.commands import page_picture, solve
from kerfwise.jobs import time_limits
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import options_for, ways_on
from kerfwise.jobs.time_limits import DRAWN, CommandLimit
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.tuning import CHECKED, ENDED_S, PLANNED
from kerfwise.models.engines.tuning import LIMITS_LEAST_SHARE as LEAST_SHARE
from kerfwise.models.jit import counted_s
from kerfwise.pipeline import Watchers
from kerfwise.pipeline import plan_nest as plan_nest_main_job
from kerfwise.postproc.report import expect_picture
from kerfwise.rule_kit import nest, part, rect
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
PLATE = nest(300, 200, part("A", rect(20, 20, 80, 60)), part("B", rect(140, 20, 80, 60)))
PROFILE = load_profile()


@dataclass
class Wound:
    """A clock that stands still until it is wound on."""

    now_s: float = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Wound:
    return Wound(100.0)


def limit_of(limit_s: float, clock: Wound, *drawn: str) -> CommandLimit:
    limit = CommandLimit(limit_s, drawn=drawn, clock=clock)
    limit.begin(SolveOptions(), lambda text: None)
    return limit


def after(limit: CommandLimit, candidates_s: float) -> float:
    """What a planning has where finding candidates took so long."""
    limit.candidates_s = candidates_s
    return limit.planning_s()


def test_what_has_passed_and_what_comes_after_are_taken_off(clock: Wound) -> None:
    limit = limit_of(30.0, clock)
    clock.now_s += 5.0
    assert limit.spent_s == 5.0
    assert after(limit, 1.0) == pytest.approx(30.0 - 5.0 - CHECKED - ENDED_S)
    assert after(limit, 2.0) == pytest.approx(30.0 - 5.0 - 2 * CHECKED - ENDED_S)


@pytest.mark.parametrize("suffix", sorted(DRAWN))
def test_a_picture_takes_its_share(suffix: str, clock: Wound) -> None:
    plain, drawn = limit_of(90.0, clock), limit_of(90.0, clock, suffix.upper())
    times, more_s = DRAWN[suffix]
    assert after(plain, 1.0) - after(drawn, 1.0) == pytest.approx(times + more_s)


@pytest.mark.parametrize("suffix", sorted(DRAWN))
def test_a_picture_beside_the_check_counts_where_it_takes_longer(suffix: str, clock: Wound) -> None:
    times, more_s = DRAWN[suffix]
    beside = CommandLimit(9000.0, drawn=(suffix,), clock=clock, beside=True)
    alone, later = limit_of(9000.0, clock), limit_of(9000.0, clock, suffix)
    for candidates_s in (0.1, 100.0):
        longer_s = max(0.0, (PLANNED + times - CHECKED) * candidates_s + more_s)
        kept_s = after(alone, candidates_s) - after(beside, candidates_s)
        assert kept_s == pytest.approx(longer_s)
    assert after(beside, 100.0) > after(later, 100.0)


def test_every_kind_of_picture_has_a_share() -> None:
    with pytest.raises(InputError) as refused:
        expect_picture(".none")
    assert refused.value.message.endswith(f"one of {', '.join(DRAWN)}")


def test_the_planning_keeps_its_least_share(clock: Wound) -> None:
    limit = limit_of(10.0, clock)
    clock.now_s += 9.0
    assert after(limit, 0.0) == LEAST_SHARE * 10.0
    clock.now_s += 90.0
    assert after(limit, 0.0) == LEAST_SHARE * 10.0
    assert limit.without_plan().time_s == LEAST_SHARE * 10.0


def test_what_contradicts_what_leaves_time_to_tell_it(clock: Wound) -> None:
    """It took all that was left, and the picture of it came after the limit."""
    limit = limit_of(10.0, clock)
    clock.now_s += 2.0
    assert limit.without_plan().time_s == pytest.approx(8.0 - ENDED_S)


def test_a_limit_that_cannot_hold_is_told_before_the_planning(clock: Wound) -> None:
    limit, told = limit_of(10.0, clock), list[str]()
    limit.begin(SolveOptions(seed=3), told.append)
    limit.candidates_s = 1.0
    clock.now_s += 2.0
    limit.stated()
    assert told == []
    clock.now_s += 5.0
    assert limit.stated() == SolveOptions(seed=3, time_s=2.0)
    assert told.pop() == (
        f"reading, facts, rules and the check alone take about {7.0 + CHECKED + ENDED_S:.1f} s of a limit of 10 s: the "
        "planning has 2.0 s all the same, and the command takes longer than its limit"
    )


def test_a_command_that_has_taken_longer_says_what_took_how_long(clock: Wound) -> None:
    limit = limit_of(10.0, clock)
    clock.now_s += 2.0
    share_s = limit.stated().time_s
    assert share_s == pytest.approx(8.0 - ENDED_S)
    clock.now_s += 7.5
    limit.ended(0.5)
    assert limit.planned_s == pytest.approx(7.0)
    clock.now_s += 1.0
    assert limit.over() == ""
    clock.now_s += 1.5
    assert limit.over() == (
        "the command took 12.0 s, 2.0 s longer than its limit: 2.0 s before the planning, 7.0 s for it "
        f"(left: {share_s:.1f} s), 3.0 s for program, check and files"
    )


def test_the_planning_is_stopped_when_its_seconds_are_over_whatever_the_engines_count(clock: Wound) -> None:
    limit, heard = limit_of(10.0, clock), list[str]()

    def listener(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        heard.append(engine)
        return True

    limits = limit.stated()
    watch = Deadline.of(limits, limit.watched(listener), clock=lambda: 0.0)  # as where kernels are loaded all the time
    clock.now_s += 10.0 - ENDED_S - 0.01
    assert watch("search", None, None)
    clock.now_s += 0.02
    assert not watch("search", None, None)
    assert heard == ["search", "search"]


class _Planned(Exception):
    """The planning was reached."""


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, clock: Wound) -> list[Any]:
    """The limits and the listener that a planning is given: facts take 4 s, 1 s of it for candidates, and rules 3 s."""
    seen: list[Any] = []
    facts_of, ask = pipeline.facts_of, pipeline.make_request

    def facts(nest: Any, profile: Any, already: Any, limit: CommandLimit, *, zoned: bool) -> Any:
        clock.now_s += 4.0
        made = facts_of(nest, profile, already, limit, zoned=zoned)
        limit.candidates_s = 1.0
        return made

    def stated(facts: Any, profile: Any, relax: bool, limits: SolveOptions) -> Any:
        seen.append(limits.time_s)
        clock.now_s += 3.0
        return ask(facts, profile, relax, limits)

    def produce(
        asked: Any, profile: Any, limits: SolveOptions, method: Any, progress: Any, *rest: Any, **more: Any
    ) -> Any:
        seen.extend((limits.time_s, progress))
        raise _Planned

    monkeypatch.setattr(pipeline, "facts_of", facts)
    monkeypatch.setattr(pipeline, "make_request", stated)
    monkeypatch.setattr(pipeline, "plan_request", produce)
    return seen


def test_rules_and_engines_get_what_is_left(asked: list[Any], clock: Wound) -> None:
    told: list[str] = []
    limits, limit = options_for(PLATE, PROFILE, time_s=30.0), limit_of(30.0, clock, ".svg")
    kept_s = CHECKED + DRAWN[".svg"][0] + ENDED_S
    clock.now_s += 2.0  # reading
    with pytest.raises(_Planned):
        plan_nest_main_job(Inputs(PLATE, PROFILE), limits, watchers=Watchers(tell=told.append), whole=limit)
    assert asked[0] == pytest.approx(30.0 - 6.0 - kept_s)
    assert asked[1] == pytest.approx(30.0 - 9.0 - kept_s)
    assert asked[2]("search", None, None)
    clock.now_s += asked[1] + 0.1
    assert not asked[2]("search", None, None)
    assert told == []


def test_a_limit_that_reading_uses_up_is_told(asked: list[Any], clock: Wound) -> None:
    told: list[str] = []
    limits, limit = options_for(PLATE, PROFILE, time_s=8.0), limit_of(8.0, clock)
    with pytest.raises(_Planned):
        plan_nest_main_job(Inputs(PLATE, PROFILE), limits, watchers=Watchers(tell=told.append), whole=limit)
    assert asked[:2] == pytest.approx([LEAST_SHARE * 8.0] * 2)
    (told_once,) = told
    assert "of a limit of 8 s" in told_once


def test_the_clock_of_the_command_runs_from_its_beginning_and_it_says_when_it_was_late(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(solve, "counted_s", lambda: counted_s() - 70_000.0)
    monkeypatch.chdir(tmp_path)
    done = kerfwise("solve", NEST, "--time-limit", "50000")
    assert done.code == 0
    early, late = (line for line in done.err.splitlines() if "longer than its limit" in line)
    alone = r"note: reading, facts, rules and the check alone take about 70\d\d\d\.\d s of a limit of 50000 s: "
    assert re.match(alone + "the planning has 10000.0 s all the same, and the command takes longer", early)
    took = r"note: the command took 70\d\d\d\.\d s, 20\d\d\d\.\d s longer than its limit: 70\d\d\d\.\d s before"
    assert re.match(took, late)


@pytest.mark.slow
@pytest.mark.parametrize("from_contours", [2, 2000])
def test_the_command_keeps_time_for_its_picture_where_it_draws_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, from_contours: int
) -> None:
    made: list[CommandLimit] = []

    def noted(*given: Any, **options: Any) -> CommandLimit:
        made.append(CommandLimit(*given, **options))
        return made[-1]

    monkeypatch.setattr(page_picture, "FROM_CONTOURS", from_contours)
    monkeypatch.setattr(page_picture, "LEAST_CORES", 1)
    monkeypatch.setattr(time_limits, "CommandLimit", noted)
    monkeypatch.chdir(tmp_path)
    assert kerfwise("solve", NEST, "--time-limit", "50000").code == 0
    after_s = (CHECKED + DRAWN[".svg"][0]) * 100.0 + ENDED_S
    made[0].candidates_s = 100.0
    assert made[0].kept_s() == pytest.approx(CHECKED * 100.0 + ENDED_S if from_contours == 2 else after_s)


def test_a_command_without_a_plan_says_when_it_was_late(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(solve, "counted_s", lambda: counted_s() - 70_000.0)
    monkeypatch.chdir(tmp_path)
    clash = ("--lock", "part#1.outer position first", "--lock", "part#3.outer before part#1.outer")
    done = kerfwise("solve", NEST, "--time-limit", "50000", *clash)
    assert done.code == 1
    (late,) = (line for line in done.err.splitlines() if "longer than its limit" in line)
    assert re.fullmatch(
        r"note: the command took 70\d\d\d\.\d s, 20\d\d\d\.\d s longer than its limit: 70\d\d\d\.\d s before the "
        r"planning, \d+\.\d s to find that there is no plan, and why",
        late,
    )


def test_a_command_whose_plan_is_refused_says_when_it_was_late(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def refused(*given: Any, **options: Any) -> Any:
        done = plan_nest_main_job(*given, **options)
        first, *others = done.made.verdict.rules
        verdict = replace(done.made.verdict, rules=(replace(first, unjudged="why", must_be_judged=True), *others))
        return replace(done, made=replace(done.made, verdict=verdict))

    monkeypatch.setattr(solve, "counted_s", lambda: counted_s() - 70_000.0)
    monkeypatch.setattr(pipeline, "plan_nest", refused)
    monkeypatch.chdir(tmp_path)
    done = kerfwise("solve", NEST, "--time-limit", "50000")
    assert done.code == 1
    assert "s for program, check and files" in done.err.splitlines()[-1]
    assert not list(tmp_path.iterdir())


def test_kernels_that_are_only_loaded_are_not_said_to_be_left_out_of_a_limit_that_counts_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    loaded_s = iter(range(0, 1000, 100))
    monkeypatch.setattr(time_limits, "made_s", lambda: next(loaded_s))
    for whole, notes in ((CommandLimit(50_000.0), 0), (None, 1)):
        told: list[str] = []
        plan_nest_main_job(
            Inputs(PLATE, PROFILE),
            options_for(PLATE, PROFILE, time_s=50_000.0),
            watchers=Watchers(tell=told.append),
            whole=whole,
        )
        assert len([note for note in told if note.startswith("kernels were compiled")]) == notes


def test_without_a_limit_of_the_command_the_planning_has_its_own(asked: list[Any], clock: Wound) -> None:
    with pytest.raises(_Planned):
        plan_nest_main_job(Inputs(PLATE, PROFILE), options_for(PLATE, PROFILE, time_s=50_000.0))
    assert asked[0] == 50_000.0
    assert asked[1] == pytest.approx(50_000.0, rel=0.01)
    clock.now_s += 1e6
    assert asked[2]("search", None, None)


def test_by_work_nothing_looks_at_a_clock(asked: list[Any]) -> None:
    with pytest.raises(_Planned):
        plan_nest_main_job(Inputs(PLATE, PROFILE), options_for(PLATE, PROFILE, work=2.0))
    assert asked[:2] == [None, None]
    assert isinstance(asked[2], Listener)


def test_what_contradicts_what_is_looked_for_in_what_is_left(monkeypatch: pytest.MonkeyPatch, clock: Wound) -> None:
    from kerfwise.models.plan import conflict

    left: list[float] = []

    def found(facts: Any, profile: Any, budget: Any) -> None:
        left.append(budget.left)

    def refused(*given: Any) -> None:
        clock.now_s += 12_000.0
        raise RulesConflict("no plan")

    monkeypatch.setattr(conflict, "find_conflict", found)
    monkeypatch.setattr(pipeline, "make_request", refused)
    for limit_s in (62_000.0, 10_000.0):
        limits = replace(options_for(PLATE, PROFILE), time_s=limit_s)
        with pytest.raises(NoPlan):
            plan_nest_main_job(Inputs(PLATE, PROFILE), limits, whole=limit_of(limit_s, clock))
    assert left == pytest.approx([50_000.0, LEAST_SHARE * 10_000.0], rel=0.05)


def test_where_no_plan_exists_nothing_but_relaxing_is_advised() -> None:
    profile = load_profile()
    facts = package.facts(nest(100, 100, part("A", rect(10, 10, 80, 80))), profile)
    for relaxed, advice in (
        (False, ["try: --relax (in Python relax=True), which lets the cheapest hard rules"]),
        (True, []),
    ):
        why = RulesConflict("no plan meets every hard rule", ("A.outer is out early",), proven=True)
        ways = ways_on(SolveOptions(work=0.1), "portfolio", relaxed, why.proven)
        told = str(NoPlan(why, facts, profile, within_limit=False, ways=ways))
        assert "A.outer is out early" in told
        assert "note: how few of the hard rules contradict each other was not shown within the limit" in told
        assert re.findall(r"try: --relax .* hard rules", told) == advice
        assert "--work" not in told


def test_without_a_contradiction_the_error_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    profile, picture = load_profile(), tmp_path / "none.svg"
    facts = package.facts(nest(100, 100, part("A", rect(10, 10, 80, 80))), profile)
    assert solve.print_conflict(NoPlan(RulesConflict("none was found"), facts, profile), picture) == 1
    assert capsys.readouterr().err == "kerfwise: none was found\n"
    assert not picture.exists()
