"""Islands and strips that the orders force are excused by hard rules, told, and seen to be forced; others are not."""

from __future__ import annotations

import dataclasses
from functools import cache

import pytest

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check import check_program
from kerfwise.postproc.check.result import Judgement, RelaxedStatement
from kerfwise.postproc.check.rule_verdicts import judge
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import cut, in_order, nest, part, rect
from kerfwise.rules.catalogue.no_islands import NoIslandsOptions
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.tests.models.solved import plant

# Three long parts side by side, and three rows of three: the middle one is locked to be the last.
LONG = nest(700, 400, *(part(name, rect(200, 110 + 50 * k, 300, 40)) for k, name in enumerate("ABC")))
BESIDE = nest(700, 400, *LONG.parts, part("D", rect(600, 160, 60, 60)))
ROWS = nest(500, 500, *(part(f"P{k}", rect(85 + 110 * (k % 3), 85 + 110 * (k // 3), 100, 100)) for k in range(9)))


def strict(rule: str, *locks: Lock) -> Profile:
    profile = plant(*locks)
    rules = dict(profile.rules)
    rules["level-ahead"] = RuleSetting("off", None, rules["level-ahead"].options)
    rules["zone-order"] = RuleSetting("off", None, rules["zone-order"].options)
    rules[rule] = RuleSetting("hard", None, rules[rule].options)
    return dataclasses.replace(profile, rules=rules)


@cache
def made(sheet: Nest, rule: str, *locks: Lock) -> tuple[Profile, VerifiedPlan]:
    profile = strict(rule, *locks)
    limits = options_for(sheet, profile, work=4)
    return profile, solve_and_verify(make_request(facts_of(sheet, profile), profile), profile, limits)


def reasons(sheet: Nest, rule: str, *locks: Lock) -> list[tuple[tuple[str, ...], str]]:
    """What is excused of the rule, by the plan and by the program alike."""
    profile, produced = made(sheet, rule, *locks)
    for verdict in (check_plan(sheet, produced.plan, profile), check_program(sheet, produced.program, profile)):
        assert verdict.ok
        told = [(e.violation.contours, e.why) for e in verdict.rule(rule).excused]
    return told


def test_nothing_is_excused_without_need() -> None:
    for sheet, rule in ((LONG, "no-narrow-strips"), (ROWS, "no-islands")):
        assert reasons(sheet, rule) == []
        assert not any(p.cut.excused for p in made(sheet, rule)[1].plan.cuts)


def test_a_strip_that_no_order_avoids() -> None:
    last = Lock(contour="B.outer", position="last")
    why = "within these zones no order avoids it: the order rules put A.outer, C.outer before B.outer"
    assert reasons(LONG, "no-narrow-strips", last) == [(("B.outer",), why)]
    assert "(EXCUSED no-narrow-strips B.outer)" in made(LONG, "no-narrow-strips", last)[1].program


def test_a_strip_that_one_of_several_orders_makes() -> None:
    """A position is no order of two contours: that nothing better is left is the planner's word."""
    third = Lock(contour="B.outer", position=3)
    before = (Lock(contour="A.outer", before="D.outer"), Lock(contour="C.outer", before="D.outer"))
    why = "the plan excuses it: what must be cut before B.outer left nothing better"
    assert reasons(BESIDE, "no-narrow-strips", third, *before) == [(("B.outer",), why)]


def test_an_island_that_no_order_avoids() -> None:
    last = Lock(contour="P4.outer", position="last")
    why = "within these zones no order avoids it: the order rules put everything that P4.outer hangs on before it"
    assert reasons(ROWS, "no-islands", last) == [(("P4.outer",), why)]


def test_without_the_excuse_the_plan_is_refused() -> None:
    for sheet, rule, name in ((LONG, "no-narrow-strips", "B.outer"), (ROWS, "no-islands", "P4.outer")):
        profile, produced = made(sheet, rule, Lock(contour=name, position="last"))
        silent = produced.program.replace(f"(EXCUSED {rule} {name})\n", "")
        assert check_program(sheet, silent, profile).broken() == (rule,)
        other = produced.program.replace(f"(EXCUSED {rule} {name})", f"(EXCUSED {rule} A.outer)")
        assert check_program(sheet, other, profile).broken() == (rule,)


def test_a_relaxed_order_excuses_no_other_lock_of_its_contour() -> None:
    """B is locked to be first and to be cut clockwise; only that it comes before A was let go."""
    locks = (Lock(contour="B.outer", position="first"), Lock(contour="B.outer", direction="cw"))
    profile = plant(*locks)
    cuts = {name: cut(LONG, f"{name}.outer") for name in "ABC"}
    turned = dataclasses.replace(cuts["B"], direction="ccw")

    def verdict(*order: Cut) -> Judgement:
        relaxed = [RelaxedStatement("locks", ("B.outer", "A.outer"))]
        judged = judge(LONG, CutSequence(order, "bottom"), profile, relaxed)
        return next(j for j in judged if j.id == "locks")

    assert verdict(cuts["A"], cuts["B"], cuts["C"]).verdict == "excused"
    assert [v.text for v in verdict(cuts["A"], turned, cuts["C"]).violations] == [
        "B.outer (cut 2) is cut ccw, not cw: locked by the operator"
    ]
    assert [v.text for v in verdict(cuts["A"], cuts["C"], cuts["B"]).violations] == [
        "B.outer is cut 3 in order, not first: locked by the operator"
    ]


@pytest.mark.parametrize("gap_mm", [25.3, 24.8])
def test_an_island_that_a_plan_excuses_is_told_though_the_check_would_let_it_pass(gap_mm: float) -> None:
    """C faces A over a web that the check takes for wide enough to hold it, and the planner may not."""
    row = nest(700, 500, *(part(n, rect(x, 200, 100, 100)) for n, x in (("B", 100), ("A", 220), ("C", 320 + gap_mm))))
    rule, options = strict("no-islands").rulebook()["no-islands"], NoIslandsOptions(frame_share=0.9)
    cuts = in_order(row, "B.outer A.outer C.outer")
    excusing = dataclasses.replace(cuts, cuts=(cuts[0], dataclasses.replace(cuts[1], excused=("no-islands",)), cuts[2]))
    assert rule.violations(row, cuts, options) == []
    (told,) = rule.violations(row, excusing, options)
    assert (told.contours, told.cuts) == (("A.outer",), (2,))
    assert rule.excuse(row, excusing, options, told, lambda name: frozenset()) is not None
    near = nest(700, 500, *(part(n, rect(x, 200, 100, 100)) for n, x in (("B", 100), ("A", 220), ("C", 330))))
    assert rule.violations(near, excusing, options) == []
