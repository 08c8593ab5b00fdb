"""Random rows of copies under several torches: every plan is lawful, and what is cut together is the same cut."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations, product

import pytest
from hypothesis import HealthCheck, assume, given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.identical_parts import copies_of
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.gantry import with_further_torches
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Torches
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.tools.amount import examples


@st.composite
def rows(draw: st.DrawFn) -> tuple[Nest, Torches]:
    """A band of plates, again and again a step further, now and then without one; a few plates that have no copy."""
    axis, web = draw(st.sampled_from("xy")), draw(st.sampled_from([14, 20, 30]))
    sizes = draw(st.lists(st.sampled_from([(40, 90), (70, 70), (110, 90)]), min_size=1, max_size=3))
    holes = draw(st.lists(st.booleans(), min_size=len(sizes), max_size=len(sizes)))
    parts, pitch, count = [], 90 + web, draw(st.integers(2, 3))
    for row in range(draw(st.integers(2, 4))):
        x = 50
        for k, ((wide, high), hole) in enumerate(zip(sizes, holes, strict=True)):
            y = 50 + row * pitch
            if draw(st.integers(0, 7)) != 0:
                boxes = [(x, y, wide, high), *([(x + 10, y + 20, 20, 15)] if hole else [])]
                turned = [rect(*box) if axis == "y" else rect(box[1], box[0], box[3], box[2]) for box in boxes]
                parts.append(part(f"P{row}{k}", turned[0], turned[1:]))
            x += wide + web
    size = (500, 560) if axis == "y" else (560, 500)
    step = float(pitch * draw(st.integers(1, 2)))
    return nest(*size, *parts), Torches(count, step, "y" if axis == "y" else "x")


def plant(torches: Torches) -> Profile:
    profile = load_profile()
    return replace(profile, machine=replace(profile.machine, dialect="linuxcnc", torches=torches))


@examples(8, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows())
def test_plans_of_random_rows_are_lawful(made: tuple[Nest, Torches]) -> None:
    """The simulation burns each program besides."""
    sheet, torches = made
    profile = plant(torches)
    assume(sheet.parts)
    try:
        facts = facts_of(sheet, profile)
    except InputError as error:
        if not error.message.startswith("machine.torches"):
            raise
        return
    found = solve_and_verify(make_request(facts, profile), profile, options_for(sheet, profile, work=1))
    assert found.verdict.ok, [(j.id, j.violations[:1]) for j in found.verdict.rules if not j.holds]
    cuts = [planned.cut for planned in found.plan.cuts]
    assert sorted(cut.contour for cut in cuts) == sorted(contour.id for contour in sheet.contours)
    assert any(cut.torch > 1 for cut in cuts)
    assert check_plan(sheet, found.plan, profile).ok


def test_rows_are_taken_from_their_beginning() -> None:
    five = nest(700, 100, *(part(f"P{k}", rect(10 + 120 * k, 10, 80, 80)) for k in range(5)))
    assert copies_of(five, (120.0, 0.0), 2) == [(0, 1), (2, 3)]
    assert copies_of(five, (120.0, 0.0), 3) == [(0, 1, 2), (3, 4)]
    assert copies_of(five, (240.0, 0.0), 2) == [(0, 2), (1, 3)]
    assert copies_of(five, (120.02, 0.0), 2) == []


@pytest.mark.parametrize("other", [rect(130, 10, 80, 79.9), rect(130, 10, 79.9, 80)])
def test_what_is_nearly_a_copy_is_none(other: list[tuple[float, float]]) -> None:
    two = nest(400, 100, part("A", rect(10, 10, 80, 80)), part("B", other))
    assert copies_of(two, (120.0, 0.0), 2) == []


def test_a_copy_drawn_from_another_corner_is_one() -> None:
    corners = rect(130, 10, 80, 80)
    two = nest(400, 200, part("A", rect(10, 10, 80, 80)), part("B", [*corners[2:], *corners[:2]]))
    assert copies_of(two, (120.0, 0.0), 2) == [(0, 1)]
    facts = facts_of(two, plant(Torches(2, 120.0, "x")))
    assert facts.copies is not None
    assert [facts.nest.contours[k].id for k in range(facts.n)] == ["A.outer"]


def test_the_best_plan_is_the_best_of_all_that_the_check_passes() -> None:
    """Every order of what torch 1 cuts, in every way, is made a plan, and the check says which are lawful."""
    boxes = {"A": (50, 50), "B": (160, 50), "C": (50, 160), "D": (160, 160), "S": (50, 270)}
    sheet = nest(320, 420, *(part(name, rect(x, y, 90, 90)) for name, (x, y) in boxes.items()))
    profile = plant(Torches(2, 110.0))
    soft = {name: replace(setting, strength="off") for name, setting in profile.rules.items() if setting.weight}
    rigid = profile.rules["part-rigidity"]
    rigid = replace(rigid, options=replace(rigid.options, head_weight_mm=0.0))
    leads = replace(profile.leads, entries=2)
    profile = replace(profile, rules={**profile.rules, **soft, "part-rigidity": rigid}, leads=leads)
    facts = facts_of(sheet, profile)
    asked = make_request(facts, profile)
    found = solve(facts, asked.stated.statements, options_for(sheet, profile, work=2))
    assert (found.status, facts.n) == ("optimal", 3)
    idle_mm = []
    for order in permutations(range(facts.n)):
        for route in product(*(facts.candidates_of(k) for k in order)):
            solution = replace(found, route=route)
            plan = make_plan(facts, profile, asked.stated, solution, "search", 1)
            if any(planned.cut.excused for planned in plan.cuts):
                continue
            plan = with_times(with_further_torches(plan, facts, asked.stated, solution), sheet, profile)
            if not check_plan(sheet, plan, profile).broken():
                idle_mm.append(plan.totals.idle_mm)
    assert 0 < len(idle_mm) < 6 * 4**3
    assert found.objective == pytest.approx(min(idle_mm), abs=0.01)
