"""What a plan excuses from part-rigidity is told in the plan and in the program, and nothing else is let pass."""

from __future__ import annotations

import dataclasses
from functools import cache
from pathlib import Path

import pytest

from kerfwise import CheckResult, Lock, Nest, Plan
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.check import check_cuts
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program, report_of
from kerfwise.rule_kit import CutSequence, circle, nest, part, rect
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.judging.facing import rigid_at_the_end
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.state_rules import Stated, state_rules
from kerfwise.tests.postproc.plans import cut_of, profile

PROFILE = load_profile()
# A row between two edges, cut from the left: nothing is left for C, the last, to end on.
ROW = nest(350, 120, *(part(name, rect(10 + 110 * k, 10, 100, 100)) for k, name in enumerate("ABC")))
# Edges all around: nothing ever holds P.
ALONE = nest(120, 120, part("P", rect(10, 10, 100, 100)))


@cache
def planned(sheet: Nest) -> tuple[Plan, Stated]:
    candidates = build_candidates(sheet, PROFILE.lead_options())
    facts = compute_facts(sheet, PROFILE.fact_options(sheet), candidates)
    stated = state_rules(facts, PROFILE)
    return make_plan(
        facts, PROFILE, stated, solve(facts, stated.statements, SolveOptions(work=1.0)), "portfolio", 1
    ), stated


def test_the_last_of_a_row_is_excused_and_no_other() -> None:
    plan, stated = planned(ROW)
    assert stated.exempt == ()
    assert [(p.cut.contour, p.cut.excused) for p in plan.cuts] == [
        ("A.outer", ()),
        ("B.outer", ()),
        ("C.outer", ("part-rigidity",)),
    ]
    result = check_plan(ROW, plan, PROFILE)
    assert result.ok
    (excused,) = result.rule("part-rigidity").excused
    assert excused.violation.contours == ("C.outer",)
    assert excused.why == (
        "within these zones no order avoids it: with the neighbours out that the order rules put before C.outer, "
        "no entry and direction ends along more than 0%"
    )
    verdict = next(v for v in report_of(result, PROFILE) if v.id == "part-rigidity")
    assert (verdict.holds, verdict.exceptions) == (True, ((("C.outer",), excused.why),))


def test_an_excuse_costs_more_than_any_travel() -> None:
    plan, _ = planned(ROW)
    assert 1e6 <= plan.solve.objective < 2e6


def test_a_plan_file_keeps_its_excuses(tmp_path: Path) -> None:
    plan, _ = planned(ROW)
    (tmp_path / "plan.json").write_text(plan.to_json())
    again = read_plan(tmp_path / "plan.json")
    assert [p.cut.excused for p in again.cuts] == [p.cut.excused for p in plan.cuts]
    assert write_program(again, ROW, PROFILE) == write_program(plan, ROW, PROFILE)
    assert plan.to_json().count('"excused"') == 1


def test_without_the_excuse_the_plan_is_refused() -> None:
    plan, _ = planned(ROW)
    silent = [dataclasses.replace(p, cut=dataclasses.replace(p.cut, excused=())) for p in plan.cuts]
    assert check_plan(ROW, dataclasses.replace(plan, cuts=tuple(silent)), PROFILE).broken() == ("part-rigidity",)


def test_a_program_tells_its_excuses() -> None:
    program = write_program(planned(ROW)[0], ROW, PROFILE)
    told = "(EXCUSED part-rigidity C.outer)\n"
    assert program.count(told) == 1
    result = check_program(ROW, program, PROFILE)
    assert result.ok
    assert result.rule("part-rigidity").verdict == "excused"
    assert check_program(ROW, program.replace(told, ""), PROFILE).broken() == ("part-rigidity",)


@pytest.mark.parametrize("other", ["(EXCUSED part-rigidity A.outer)", "(EXCUSED pierce C.outer)", "(EXCUSED C.outer)"])
def test_an_excuse_for_something_else_is_none(other: str) -> None:
    program = write_program(planned(ROW)[0], ROW, PROFILE)
    program = program.replace("(EXCUSED part-rigidity C.outer)", other)
    assert check_program(ROW, program, PROFILE).broken() == ("part-rigidity",)


