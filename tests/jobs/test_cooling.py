"""Plans that keep the rule t-max: by another order, by waits, or not at all and with the reason."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import kerfwise
import kerfwise.models.engines.solve
from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs import heat_control
from kerfwise.jobs.heat_control import too_hot
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.pacing import Heated, Pacing, pace
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.pipeline import VerifiedPlan, plan_request, solve_and_verify, verified
from kerfwise.postproc.clock import job_of_program, read_program, time_job
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.t_max import TMaxOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.profile.time_section import Time
from kerfwise.rules.rule import TemperatureLimit

PAIR = nest(420, 160, part("A", rect(40, 40, 60, 80)), part("B", rect(126, 40, 60, 80)))
TRIO = nest(700, 160, part("A", rect(40, 40, 60, 80)), part("B", rect(126, 40, 60, 80)),
            part("C", rect(500, 20, 180, 120)))  # fmt: skip
KEPT = ("cut-direction", "pierce", "inner-before-outer", "part-contiguous")


def plant(limit_c: float, dwells: bool = False, longest_s: float = 600.0) -> Profile:
    profile = load_profile()
    rules = {k: s if k in KEPT else RuleSetting("off", None, s.options) for k, s in profile.rules.items()}
    rules["t-max"] = RuleSetting("hard", None, TMaxOptions(limit_c, dwells, longest_s))
    return replace(profile, rules=rules, leads=replace(profile.leads, entries=2))


def made(sheet: Nest, profile: Profile) -> VerifiedPlan:
    limits = options_for(sheet, profile, work=0.2)
    return solve_and_verify(make_request(facts_of(sheet, profile), profile), profile, limits)


def order(plan: VerifiedPlan) -> list[str]:
    return [planned.part for planned in plan.plan.cuts]


COOL, HOT = plant(1000.0), plant(88.4, dwells=True)


@pytest.fixture
def one_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """No other order is asked for, so that nothing but a wait can help."""
    monkeypatch.setattr(heat_control, "ROUNDS", 1)


def test_a_limit_that_is_far_away_changes_nothing() -> None:
    free = replace(COOL, rules={**COOL.rules, "t-max": RuleSetting("off", None, TMaxOptions())})
    plain, limited = made(TRIO, free), made(TRIO, COOL)
    assert [p.cut.contour for p in plain.plan.cuts] == [p.cut.contour for p in limited.plan.cuts]
    assert (plain.plan.solve.objective, plain.plan.solve.status) == (limited.plan.solve.objective, "optimal")
    assert "G4 P" not in limited.program  # the control waits for the pierce
    assert all(planned.dwell_s == 0 for planned in limited.plan.cuts)


def test_waits_stand_in_plan_and_program_and_are_counted(one_order: None, tmp_path: object) -> None:
    found = made(PAIR, HOT)
    first, second = found.plan.cuts
    assert (first.dwell_s, found.verdict.ok) == (0.0, True)
    assert 0 < second.dwell_s <= 600
    travel_s = found.plan.time.idle_s if found.plan.time else 0.0
    assert second.cut.start_s - first.cut.end_s == pytest.approx(second.dwell_s, abs=travel_s)
    assert found.program.count(f"G4 P{second.dwell_s:g}\n") == 1
    assert re.fullmatch(
        rf"waits {second.dwell_s:g} s first: without, {second.cut.contour} makes (part [AB]|the metal between parts) "
        r"[\d.]+ °C hot at \(\d+, \d+\); t-max asks for 88\.4 °C, less 1 K to be sure",
        second.because[-1],
    )
    assert f"WAITS FOR METAL TO COOL 1, 0 H 0{int(second.dwell_s + 1) // 60} MIN" in found.program
    assert found.plan.time is not None
    assert found.plan.time.dwell_s == pytest.approx(second.dwell_s)
    assert found.plan.totals.time_s == pytest.approx(found.plan.time.total_s)
    program = job_of_program(read_program(found.program, PAIR, HOT), PAIR)
    assert time_job(program, HOT).times.total_s == pytest.approx(found.plan.totals.time_s, rel=1e-3)
    file = tmp_path / "plan.json"  # type: ignore[operator]
    file.write_text(found.plan.to_json(), encoding="utf-8")
    assert [p.dwell_s for p in read_plan(file).cuts] == [0.0, pytest.approx(second.dwell_s)]


def test_the_check_misses_a_wait_that_is_gone_and_refuses_one_that_is_too_long(one_order: None) -> None:
    found = made(PAIR, HOT)
    wait = re.search(rf"N\d+ G4 P{found.plan.cuts[1].dwell_s:g}\n", found.program)
    assert wait is not None
    hasty = found.program.replace(wait[0], "")
    assert check_program(PAIR, hasty, HOT).broken() == ("t-max",)
    slow = found.program.replace(wait[0], wait[0].replace("G4 P", "G4 P1"))
    assert check_program(PAIR, slow, plant(200.0, True, 2.0)).broken() == ("pierce-delay",)
    hasty_plan = replace(found.plan, cuts=tuple(_at_once(planned) for planned in found.plan.cuts), rules=())
    assert "t-max" in check_plan(PAIR, hasty_plan, HOT).broken()


def _at_once(planned: object) -> object:
    cut = planned.cut  # type: ignore[attr-defined]
    moved = replace(cut, start_s=cut.start_s - planned.dwell_s, end_s=cut.end_s - planned.dwell_s)  # type: ignore[attr-defined]
    return replace(planned, cut=moved, dwell_s=0.0)  # type: ignore[type-var]


def test_without_waits_the_answer_says_which_would_do(one_order: None) -> None:
    with pytest.raises(
        RulesConflict, match=r"t-max: no plan was found that keeps the metal at 88.4 °C or less"
    ) as found:
        made(PAIR, plant(88.4))
    without, waits = found.value.reasons
    assert re.fullmatch(r"the one order tried gets to [\d.]+ °C without waits: [AB]\.outer makes .*", without)
    assert re.search(
        r"waits of [\d.]+ s in all would keep it \([\d.]+ s before [AB]\.outer\), but dwells are not", waits
    )
    with pytest.raises(RulesConflict, match=r"but longest_dwell is 0\.5 s"):
        made(PAIR, plant(88.4, dwells=True, longest_s=0.5))


def test_waits_that_are_too_short_by_the_programs_clock_alone() -> None:
    spot = HotSpot(95.0, (100.0, 80.0), 30.0, "A")
    paced = Pacing((Heated("B.outer", spot, 40.0, 87.0),), 87.0, {"B.outer": 40.0})
    error = too_hot([("B.outer", spot)], [paced], TemperatureLimit("t-max", 88.4, True, 40.0))
    assert error.reasons == (
        "the one order tried gets to 95.0 °C without waits: B.outer makes part A 95.0 °C hot at (100, 80)",
        "waits of 40.0 s in all would keep it (40.0 s before B.outer), but by the program's own times it takes more "
        "than longest_dwell, 40 s: give t-max {dwells: true, longest_dwell: 61 s}",
    )


def test_no_other_order_is_asked_for_once_somebody_has_had_enough() -> None:
    asked: list[str] = []

    def enough(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        asked.append(engine)
        return engine != "t-max"

    profile = HOT
    limits = options_for(PAIR, profile, work=0.2)
    request = make_request(facts_of(PAIR, profile), profile)
    found = verified(plan_request(request, profile, limits, progress=enough), profile)
    assert found.verdict.ok
    assert asked.count("t-max") == 1


def test_where_another_order_is_not_found_in_time_the_first_may_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    solve = kerfwise.models.engines.solve.solve
    found: list[object] = []

    def once(*given: Any, **named: Any) -> Any:
        if found:
            raise RulesConflict("no time left")
        found.append(None)
        return solve(*given, **named)

    monkeypatch.setattr("kerfwise.models.engines.solve.solve", once)
    assert made(PAIR, HOT).plan.waits


def test_where_no_wait_helps_the_least_temperature_is_told() -> None:
    with pytest.raises(RulesConflict) as found:
        made(PAIR, plant(40.0, dwells=True))
    assert re.match(r"no wait helps: the least temperature that was reached is \d\d\.\d °C", found.value.reasons[1])


@pytest.mark.slow
def test_something_else_is_cut_while_metal_cools() -> None:
    free, found = made(TRIO, _from_above(COOL)), made(TRIO, _from_above(plant(88.4)))
    assert (order(free), order(found)) == (["A", "B", "C"], ["A", "C", "B"])
    assert found.verdict.ok
    assert found.plan.solve.objective == pytest.approx(found.plan.totals.idle_mm, abs=0.1)
    assert found.plan.solve.bound == pytest.approx(free.plan.solve.objective, abs=0.1)
    assert (found.plan.solve.status, free.plan.solve.status) == ("feasible", "optimal")


def _from_above(profile: Profile) -> Profile:
    return replace(profile, machine=replace(profile.machine, home=(0.0, 160.0)))


def test_waits_hold_by_every_model_of_time(one_order: None) -> None:
    limited = replace(HOT, time=Time("acceleration", acceleration_mm_s2=2000.0))
    found = made(PAIR, limited)
    assert found.verdict.ok
    assert found.plan.cuts[1].dwell_s > 0


@pytest.mark.full
@pytest.mark.slow
def test_the_temperature_without_waits_is_that_of_the_plan_as_it_stands(one_order: None) -> None:
    """Burn by burn a plan is looked at with the waits before; the answer is about none at all."""
    row = read_nest(Path(kerfwise.__file__).parent / "examples" / "nests" / "e1x_6.json")
    free = load_profile()
    profile = replace(free, rules={**free.rules, "t-max": RuleSetting("hard", None, TMaxOptions(105.0))})
    path = path_of_plan(made(row, free).plan, row, free)
    hottest = simulate(row, path, profile.heat, profile.material.thickness_mm)
    waited = pace(row, path, profile.heat, 6.0, 104.0, 3600.0, hottest.grid)
    assert max(hot.spot.peak_c for hot in waited.heated) < hottest.peak_c - 0.1
    with pytest.raises(RulesConflict) as found:
        made(row, profile)
    assert f"gets to {hottest.peak_c:.1f} °C without waits" in found.value.reasons[0]
