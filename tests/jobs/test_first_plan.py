"""A first plan at once, and plans that go on from one at hand: before an edit, under other rules, by other zones."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kerfwise
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts import zones
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.by_engine import Method, with_less_work
from kerfwise.jobs.first_plan import first_plan, plan_at_hand
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.lawful_walk import route_like
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.commands.run_cli import kerfwise as command
from kerfwise.tests.nest_file import nest_file

PROFILE = load_profile()


def row(*names: str, wide: float = 80) -> kerfwise.Nest:
    return nest(120 * len(names), 120, *(part(name, rect(20 + 110 * k, 20, wide, 80)) for k, name in enumerate(names)))


def test_a_route_is_kept_where_it_is_lawful_and_mended_where_it_is_not() -> None:
    sheet = nest(
        400, 140, part("A", rect(20, 20, 100, 100), holes=[rect(50, 50, 30, 30)]), part("B", rect(150, 20, 80, 80))
    )
    facts = facts_of(sheet, PROFILE)
    problem = make_problem(facts, make_request(facts, PROFILE).stated.statements, (0.0, 0.0))
    plain = route_like(problem, ())
    assert plain is not None
    assert not broken(problem, plain)
    assert route_like(problem, plain) == plain, "what is lawful stays, entries and all"
    for wanted in (plain[::-1], plain[1:], plain[:1], plain[1:][::-1]):
        mended = route_like(problem, wanted)
        assert mended is not None
        assert not broken(problem, mended)


def test_the_first_plan_is_lawful_and_soon_there() -> None:
    made = kerfwise.solve(row("A", "B", "C", "D"), first=True, work=30.0)
    assert made.ok
    assert made.plan.solve.status == "feasible"
    assert made.plan.solve.seconds < 0.1
    assert [dropped.rule for dropped in made.plan.dropped] == ["no-tip-travel"]
    for planned in made.plan.items:  # nobody looks what would be without an order
        unknown = f"what decides where {planned.cut.contour} is cut was not"
        assert any(why.startswith(("kept: ", unknown)) for why in planned.because)


def test_a_first_plan_draws_no_zones_and_has_those_that_a_plant_decides(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, divided = list[int](), zones._divided_within_set_limit
    monkeypatch.setattr(zones, "_divided_within_set_limit", lambda *given: (drawn.append(1), divided(*given))[1])
    sheet = row("A", "B", "C", "D")
    first = kerfwise.solve(sheet, first=True, work=1.0).plan
    assert (drawn, {planned.cut.zone for planned in first.cuts}) == ([], {1})
    kerfwise.solve(sheet, work=0.1)
    assert drawn
    decided = tmp_path / "decided.yaml"
    decided.write_text("based_on: plasma-carbon-steel\nrules: {zone-order: {zone_contours: 2}}\n", encoding="utf-8")
    assert {planned.cut.zone for planned in kerfwise.solve(sheet, decided, first=True).plan.cuts} == {1, 2}


def test_an_edit_goes_on_from_the_plan_at_hand_and_costs_no_more() -> None:
    before = kerfwise.solve(row("A", "B", "C", "D", "E"), work=0.5).plan
    edited = row("A", "C", "New", "E", wide=70)
    facts = facts_of(edited, PROFILE)
    asked, limits = make_request(facts, PROFILE), options_for(edited, PROFILE, work=0.5)
    at_hand = plan_at_hand(facts, PROFILE, limits, before, asked)
    assert at_hand is not None
    first = first_plan(asked, PROFILE, limits, at_hand, moves=True)
    assert first is not None
    best = kerfwise.solve(edited, start=before, work=0.5)
    assert best.ok
    assert best.plan.solve.objective <= first.solution.objective
    left = [facts.nest.contours[facts.candidates[c].contour].id for c in at_hand.solution.route]
    known = [name for name in left if name != "New.outer"]
    assert known == [cut.cut.contour for cut in before.cuts if cut.cut.contour in known]


def entered(plan: kerfwise.Plan) -> dict[str, tuple[str, float, float]]:
    """In cutting order: which way round each contour is cut, and where it is pierced, to 0.1 mm."""
    return {
        one.cut.contour: (one.cut.direction, round(one.cut.pierce[0], 1), round(one.cut.pierce[1], 1))
        for one in plan.cuts
    }


def test_the_first_plan_from_a_plan_enters_contours_as_that_does() -> None:
    sheet = row("A", "B", "C", "D", "E")
    old = kerfwise.solve(sheet, strategy="random", seed=3).plan
    made = kerfwise.solve(sheet, start=old, first=True)
    assert made.ok
    assert list(entered(made.plan).items()) == list(entered(old).items())
    assert list(entered(kerfwise.solve(sheet, work=0.2).plan).items()) != list(entered(old).items())


def test_it_enters_anew_what_was_moved_and_what_may_not_be_entered_so() -> None:
    sheet, names = row("A", "B", "C", "D", "E"), "ABCDE"
    old = kerfwise.solve(sheet, strategy="random", seed=3).plan
    before = entered(old)

    def changed(given: kerfwise.Nest, **more: Any) -> set[str]:
        made = kerfwise.solve(given, start=old, first=True, **more)
        assert made.ok
        return {name for name, way in entered(made.plan).items() if way != before[name]}

    boxes = [(20 + 110 * k, 40 if k == 2 else 20, 80, 80) for k in range(5)]
    moved = nest(600, 140, *(part(name, rect(*box)) for name, box in zip(names, boxes, strict=True)))
    assert changed(moved) == {"C.outer"}
    lock = {"contour": "B.outer", "entry": [210, 60]}
    assert changed(sheet, locks=[lock]) == {"B.outer"}


def test_the_zones_of_the_plan_at_hand_are_kept_where_geometry_may_choose(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = row("A", "B", "C", "D", "E", "F")
    plan = kerfwise.solve(sheet, work=0.5).plan
    cuts = tuple(replace(one, cut=replace(one.cut, zone=1 + 3 * (k > 2))) for k, one in enumerate(plan.cuts))
    facts = replace(facts_of(sheet, PROFILE), zone=np.array([1, 1, 2, 2, 3, 3]))
    asked = make_request(facts, PROFILE)
    limits = options_for(sheet, PROFILE, work=0.5)
    at_hand = plan_at_hand(facts, PROFILE, limits, replace(plan, cuts=cuts), asked)
    assert at_hand is not None
    order = [facts.candidates[c].contour for c in at_hand.solution.route]
    assert at_hand.asked.facts.zone[order].tolist() == [1, 1, 1, 2, 2, 2]
    fixed = replace(facts, options=replace(facts.options, zone_contours=2))
    at_hand = plan_at_hand(fixed, PROFILE, limits, replace(plan, cuts=cuts), replace(asked, facts=fixed))
    assert at_hand is None or (at_hand.asked.facts.zone == facts.zone).all(), "a plant has asked for these"


@pytest.mark.parametrize("seed", [2, 7])
def test_a_plan_at_hand_of_many_contours_costs_no_more_than_it_did(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its entries were chosen at the price of moves: others along the same order are cheaper without that price."""
    sheet = read_json(json.dumps(make_sheet(seed, 16)).encode(), ReadOptions())
    plan = kerfwise.solve(sheet, work=0.3).plan
    for module in ("first_plan", "adaptive_zones", "plan_without_zones"):
        monkeypatch.setattr(f"kerfwise.jobs.{module}.MOST_MOVES", 5)
    at_hand = plan_at_hand(facts_of(sheet, PROFILE), PROFILE, options_for(sheet, PROFILE, work=0.3), plan)
    assert at_hand is not None
    assert at_hand.solution.objective == pytest.approx(plan.solve.objective)
    assert kerfwise.solve(sheet, start=plan, work=0.001).plan.solve.objective <= plan.solve.objective + 1e-6


