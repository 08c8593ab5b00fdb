"""A link round a corner, from the plan to the program: judged, burnt, run by LinuxCNC, and damaged."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import report
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Cuts, Links
from kerfwise.tests.metal.plant import plant as of_metal
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.models.solved import plant
from kerfwise.tests.tools import canon

SHEET = replace(
    nest(250, 120, part("A", rect(10, 10, 40, 40)), part("B", rect(62, 10, 40, 40)), part("W", rect(54, 24, 4, 4))),
    file="bent.json",
    sha256="22" * 32,
)


@cache
def given() -> Profile:
    made = plant()
    return replace(
        made,
        cuts=Cuts(links=Links(longest_mm=90.0)),
        machine=replace(made.machine, pierce_time_s=3.0),
        leads=replace(made.leads, entries=1),
    )


@cache
def planned() -> Plan:
    return solve_and_verify(
        make_request(facts_of(SHEET, given()), given()), given(), options_for(SHEET, given(), work=0.5)
    ).plan


def bent(plan: Plan) -> list[PlannedCut]:
    """The cuts that a link of two pieces leads to."""
    cuts = [p for p in plan.cuts if p.cut.linked and p.cut.lead_in is not None]
    return [p for p in cuts if p.cut.lead_in is not None and len(p.cut.lead_in.segments) == 2]


def test_the_best_plan_takes_one_and_passes_the_check() -> None:
    assert bent(planned())
    text = write_program(planned(), SHEET, given())
    for result in (check_plan(SHEET, planned(), given()), check_program(SHEET, text, given())):
        assert result.ok, report(result)
    assert simulate(SHEET, text, **of_metal(given())) == []


@pytest.mark.linuxcnc
def test_linuxcnc_burns_the_plans_length() -> None:
    run = canon.run(write_program(planned(), SHEET, given()))
    assert (run.error, run.warnings) == (None, [])
    assert len(run.burns) == planned().totals.pierces
    assert sum(burn.length_mm for burn in run.burns) == pytest.approx(planned().totals.cut_mm, abs=0.1)


@pytest.mark.scrap("the corner is moved into a part")
def test_a_corner_in_a_part_is_found() -> None:
    (link,) = (p.cut.lead_in for p in bent(planned())[:1])
    assert link is not None
    x, y = link.vertices[1, :2].tolist()
    text = write_program(planned(), SHEET, given())
    old = f"X{round(x, 4):.10g} Y{round(y, 4):.10g}"
    assert text.count(old) == 1, "the corner stands once in the program"
    result = check_program(SHEET, text.replace(old, f"X{round(x, 4):.10g} Y{y + 9:.4f}"), given())
    assert "no-gouging" in result.broken()
