"""A program is judged by the rules once with its plan where both make the same cuts, and on its own where not."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache

import pytest

from kerfwise.encoder.cut import Cut, CutSequence, Pierce, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import options_for
from kerfwise.pipeline import FinishedPlan, plan_nest
from kerfwise.postproc.check import check, check_program
from kerfwise.postproc.check.check import Besides
from kerfwise.postproc.check.result import DRIFT, SAME, same
from kerfwise.postproc.verdict import check_plan
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile

PLATE = nest(400, 200, part("A", rect(20, 20, 120, 120), [rect(60, 60, 30, 30)]), part("B", rect(170, 20, 120, 120)))


@cache
def planned() -> FinishedPlan:
    return plan_nest(Inputs(PLATE, load_profile()), options_for(PLATE, load_profile(), work=0.2))


def sequence() -> CutSequence:
    return planned().made.plan.sequence()


def test_rules_judge_a_plan_and_its_program_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made, profile, asked = planned().made, load_profile(), list[int]()
    judge = check.judge
    monkeypatch.setattr(check, "judge", lambda *given: (asked.append(1), judge(*given))[1])
    verdict = check_plan.judge(PLATE, made.plan, made.program, profile)
    assert len(asked) == 1
    alone = check_program(PLATE, made.program, profile)
    assert len(asked) == 2
    assert {j.id: j for j in alone.rules if j.id in profile.settings()} == {
        j.id: j for j in verdict.rules if j.id in profile.settings()
    }


def test_a_program_that_makes_other_cuts_is_judged_by_itself() -> None:
    """The program has the cuts of the plan with the first two exchanged: a hole after its outline, say."""
    made, profile = planned().made, load_profile()
    first, second, *rest = made.plan.cuts
    plan = replace(made.plan, cuts=(second, first, *rest))
    known = check_plan.check_plan(PLATE, plan, profile).by_rules
    alone, beside = (
        check_program(PLATE, made.program, profile, besides=Besides(known=k)) for k in (None, lambda: known)
    )
    assert alone == beside


def moved(cut: Cut, by_mm: float) -> Cut:
    return replace(cut, pierce=(cut.pierce[0] + by_mm, cut.pierce[1]))


def bent(cut: Cut, by: float) -> Cut:
    assert cut.lead_in is not None
    vertices = cut.lead_in.vertices.copy()
    vertices[0, 2] += by
    return replace(cut, lead_in=Curve(vertices, closed=False))


@pytest.mark.parametrize(
    ("change", "alike"),
    [
        (lambda cut: cut, True),
        (lambda cut: moved(cut, SAME / 2), True),
        (lambda cut: moved(cut, 2 * SAME), False),
        (lambda cut: bent(cut, 1e-6), True),
        (lambda cut: bent(cut, 0.2), False),
        (lambda cut: replace(cut, lead_in=None), False),
        (lambda cut: replace(cut, end_s=cut.end_s + 1), False),
        (lambda cut: replace(cut, zone=cut.zone + 1), False),
        (lambda cut: replace(cut, direction="cw" if cut.direction == "ccw" else "ccw"), False),
        (lambda cut: replace(cut, excused=("part-rigidity",)), False),
        (lambda cut: replace(cut, linked=True), False),
        (lambda cut: replace(cut, torch=2), False),
        (lambda cut: replace(cut, together="A.outer"), False),
        (lambda cut: replace(cut, way="snake1"), False),
        (lambda cut: replace(cut, tabs=(Tab((0.0, 0.0), 1.0),)), False),
        (lambda cut: replace(cut, span=Span((0.0, 0.0), (1.0, 0.0))), False),
    ],
)
def test_what_makes_cuts_the_same(change: Callable[[Cut], Cut], alike: bool) -> None:
    cuts = sequence()
    assert same(cuts, replace(cuts, cuts=(*cuts.cuts[:-1], change(cuts.cuts[-1])))) is alike


@pytest.mark.parametrize(("share", "alike"), [(DRIFT / 2, True), (4 * DRIFT, False)])
def test_times_of_a_long_program_drift_as_decimals_add_up(share: float, alike: bool) -> None:
    """A program of thirty hours, of which each cut takes as long as in the plan."""
    cuts = sequence()
    late = [replace(cut, start_s=cut.start_s + 1e5, end_s=cut.end_s + 1e5) for cut in cuts]
    drifted = [replace(c, start_s=c.start_s * (1 + share), end_s=c.end_s * (1 + share)) for c in late]
    assert same(replace(cuts, cuts=tuple(late)), replace(cuts, cuts=tuple(drifted))) is alike


def test_cuts_of_another_length_are_others_however_late_they_are() -> None:
    cuts = sequence()
    late = [replace(cut, start_s=cut.start_s + 1e5, end_s=cut.end_s + 1e5) for cut in cuts]
    longer = [*late[:-1], replace(late[-1], end_s=late[-1].end_s + 4 * SAME)]
    assert not same(replace(cuts, cuts=tuple(late)), replace(cuts, cuts=tuple(longer)))


def test_cuts_are_not_the_same_where_temperatures_were_measured_or_some_are_missing() -> None:
    cuts = sequence()
    assert not same(cuts, replace(cuts, hot_spots=()))
    assert not same(replace(cuts, hot_spots=()), cuts)
    assert not same(cuts, replace(cuts, cuts=cuts.cuts[:-1]))
    assert not same(cuts, replace(cuts, start_side="right" if cuts.start_side != "right" else "left"))
    assert not same(cuts, replace(cuts, made=1))
    holes = tuple(Pierce(cut.contour, cut.pierce, 1) for cut in cuts)
    assert not same(cuts, replace(cuts, pierces=holes))
    assert same(replace(cuts, pierces=holes), replace(cuts, pierces=holes))
    assert not same(replace(cuts, pierces=holes), replace(cuts, pierces=(replace(holes[0], before=2), *holes[1:])))


def test_every_field_of_a_cut_is_looked_at() -> None:
    """A new one is to be compared, too: see `judged_cuts`."""
    points = {"entry", "pierce", "lead_in", "lead_out", "start_s", "end_s"}
    words = {"contour", "direction", "zone", "excused", "linked", "span", "tabs", "torch", "together", "way"}
    assert {field.name for field in fields(Cut)} == points | words
    looked_at = {"cuts", "start_side", "home", "hot_spots", "made", "begun", "pierces"}
    assert {field.name for field in fields(CutSequence)} == looked_at