def test_only_rules_that_say_so_can_be_excused() -> None:
    plan, _ = planned(ROW)
    names = tuple(PROFILE.settings())
    cuts = [dataclasses.replace(p, cut=dataclasses.replace(p.cut, excused=names)) for p in plan.cuts]
    turned = dataclasses.replace(plan, cuts=tuple(reversed(cuts)))
    assert "level-ahead" in check_plan(ROW, turned, PROFILE).broken()


def test_what_nothing_can_hold_is_exempt_in_any_order() -> None:
    plan, stated = planned(ALONE)
    assert [about.contours for about in stated.exempt] == [("P.outer",)]
    assert not any(s.about.rule == "part-rigidity" and s.weight == 1e6 for s in stated.statements)
    bare = [dataclasses.replace(p, cut=dataclasses.replace(p.cut, excused=())) for p in plan.cuts]
    result = check_plan(ALONE, dataclasses.replace(plan, cuts=tuple(bare)), PROFILE)
    assert result.ok
    assert [e.why for e in result.rule("part-rigidity").excused] == [
        "no entry and direction of P.outer ends along more than 0%, even with all its neighbours in"
    ]


@pytest.mark.parametrize(("more", "without"), [(0.03, []), (-0.03, []), (0.08, ["A.outer"])])
def test_what_a_plan_excuses_is_told_though_the_check_would_let_it_pass(more: float, without: list[str]) -> None:
    plan, _ = planned(ROW)
    cuts, rule = plan.sequence(), PROFILE.rulebook()["part-rigidity"]
    share = dict(rigid_at_the_end(ROW, cuts, 0.25, 25.0, 25.0))[1]
    options = PartRigidityOptions(rigid_min=share + more)
    first = dataclasses.replace(cuts[0], excused=("part-rigidity",))
    excusing = dataclasses.replace(cuts, cuts=(first, *cuts[1:]))
    a, b = ([v.contours[0] for v in rule.violations(ROW, of, options)] for of in (cuts, excusing))
    assert [name for name in a if name == "A.outer"] == without
    assert "A.outer" in b


# a channel open to the right with a disc in its mouth: from the left, level-ahead asks for the channel first (its
# centroid sees the disc), hull-before for the disc; the plate F stands alone behind them
CHANNEL = [(20, 20), (120, 20), (120, 40), (40, 40), (40, 140), (120, 140), (120, 160), (20, 160)]
SHEET = nest(400, 180, part("C", CHANNEL), part("D", circle(90, 90, 25)), part("F", rect(160, 20, 60, 140)))
ALONG = {"C": 0.02, "D": 0.3, "F": 0.05}


def checked(order: str, locks: tuple[Lock, ...] = ()) -> CheckResult:
    cuts = [cut_of(SHEET.contour(f"{name}.outer"), ALONG[name], "cw") for name in order]
    return check_cuts(SHEET, CutSequence(tuple(cuts), "left"), profile(locks=locks))


def test_the_weaker_rule_gives_way_and_says_why() -> None:
    result = checked("CDF")
    assert result.ok
    judgement = result.rule("hull-before")
    assert judgement.verdict == "excused"
    assert judgement.excused[0].why == (
        "the order rules contradict each other here: C.outer before D.outer (level-ahead)"
    )


def test_the_firmer_rule_does_not() -> None:
    assert checked("DCF").broken() == ("level-ahead",)


def test_an_order_on_no_cycle_is_never_excused() -> None:
    result = checked("FCD")
    assert result.broken() == ("level-ahead",)
    assert {v.contours for v in result.rule("level-ahead").violations} == {
        ("C.outer", "F.outer"),
        ("D.outer", "F.outer"),
    }


def test_a_lock_is_firmer_than_both() -> None:
    locks = (Lock(contour="D.outer", before="C.outer"),)
    assert checked("DCF", locks).ok
    assert checked("DCF", locks).rule("level-ahead").verdict == "excused"
    assert checked("CDF", locks).broken() == ("hull-before", "locks")
