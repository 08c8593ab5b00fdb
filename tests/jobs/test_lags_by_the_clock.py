"""Lags in seconds hold in the plan and in its program, whatever the time model says of the machine's speed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.motion import Feeds
from kerfwise.models.physics.time_and_cost import feeds_of, machine_feeds
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check import report
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.profile.time_section import FeedLaw, Time
from kerfwise.tests.models.solved import plant
from kerfwise.tests.tools.amount import few

ROW = nest(500, 100, *(part(f"P{k}", rect(20 + 90 * k, 20, 60, 60)) for k in range(5)))
LAG_S = 7.0


def shop(time: Time) -> Profile:
    given = plant()
    rules = dict(given.rules) | {"heat-lag": RuleSetting("hard", None, HeatLagOptions(50.0, 0, LAG_S))}
    for name in ("level-ahead", "zone-order", "start-side"):
        rules[name] = RuleSetting("off", None, rules[name].options)
    return replace(given, rules=rules, time=time)


def made(profile: Profile, feeds: Feeds) -> VerifiedPlan:
    limits = SolveOptions(work=1.0, home_mm=profile.machine.home, feeds=feeds)
    return solve_and_verify(make_request(facts_of(ROW, profile), profile), profile, limits)


FAST = Time("blocks", FeedLaw(points=((1, 60.0), (1000, 60.0))))
SLOW = Time("blocks", FeedLaw(points=((1, 20.0), (1000, 20.0))))


@pytest.mark.slow
@pytest.mark.parametrize(
    "time", few([FAST, SLOW, Time("acceleration"), Time()], 1), ids=["fast", "slow", "limited", "set"]
)
def test_lags_hold(time: Time) -> None:
    profile = shop(time)
    done = made(profile, feeds_of(profile))
    assert done.verdict.ok, report(done.verdict)
    assert done.plan.time is not None
    assert done.plan.time.model in done.plan.to_json()


@pytest.mark.slow
def test_planned_at_the_feed_that_is_set_they_would_not() -> None:
    profile = shop(FAST)
    assert machine_feeds(profile).cut_mm_s < feeds_of(profile).cut_mm_s == 60.0
    assert not made(profile, machine_feeds(profile)).verdict.rule("heat-lag").holds