def test_a_plan_at_hand_of_many_contours_pays_for_what_its_moves_cross(monkeypatch: pytest.MonkeyPatch) -> None:
    """There is no look at all moves then: those of the route are priced, as in a problem that knows them all."""
    sheet = row("A", "B", "C", "D", "E", "F")
    plan = kerfwise.solve(sheet, work=0.5).plan
    far = replace(plan, cuts=tuple(plan.cuts[k] for k in (2, 0, 4, 1, 5, 3)))
    facts, limits = facts_of(sheet, PROFILE), options_for(sheet, PROFILE, work=0.5)
    monkeypatch.setattr("kerfwise.jobs.first_plan.MOST_MOVES", 5)
    monkeypatch.setattr("kerfwise.jobs.first_plan.STAYED_MM", -1.0)  # by its own entries no move crosses any
    at_hand = plan_at_hand(facts, PROFILE, limits, far)
    assert at_hand is not None
    assert at_hand.solution.problem is not None
    assert not len(at_hand.solution.problem.crossings)
    whole = make_problem(facts, at_hand.asked.stated.statements, limits.home_mm, limits.feeds)
    sites = whole.candidate_site[list(at_hand.solution.route)].tolist()
    assert at_hand.solution.objective == pytest.approx(route_cost(whole, sites) / 1000)
    assert at_hand.solution.objective > route_cost(at_hand.solution.problem, sites) / 1000, "moves cross parts here"


