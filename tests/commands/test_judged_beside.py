"""A plan judged beside the writing of its program gets the verdict that it gets after it; one is found in any case."""

from __future__ import annotations

import os
import signal
import threading
from copy import copy
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise import pipeline
from kerfwise.commands import page_picture
from kerfwise.commands.judged_beside import JudgedBeside
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import options_for
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import FinishedPlan, Planned, Promise, VerifiedPlan, Watchers, plan_nest, verified
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.stated import with_state
from kerfwise.postproc.dialects import dialect_names
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES

NEST = read_nest(Path(__file__).parents[2] / "examples" / "nests" / "e1x_6.json")
PROFILE = load_profile()


@pytest.fixture(autouse=True)
def beside_on_small_nests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_picture, "FROM_CONTOURS", 1)
    monkeypatch.setattr(page_picture, "LEAST_CORES", 1)


def finished(watchers: Watchers) -> FinishedPlan:
    return plan_nest(Inputs(NEST, PROFILE), options_for(NEST, PROFILE, work=0.1), watchers=watchers)


@pytest.fixture(scope="module")
def alone() -> tuple[FinishedPlan, Plan]:
    """A plan that is judged by this process, and what it was before."""
    before: list[Plan] = []
    return finished(Watchers(planned=before.append)), before[0]


def said(made: VerifiedPlan) -> tuple[str, str, CheckResult]:
    return made.plan.to_json(), made.program, made.verdict


@pytest.mark.parametrize("threads", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_it_is_the_verdict_that_is_found_here(
    threads: int, alone: tuple[FinishedPlan, Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(threading, "active_count", lambda: threads)
    monkeypatch.setattr(pipeline, "check_plan", lambda *given: pytest.fail("judged here, too"))
    monkeypatch.setattr(pipeline, "judge", lambda *given: pytest.fail("read back twice"))
    with JudgedBeside(NEST, PROFILE) as beside:
        assert said(finished(Watchers(planned=beside.begin)).made) == said(alone[0].made)


def test_a_process_that_died_leaves_it_to_this_one(
    alone: tuple[FinishedPlan, Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(threading, "active_count", lambda: 1)
    with JudgedBeside(NEST, PROFILE) as beside:

        def killed(plan: Plan) -> Promise | None:
            promise = beside.begin(plan)
            assert beside.process is not None
            assert beside.process.pid is not None
            os.kill(beside.process.pid, signal.SIGTERM)
            beside.process.join()
            return promise

        assert said(finished(Watchers(planned=killed)).made) == said(alone[0].made)


def test_a_verdict_that_the_program_does_not_share_has_it_read_back_again(alone: tuple[FinishedPlan, Plan]) -> None:
    done, before = alone
    found = check_plan(NEST, before, PROFILE)
    first = next(k for k, judgement in enumerate(found.rules) if judgement.strength == "hard")
    broken = replace(found.rules[first], violations=(Violation(found.rules[first].id, (), "as if"),))
    worse = replace(found, rules=(*found.rules[:first], broken, *found.rules[first + 1 :]))
    request = pipeline.make_request(done.facts, PROFILE)
    solution = pipeline.plan_request(request, PROFILE, options_for(NEST, PROFILE, work=0.1)).solution
    planned = Planned(done.facts, before, solution)
    beside, after = verified(planned, PROFILE, promise=lambda: worse), verified(planned, PROFILE, lawful=worse)
    assert "STATE BROKEN" in beside.program
    assert said(beside) == said(after)


@pytest.mark.parametrize("contours", [1, 9999])
def test_it_is_not_begun_where_it_does_not_pay(
    contours: int, alone: tuple[FinishedPlan, Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor where a rule is not one of ours."""
    monkeypatch.setattr(page_picture, "FROM_CONTOURS", contours)
    profile: Profile = (
        PROFILE if contours > 1 else replace(PROFILE, further_rules={"level-ahead": copy(RULES["level-ahead"])})
    )
    with JudgedBeside(NEST, profile) as beside:
        assert beside.process is None
        assert beside.begin(alone[1]) is None


def test_a_program_differs_from_the_one_read_back_in_what_it_says_of_its_state(
    alone: tuple[FinishedPlan, Plan],
) -> None:
    """In every dialect that plasma has: the draft that is judged says that it is broken."""
    written = 0
    for name in dialect_names():
        profile = replace(PROFILE, machine=replace(PROFILE.machine, dialect=name))
        for state in (PlanState("kept"), alone[0].made.plan.state):
            said_so = [replace(alone[1], state=one) for one in (PlanState("broken"), state)]
            try:
                draft, made = (write_program(plan, NEST, profile) for plan in said_so)
            except InputError:
                continue
            assert with_state(draft, state) == made
            written += 1
    assert written >= 10
