"""What zones cost is said, and is what they cost."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise.encoder.facts import zones
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import plan_without_zones
from kerfwise.jobs.display import summary
from kerfwise.jobs.explainer import Explainer
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines import solve as rounds
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.models.plan.zones_cost import ZonesCost
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, Statement

SHEET = nest(
    580, 320, *(part(f"{x}{y}", rect(20 + 170 * x, 20 + 100 * y, 120 + 20 * y, 70)) for x in range(3) for y in range(3))
)
"""Nine parts in three columns, of three widths."""


def zoned(contours: int | None, strength: str = "hard") -> Profile:
    profile = load_profile()
    rule = profile.rules["zone-order"]
    changed = replace(rule, strength=strength, options=replace(rule.options, zone_contours=contours))  # type: ignore[arg-type]
    return replace(profile, rules={**profile.rules, "zone-order": changed})


def planned(profile: Profile, and_zones: bool = True, time_s: float | None = None, sheet: Nest = SHEET) -> VerifiedPlan:
    limits = options_for(sheet, profile, work=5.0, time_s=time_s)
    return solve_and_verify(make_request(facts_of(sheet, profile), profile), profile, limits, move_zones=and_zones)


@pytest.mark.parametrize(
    "contours", [pytest.param(1, marks=pytest.mark.slow), 2, pytest.param(4, marks=pytest.mark.slow)]
)
def test_they_cost_what_the_best_plan_without_them_costs_less(contours: int) -> None:
    with_zones, without = planned(zoned(contours)).plan, planned(zoned(None, "off")).plan
    assert with_zones.solve.status == without.solve.status == "optimal"
    cost = with_zones.zones_cost
    assert cost is not None
    more_mm = with_zones.solve.objective - without.solve.objective
    assert cost.mm + cost.excuses * EXEMPTION_MM == pytest.approx(more_mm, abs=1e-6)
    assert len(cost.avoided) >= cost.excuses


@pytest.mark.slow
def test_the_program_is_the_same_and_so_is_the_answer_the_second_time() -> None:
    profile = zoned(2)
    first, second, without = planned(profile), planned(profile), planned(profile, and_zones=False)
    assert first.program == without.program
    assert first.plan.to_json() == second.plan.to_json()
    assert "zones_cost" not in json.loads(without.plan.to_json())


def test_a_limit_in_seconds_has_a_share_for_it() -> None:
    cost = planned(zoned(2), time_s=2.0).plan.zones_cost
    assert cost is not None
    assert cost.mm >= 0


@pytest.mark.parametrize("time_s", [None, 30.0])
def test_moves_that_the_clock_left_out_are_not_looked_at_for_it(
    time_s: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else a limit of 30 s took minutes, and a plan with those moves was held against one without."""
    profile = zoned(2)
    limits = options_for(SHEET, profile, work=5.0, time_s=time_s)
    asked = make_request(facts_of(SHEET, profile), profile)
    solution = rounds.solve(asked.facts, asked.stated.statements, replace(limits, time_s=None))
    goes_on: list[bool] = []

    def posed(*given: object, going: Callable[[float], bool], **named: object) -> Problem:
        goes_on.append(going(0.0))
        return make_problem(*given, going=going, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(rounds, "solve", lambda *given, **named: replace(solution, left_out=(("no-tip-travel", "-"),)))
    monkeypatch.setattr(plan_without_zones, "make_problem", posed)
    free = plan_without_zones.without_zones(asked, (), profile, solution.route, limits)
    assert free is not None
    assert free.aside == ("no-tip-travel",)
    assert plan_without_zones.zones_cost(asked, solution, free, limits) is not None
    assert goes_on == [time_s is None]


@pytest.mark.parametrize("profile", [zoned(None), zoned(2, "off")])
def test_nothing_is_said_where_there_are_no_zones(profile: Profile) -> None:
    assert planned(profile).plan.zones_cost is None


@pytest.mark.slow
def test_it_is_printed_and_read_back(tmp_path: object) -> None:
    made = planned(zoned(1))
    assert made.plan.zones_cost is not None
    assert made.plan.zones_cost.sentence in summary(made.plan, made.verdict)
    told = ZonesCost(-3.5, 2, (("A.outer", "part-rigidity"),), 1.0, ("no-tip-travel",), EXEMPTION_MM + 18_634.0)
    assert told.sentence.endswith("not proven, but within other zones 18.634 m with 1 excuse is")
    file = tmp_path / "plan.json"  # type: ignore[operator]
    file.write_text(replace(made.plan, zones_cost=told).to_json())
    assert read_plan(file).zones_cost == told


@pytest.mark.full
@pytest.mark.slow
def test_zones_without_a_number_move_where_that_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    sheet = read_json(json.dumps(make_sheet(2, 40)).encode(), ReadOptions())
    profile = zoned(None)
    stayed, moved = (planned(profile, also, sheet=sheet) for also in (False, True))
    assert stayed.plan.solve.status == moved.plan.solve.status == "optimal"
    assert stayed.facts.zone.max() > 2
    assert moved.facts.zone.tolist() != stayed.facts.zone.tolist()
    assert moved.plan.solve.objective < stayed.plan.solve.objective
    assert moved.verdict.ok
    assert moved.plan.to_json() == planned(profile, sheet=sheet).plan.to_json()
    name = moved.plan.cuts[0].cut.contour
    explained = Explainer(Inputs(sheet, profile), moved.plan).explain(name)
    assert explained == Explainer(Inputs(sheet, profile), moved.plan, moved.facts).explain(name)


@pytest.mark.full
def test_zones_do_not_move_for_a_plan_that_is_not_asked_for_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock may leave moves over parts unpriced in the one and not in the other: then that one only looks cheaper."""
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    sheet = read_json(json.dumps(make_sheet(2, 40)).encode(), ReadOptions())
    solve, asked_less = rounds.solve, list[bool]()

    def unpriced(facts: Facts, statements: Sequence[Statement], options: SolveOptions, *more: Any, **named: Any) -> Any:
        found = solve(facts, statements, options, *more, **named)
        if options.member == "search" or "start" not in named:  # without zones, or by those of geometry
            return found
        asked_less.append(True)
        return replace(found, left_out=(("no-tip-travel", "the clock"),))

    monkeypatch.setattr(rounds, "solve", unpriced)
    stayed, tried = (planned(zoned(None), also, sheet=sheet) for also in (False, True))
    assert asked_less
    assert tried.facts.zone.tolist() == stayed.facts.zone.tolist()
    assert tried.program == stayed.program


def test_the_page_on_limits_tells_them() -> None:
    page = " ".join((Path(__file__).parents[2] / "docs" / "limits.md").read_text(encoding="utf-8").split())
    assert f"within {plan_without_zones.SHARE:.0%}".replace("%", " % of the limit") in page
    assert (
        f"With more than {plan_without_zones.MOST_MOVES} contours, that plan is not asked what its single moves" in page
    )
