"""Explanations: whole texts for a small plate, and every difference in mm against trying all entries."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError, Lock, Nest
from kerfwise.jobs.request import facts_of
from kerfwise.models.plan.explain.alternatives import PositionCosts, blocking_orders, nearest_orders
from kerfwise.models.plan.explain.context import PlanContext, make_context
from kerfwise.models.plan.explain.explain import as_text, explain, explanation_as_json
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.rule_kit import About, AtLeast, Before, Facts, Forbid, RuleSetting, Statement, circle, nest, part, rect
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.problems import ABOUT, problem
from kerfwise.tests.models.solved import QUIET, plant, proven_plan
from kerfwise.tests.tools.amount import examples

GOLDEN = Path(__file__).parent / "golden"
PLATE = nest(
    400,
    220,
    part("P1", rect(10, 10, 80, 80), [circle(50, 50, 15)]),
    part("P2", rect(110, 10, 80, 80)),
    part("P3", rect(210, 10, 80, 80)),
    part("P4", rect(10, 120, 80, 80)),
)


@pytest.mark.parametrize("contour", ["P1.hole1", "P1.outer", "P3.outer", "P4.outer"])
def test_whole_text(contour: str) -> None:
    profile = plant(Lock(contour="P4.outer", entry=(50.0, 120.0)))
    facts, stated, plan = proven_plan(PLATE, profile)
    told = as_text(explain(facts, profile, stated, plan, contour), everything=contour == "P1.hole1")
    assert told + "\n" == (GOLDEN / f"{contour}.txt").read_text()


def test_the_heat_of_a_zone_that_has_a_budget() -> None:
    profile = plant()
    options = replace(profile.rules["zone-order"].options, zone_heat_kj=25.0)
    hot = replace(profile, rules={**profile.rules, "zone-order": RuleSetting("hard", None, options)})
    facts, stated, plan = proven_plan(PLATE, hot)
    told = explain(facts, hot, stated, plan, "P1.hole1")
    assert told.zone_heat_kj == facts.zone_heat_kj[0] == pytest.approx(facts.torch_heat_kj[facts.zone == 1].sum())
    assert f"zone 1 takes up {told.zone_heat_kj:.1f} kJ at the most, of a budget of 25 kJ" in as_text(told)
    facts, stated, plan = proven_plan(PLATE, profile)
    assert "budget" not in as_text(explain(facts, profile, stated, plan, "P1.hole1"))


def test_as_data() -> None:
    profile = plant()
    facts, stated, plan = proven_plan(PLATE, profile)
    told = json.loads(explanation_as_json(explain(facts, profile, stated, plan, "P2.outer")))
    assert told["contour"] == "P2.outer"
    assert told["earlier"][0]["about"]["rule"] == "level-ahead"
    assert told["entry"]["lawful"][0]["more_um"] > 0


@pytest.mark.parametrize("earlier", [True, False])
def test_the_nearest_orders_of_all_contours_are_those_of_each(earlier: bool) -> None:
    profile = plant()
    facts, stated, plan = proven_plan(PLATE, profile)
    setting = make_context(facts, profile, stated, plan)
    each = {c: blocking_orders(setting, c, earlier) for c in range(facts.n)}
    found = nearest_orders(setting, earlier)
    assert len(found) > 1
    assert found == {c: holds[0] for c, holds in each.items() if holds}


def test_unknown_contour() -> None:
    profile = plant()
    facts, stated, plan = proven_plan(PLATE, profile)
    with pytest.raises(InputError, match=r"unknown contour 'P2.oter': did you mean 'P2.outer'"):
        explain(facts, profile, stated, plan, "P2.oter")


def test_plan_of_another_nest() -> None:
    profile = plant()
    facts, stated, plan = proven_plan(PLATE, profile)
    with pytest.raises(InputError, match="not one of this nest") as caught:
        explain(facts, profile, stated, replace(plan, cuts=plan.cuts[1:]), "P2.outer")
    assert caught.value.details == (f"the plan does not cut {plan.cuts[0].cut.contour}",)


def test_what_has_changed_since_is_noted() -> None:
    profile = plant()
    facts, stated, plan = proven_plan(PLATE, profile)
    first = plan.cuts[0]
    moved = replace(first, cut=replace(first.cut, pierce=(first.cut.pierce[0] + 0.01, first.cut.pierce[1])))
    old = replace(plan, nest={"sha256": "other"}, cuts=(moved, *plan.cuts[1:]))
    assert explain(facts, profile, stated, old, "P2.outer").notes == (
        "the nest is not the one the plan was made with (its sha256 differs)",
        f"{first.cut.contour} is cut in a way that no candidate of this profile is; the nearest lawful one stands in "
        "for it",
    )


def test_contours_cut_in_ways_of_another_profile_are_noted_in_one_sentence() -> None:
    profile = plant()
    facts, stated, plan = proven_plan(PLATE, profile)
    off = [replace(p, cut=replace(p.cut, pierce=(p.cut.pierce[0] + 0.01, p.cut.pierce[1]))) for p in plan.cuts]
    names = ", ".join(p.cut.contour for p in plan.cuts)
    assert explain(facts, profile, stated, replace(plan, cuts=tuple(off)), "P2.outer").notes == (
        f"{names} are cut in a way that no candidate of this profile is; the nearest lawful ones stand in for them",
    )


@st.composite
def plates(draw: st.DrawFn) -> Nest:
    """Up to four rectangles in a row of two lanes, one with a hole."""
    parts = []
    for k in range(draw(st.integers(2, 4))):
        width, height = draw(st.integers(30, 70)), draw(st.integers(30, 70))
        x, y = 20 + 100 * k, draw(st.sampled_from([20, 60, 120]))
        holes = [circle(x + width / 2, y + height / 2, 9)] if k == 1 else []
        parts.append(part(f"P{k}", rect(x, y, width, height), holes))
    return nest(440, 220, *parts)


@pytest.mark.slow
@examples(25)
@given(plates(), st.sampled_from(["level-ahead", "zone-order"]), st.data())
def test_every_difference_is_that_of_the_best_entries(plate: Nest, off: str, data: st.DataObject) -> None:
    profile = plant(off=(*QUIET, off))
    profile = replace(profile, leads=replace(profile.leads, entries=2))
    facts = facts_of(plate, profile)
    bare = state_rules(facts, profile)
    extras = replace(bare, statements=(*bare.statements, *data.draw(_about_entries(facts))))
    facts, stated, plan = proven_plan(plate, profile, extras)
    setting = make_context(facts, profile, stated, plan)
    contour = data.draw(st.sampled_from([c.id for c in plate.contours]))
    told = explain(facts, profile, stated, plan, contour)
    number = plate.index[contour]
    for way in (*told.entry.lawful, *told.entry.unlawful):
        same = [c for c in facts.candidates_of(number) if facts.candidates[c].pierce == way.pierce]
        costs = [list(_costs(setting, setting.order, number, site)) for site in setting.problem.candidate_site[same]]
        assert way.more_um in [min(found) - setting.cost if found else None for found in costs]
        assert way.more_um is not None or way.against
    for move in told.moves:
        unit = [plate.index[name] for name in move.moved]
        rest = [c for c in setting.order if c not in unit]
        slot = move.place - 1 - unit.index(number)
        order = (*rest[:slot], *unit, *rest[slot:])
        costs = list(_costs(setting, order))
        assert bool(costs) == (not move.breaks)
        if costs:
            assert move.more_um == min(costs) - setting.cost


@st.composite
def _about_entries(draw: st.DrawFn, facts: Facts) -> tuple[Statement, ...]:
    """Statements on single candidates, at most one a contour, so that other candidates stay lawful."""
    made: list[Statement] = []
    for contour in range(facts.n):
        candidate = draw(st.sampled_from(facts.candidates_of(contour)))
        other = draw(st.integers(0, facts.n - 1))
        about = About("test", (), f"a statement on candidate {candidate}")
        weight = draw(st.sampled_from([None, 15.0]))
        match draw(st.sampled_from(["none", "forbid", "before", "after"])):
            case "forbid":
                made.append(Forbid(candidate, about, weight))
            case "before" if other != contour:
                made.append(AtLeast((Before(contour, other),), (1,), 1, about, candidate, weight))
            case "after" if other != contour:
                made.append(AtLeast((Before(other, contour),), (1,), 1, about, candidate, weight))
    return tuple(made)


def _costs(setting: PlanContext, order: tuple[int, ...], contour: int | None = None, pinned: int = -1) -> Iterator[int]:
    """What every lawful choice of entries along an order costs."""
    layers = [[s for s in setting.problem.sites(c) if c != contour or s == pinned] for c in order]
    for route in product(*layers):
        if not broken(setting.problem, route):
            yield route_cost(setting.problem, route)


def test_an_order_without_a_lawful_way_has_no_cost_though_nothing_is_moved() -> None:
    """The first contour is not to be cut before the second: no entry helps the plan's own order."""
    asked = Condition(0, (1,), (1,), 1, ABOUT)
    two = problem([[(10.0, 0.0), (20.0, 0.0)], [(30.0, 0.0)]], conditions=[asked])
    setting: Any = SimpleNamespace(
        problem=two, order=(0, 1), conditions={0: (asked,)}, stated=SimpleNamespace(statements=())
    )
    along = PositionCosts(setting)
    assert along.moved((0, 1)) is None
    assert along.pinned(0, 0) is None
    assert along.moved((1, 0)) == 60_000