def test_a_plan_that_is_known_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even where the search finds nothing as good: no plan comes out dearer than the one that went in."""
    from kerfwise import pipeline

    sheet = row("A", "B", "C", "D")
    known = kerfwise.solve(sheet, work=0.5).plan
    solved = pipeline.solve_by

    def worse(*given: object) -> object:
        return replace(solved(*given), objective=1e6)  # type: ignore[arg-type]

    monkeypatch.setattr(pipeline, "solve_by", worse)
    asked, limits = make_request(facts_of(sheet, PROFILE), PROFILE), options_for(sheet, PROFILE, work=0.5)
    made = solve_and_verify(asked, PROFILE, limits, Method(start=known))
    assert made.plan.solve.objective == pytest.approx(known.solve.objective)


def test_what_is_not_proven_costs_no_more_than_with_less_work() -> None:
    costs = {0.1: (97.0, 50.0), 0.3: (90.0, 40.0), 1.0: (95.0, 60.0), 3.0: (99.0, 55.0)}

    def planned(work: float) -> Solution:
        def solved(share: float) -> Solution:
            if share * work < 0.2:
                raise RulesConflict("none found", ())
            cost, bound = costs[round(share * work, 3)]
            return Solution((0,), cost, bound, "optimal" if cost == bound else "feasible", "search", str(bound), 1.0)

        return with_less_work(solved, 10, SolveOptions(work=work))

    assert [planned(work).objective for work in (0.3, 1.0, 3.0)] == [90.0, 90.0, 90.0]
    assert (planned(3.0).bound, planned(3.0).proved_by) == (60.0, "60.0")
    costs[3.0] = (90.0, 90.0)
    assert planned(3.0).status == "optimal"
    costs[3.0] = (93.0, 90.0)
    assert planned(3.0).status == "optimal", "the bound proves what less work has found"


def test_what_the_portfolio_alone_can_do_is_said() -> None:
    with pytest.raises(InputError, match="by the engine portfolio alone"):
        kerfwise.solve(row("A"), first=True, engine="ideals")
    with pytest.raises(InputError, match="by the engine portfolio alone"):
        kerfwise.solve(row("A"), first=True, strategy="random")


def test_a_plan_of_another_nest_is_no_start() -> None:
    other = kerfwise.solve(row("X", "Y"), work=0.2).plan
    made = kerfwise.solve(row("A", "B"), start=other, work=0.2)
    assert made.ok


def test_the_command_goes_on_from_a_plan_too(tmp_path: Path) -> None:
    file, plan, damaged = (str(tmp_path / name) for name in ("row.json", "row.plan.json", "damaged.plan.json"))
    corners = [[20, 20], [100, 20], [100, 100], [20, 100]]
    nest_file(file, [{"id": "A", "outer": corners}, {"id": "B", "outer": [[x + 110, y] for x, y in corners]}])
    words = ["solve", file, "--no-job", "--work", "0.05", "-o", str(tmp_path / "row.nc"), "--plan"]
    assert command(*words, plan).code == 0
    words.append(str(tmp_path / "again.plan.json"))
    assert command(*words, "--start", plan).code == 0
    Path(damaged).write_text("{}", encoding="utf-8")
    refused = command(*words, "--start", damaged)
    assert refused.code == 2
    assert "damaged.plan.json: not a plan" in refused.err


@pytest.mark.full
@pytest.mark.parametrize(("seed", "contours"), [(1, 115), (2, 308)])
def test_first_plans_of_large_plates_are_near_the_best(seed: int, contours: int, tmp_path: Path) -> None:
    file = tmp_path / "plate.json"
    file.write_text(json.dumps(make_sheet(seed, contours)))
    first, best = (kerfwise.solve(file, first=also, work=1.0) for also in (True, False))
    assert first.ok
    assert first.plan.solve.excuses <= best.plan.solve.excuses + 1
    assert first.plan.totals.idle_mm < 1.2 * best.plan.totals.idle_mm
