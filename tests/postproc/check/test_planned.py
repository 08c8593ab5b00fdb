"""A program without comments, held against the plan it was made from."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult, report
from kerfwise.postproc.check.plan_conformance import _differences
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.profile.overrides import read_setting, with_settings
from kerfwise.tests.postproc.chains import cuts_of
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

PLATE, PROFILE = plate(), profile()
PLAN = plan_of(PLATE, good_cuts(PLATE), PROFILE)


def bare(plan: Plan) -> str:
    """The plan's program without its comments."""
    program = write_program(plan, PLATE, PROFILE)
    return "".join(line + "\n" for line in program.splitlines() if not line.startswith("("))


def judged(program: str, plan: Plan = PLAN) -> CheckResult:
    return check_program(PLATE, program, PROFILE, plan=plan)


def test_a_program_that_says_nothing_is_judged_with_what_the_plan_says() -> None:
    alone = check_program(PLATE, bare(PLAN), PROFILE)
    assert {j.id for j in alone.rules if j.verdict == "not judged"} == {"level-ahead", "start-side", "zone-order"}
    result = judged(bare(PLAN))
    assert result.ok, report(result)
    assert not [j.id for j in result.rules if j.verdict == "not judged"]
    assert result.rule("follows-plan").holds
    assert "follows-plan" not in {j.id for j in alone.rules}


def test_zones_of_the_plan_count() -> None:
    late = replace(PLAN, cuts=tuple(replace(p, cut=replace(p.cut, zone=3 - p.cut.zone)) for p in PLAN.cuts))
    assert judged(bare(PLAN), late).broken() == ("zone-order",)


def test_nobody_relaxes_what_is_promised_of_metal() -> None:
    far = with_settings(PROFILE, [read_setting("rules.pierce.clearance=40")])
    said = [f"(RELAXED {k} pierce {cut.cut.contour})" for k, cut in enumerate(PLAN.cuts, 1)]
    for name in (*(c.id for c in PLATE.contours), ""):
        said.append(f"(RELAXED {len(said) + 1} start-side {name})".replace(" )", ")"))
    head, _, rest = write_program(PLAN, PLATE, PROFILE).partition("\n")
    result = check_program(PLATE, "\n".join((head, *said, rest)), far)
    assert "pierce" in result.broken()
    wrong = {v.contours for v in check_program(PLATE, "\n".join((head, rest)), far).rule("pierce").violations}
    assert {v.contours for v in result.rule("pierce").violations} == wrong
    assert any(len(names) == 1 for names in wrong)


def other(**changes: object) -> Plan:
    """The plan of slightly other cuts."""
    cuts = [replace(cut, **changes) if cut.contour == "E.outer" else cut for cut in good_cuts(PLATE)]  # type: ignore[arg-type]
    return plan_of(PLATE, cuts, PROFILE)


def test_another_order() -> None:
    cuts = good_cuts(PLATE)
    swapped = plan_of(PLATE, [*cuts[:-2], cuts[-1], cuts[-2]], PROFILE)
    result = judged(bare(PLAN), swapped)
    assert result.broken() == ("follows-plan",)
    assert "cut 8 is of D.outer, the plan says E.outer" in report(result)
    assert "cut 9 is of E.outer, the plan says D.outer" in report(result)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"direction": "ccw"}, "cut 9 of E.outer goes cw, the plan says ccw"),
        ({"pierce": (484.0, 76.8)}, "mm from where the plan does, (484.00, 76.80)"),
        ({"linked": True}, "cut 9 of E.outer is pierced, the plan links it"),
    ],
)
def test_another_way_to_cut(changes: dict[str, object], says: str) -> None:
    result = judged(bare(PLAN), other(**changes))
    assert result.broken() == ("follows-plan",)
    assert says in report(result)


def test_one_cut_fewer() -> None:
    head, cuts, end = cuts_of(write_program(PLAN, PLATE, PROFILE))
    program = "\n".join([*head, *(line for cut in cuts[:-1] for line in cut.lines), *end, ""])
    result = judged(re.sub(r"(?m)^\(.*\n", "", program))
    assert result.broken() == ("every-contour-once", "follows-plan")
    assert "it makes 8 cuts, the plan 9" in report(result)


def test_excuses_and_relaxed_statements_are_those_of_the_plan() -> None:
    excused = replace(PLAN, cuts=tuple(replace(p, cut=replace(p.cut, excused=("pierce",))) for p in PLAN.cuts))
    assert judged(bare(PLAN), excused).ok


def test_a_linked_cut_begins_within_a_kerf_of_where_its_link_does() -> None:
    """Where a link leaves its ring at a low angle nobody can say to 0.1 mm; a kerf further it must have left."""
    way = Curve.of([(0.0, 0.0), (10.0, 0.0), (10.0, 8.0)], closed=False)
    asked = Cut("A.outer", (10.0, 8.0), "cw", (0.0, 0.0), lead_in=way, linked=True)
    assert list(_differences(replace(asked, pierce=(1.4, 0.05)), asked, True, 1.5)) == []
    (text,) = _differences(replace(asked, pierce=(1.7, 0.0)), asked, True, 1.5)
    assert text == "begins at (1.70, 0.00), 1.70 mm from where the plan does, (0.00, 0.00)"
    (text,) = _differences(replace(asked, pierce=(0.5, 0.3)), asked, True, 1.5)
    assert "0.30 mm from where the plan does" in text
