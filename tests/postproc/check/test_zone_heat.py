"""A zone's budget of heat: planned, stated and judged; what cannot be divided is excused, all else is not."""

from __future__ import annotations

import dataclasses
from functools import cache

from kerfwise.encoder.cut import CutSequence
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check import check_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.registry import RULES
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.solved import plant

SMALL = (part(f"P{k}", rect(20 + 110 * k, 20, 100, 100)) for k in range(6))
PLATE = nest(1000, 300, part("Big", rect(690, 20, 250, 250)), *SMALL)
"""Six plates of about 13 kJ each and a seventh of some 32 kJ."""


def budget(kj: float, *locks: Lock) -> Profile:
    profile = plant(*locks)
    options = dataclasses.replace(profile.rules["zone-order"].options, zone_heat_kj=kj)
    return dataclasses.replace(profile, rules={**profile.rules, "zone-order": RuleSetting("hard", None, options)})


@cache
def made(profile_kj: float, *locks: Lock) -> VerifiedPlan:
    profile = budget(profile_kj, *locks)
    limits = options_for(PLATE, profile, work=1)
    return solve_and_verify(make_request(facts_of(PLATE, profile), profile), profile, limits)


def told(produced: VerifiedPlan, profile: Profile) -> list[tuple[str, str]]:
    """What is excused of zone-order, by the plan and by the program alike; all else holds."""
    for verdict in (check_plan(PLATE, produced.plan, profile), check_program(PLATE, produced.program, profile)):
        assert verdict.ok
        excused = [(e.violation.text, e.why) for e in verdict.rule("zone-order").excused]
    return excused


def zones(produced: VerifiedPlan) -> list[int]:
    at = {planned.part: planned.cut.zone for planned in produced.plan.cuts}
    return [at[p.id] for p in PLATE.parts]


def test_a_budget_that_every_zone_keeps() -> None:
    produced = made(35.0)
    assert zones(produced) == [4, 1, 1, 2, 2, 3, 3]
    assert told(produced, budget(35.0)) == []
    assert not any(planned.cut.excused for planned in produced.plan.cuts)


def test_a_part_that_passes_it_alone_is_an_exception_with_its_figures() -> None:
    produced = made(30.0)
    why = "Big.outer is cut in one zone with all that lies in it"
    assert told(produced, budget(30.0)) == [("zone 4 takes up 32.2 kJ, not 30 kJ at the most", why)]
    assert "(EXCUSED zone-order Big.outer)" in produced.program
    (stated,) = [rule for rule in produced.plan.rules if rule.id == "zone-order"]
    assert stated.exceptions == ((("Big.outer",), why),)
    about = state_rules(facts_of(PLATE, budget(30.0)), budget(30.0)).exempt
    assert [a.sentence for a in about] == ["zone 4 takes up 32.2 kJ, not 30 kJ at the most: Big.outer"]


def test_locks_may_bring_more_into_a_zone() -> None:
    lock = Lock(part="Big", zone=1)
    produced = made(35.0, lock)
    assert zones(produced) == [1] * 7  # level-ahead: what lies before it comes with it
    ((text, why),) = told(produced, budget(35.0, lock))
    assert text.endswith("kJ, not 35 kJ at the most")
    assert why == "locks decide on zones: of Big"


def test_a_plan_that_was_made_without_the_budget_breaks_it() -> None:
    produced, profile = made(35.0), budget(20.0)
    for verdict in (check_plan(PLATE, produced.plan, profile), check_program(PLATE, produced.program, profile)):
        assert "zone-order" in verdict.broken()
        broken = [v.contours for v in verdict.rule("zone-order").violations]
        assert broken == [("P0.outer", "P1.outer"), ("P2.outer", "P3.outer"), ("P4.outer", "P5.outer")]
        assert [e.violation.contours for e in verdict.rule("zone-order").excused] == [("Big.outer",)]


def test_heat_is_not_judged_without_times() -> None:
    rule, options = RULES["zone-order"], budget(1.0).settings()["zone-order"].options
    cuts = made(35.0).plan.sequence((0.0, 0.0))
    blind = CutSequence(tuple(dataclasses.replace(cut, start_s=0.0, end_s=0.0) for cut in cuts), cuts.start_side)
    why = "the times of the cuts are not stated, and so the heat of their zones is not known"
    assert rule.unjudged(PLATE, blind, options) == why
    assert rule.unjudged(PLATE, cuts, options) is None
    assert rule.violations(PLATE, blind, options) == []
