"""A program heats the sheet at its own F words and for its own G4, a plan at the times that it states."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kerfwise import Nest, Plan, Profile, load_profile, read_nest, read_plan
from kerfwise.encoder.candidates import build_candidates
from kerfwise.jobs.heat_path import path_of_plan, path_of_program
from kerfwise.models.physics.heat import TimedPath, simulate
from kerfwise.models.physics.time_and_cost import motion_of
from kerfwise.postproc.clock import contour_heat_kj, job_of_plan, job_of_program, read_program, time_job, with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import torch_path
from kerfwise.rule_kit import Cut, RuleSetting, nest, part, rect
from kerfwise.rules.catalogue.t_max import TMaxOptions
from kerfwise.rules.profile.time_section import Time, shipped_laws
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_pierce_pass import HOLES, TWO_ZONES, _marks_s, planned
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

SHEET, PLANT = plate(), profile()
PLAN = with_times(plan_of(SHEET, good_cuts(SHEET), PLANT), SHEET, PLANT)
PROGRAM = write_program(PLAN, SHEET, PLANT)
PIERCE_S = PLANT.machine.pierce_time_s


def path(text: str = PROGRAM, plant: Profile = PLANT) -> TimedPath:
    return path_of_program(read_program(text, SHEET, plant))


def edited(pattern: str, change: Callable[[float], float]) -> str:
    """The program with every number that follows the pattern changed."""
    return re.sub(rf"({pattern})([\d.]+)", lambda found: f"{found[1]}{change(float(found[2])):g}", PROGRAM)


def standing(of: TimedPath) -> list[float]:
    """How long the torch stands at the start of each burn, s."""
    return [float(b.at_s[1] - b.at_s[0]) if np.array_equal(b.xy[0], b.xy[1]) else 0.0 for b in of.burns]


def moving(of: TimedPath) -> list[float]:
    return [b.seconds - stood for b, stood in zip(of.burns, standing(of), strict=True)]


def test_plan_and_program_heat_the_same_contours_at_the_same_times() -> None:
    planned, written = path_of_plan(PLAN, SHEET, PLANT), path()
    assert [b.contour for b in planned.burns] == [b.contour for b in written.burns]
    for a, b in zip(planned.burns, written.burns, strict=True):
        assert (a.at_s[0], a.at_s[-1]) == pytest.approx((b.at_s[0], b.at_s[-1]), abs=0.02)


def test_f_words_decide_how_long_a_path_is_heated() -> None:
    slow = path(edited(" F", lambda feed: feed / 2))
    assert moving(slow) == pytest.approx([2 * s for s in moving(path())])
    assert standing(slow) == pytest.approx(standing(path()))


def test_g4_decides_how_long_the_torch_stands() -> None:
    assert max(standing(path())) == PIERCE_S
    long = path(edited("G4 P", lambda seconds: seconds + 3))
    assert standing(long) == pytest.approx([s + 3 if s else 0.0 for s in standing(path())])
    assert moving(long) == pytest.approx(moving(path()))


def test_a_wait_with_the_torch_off_lets_the_sheet_cool() -> None:
    before_third = [m.start() for m in re.finditer(r"N\d+ M3 \$0", PROGRAM)][2]
    waiting, plain = path(PROGRAM[:before_third] + "G4 P40\n" + PROGRAM[before_third:]), path()
    later = [float(a.at_s[0] - b.at_s[0]) for a, b in zip(waiting.burns, plain.burns, strict=True)]
    assert later == pytest.approx([0.0, 0.0] + [40.0] * (len(plain.burns) - 2))
    assert [b.seconds for b in waiting.burns] == pytest.approx([b.seconds for b in plain.burns])


def test_pierces_that_the_dialect_leaves_to_the_machine_are_as_profiled() -> None:
    shop = replace(PLANT, machine=replace(PLANT.machine, pierce_dwell=None))
    text = write_program(PLAN, SHEET, shop)
    assert "G4 P" not in text
    silent = path(text, shop)
    assert standing(silent) == pytest.approx(standing(path()))
    assert [float(b.at_s[0]) for b in silent.burns] == pytest.approx([float(b.at_s[0]) for b in path().burns], abs=0.02)


def test_the_clock_counts_a_programs_own_words_too() -> None:
    def times(text: str) -> tuple[float, float, float]:
        found = time_job(job_of_program(read_program(text, SHEET, PLANT), SHEET, PLANT, own_feeds=True), PLANT).times
        return found.cut_s, found.pierce_s, found.total_s

    cut_s, pierce_s, total_s = times(PROGRAM)
    assert times(edited(" F", lambda feed: feed / 2)) == pytest.approx((2 * cut_s, pierce_s, total_s + cut_s))
    assert times(edited("G4 P", lambda s: 2 * s)) == pytest.approx((cut_s, 2 * pierce_s, total_s + pierce_s))
    assert (cut_s, pierce_s) == pytest.approx((PLAN.time.cut_s, PLAN.time.pierce_s), rel=2e-3) if PLAN.time else False


def test_clock_and_heat_of_plan_and_program_agree(tmp_path: Path) -> None:
    nest, plan, text = planned(tmp_path, TWO_ZONES)
    profile = load_profile(tmp_path / "plant.yaml")
    sheet, made = read_nest(nest), read_plan(tmp_path / "nest.plan.json")
    program = read_program(text, sheet, profile)
    one, other = job_of_plan(made, sheet, profile), job_of_program(program, sheet, profile)
    assert (one.pierces, one.nc_blocks) == (other.pierces, other.nc_blocks) == (len(HOLES), other.nc_blocks)
    assert one.idle_mm == pytest.approx(other.idle_mm, abs=0.01)
    timed = kerfwise("time", nest, tmp_path / "nest.nc", "-p", tmp_path / "plant.yaml", "--json")
    assert timed.err == ""
    times = json.loads(timed.out)
    assert times["total_s"] == pytest.approx(plan["totals"]["time_s"], abs=0.05)
    by_plan, by_program = path_of_plan(made, sheet, profile).seconds_on, path_of_program(program).seconds_on
    assert by_plan == pytest.approx(by_program, abs=0.05)
    assert by_plan == pytest.approx(plan["time"]["cut_s"] + plan["time"]["pierce_s"] - _marks_s(plan), abs=0.05)


PLAIN = profile()
BLOCKS = replace(
    PLAIN,
    machine=replace(PLAIN.machine, cut_feed_mm_s=100.0),
    time=Time("blocks", shipped_laws()["bystar-3015-amg3m-1mm"]),
)
LIMITED = replace(PLAIN, time=Time("acceleration", acceleration_mm_s2=200.0))
MODELS = pytest.mark.parametrize("plant", [PLAIN, BLOCKS, LIMITED], ids=["constant", "blocks", "limited"])


def plan_of_choice(sheet: Nest, plant: Profile, choice: int) -> Plan:
    """A plan of some candidate of each contour, timed by the model."""
    chosen: dict[int, Cut] = {}
    candidates = build_candidates(sheet, plant.lead_options())
    for number, contour in enumerate(sheet.contours):
        own = [c for c in candidates if c.contour == number]
        c = own[choice % len(own)]
        chosen[number] = Cut(contour.id, c.entry, c.direction, c.pierce, c.lead_in, c.lead_out, 1)
    return with_times(plan_of(sheet, tuple(chosen.values()), plant), sheet, plant)


def most_kj(sheet: Nest, plant: Profile) -> dict[str, float]:
    found = contour_heat_kj(sheet, build_candidates(sheet, plant.lead_options()), plant)
    return {c.id: kj for c, kj in zip(sheet.contours, found.tolist(), strict=True)}


def test_a_square_by_hand() -> None:
    """81.5 mm a side with the kerf, 6 mm of lead, at 25 mm/s; 0.5 s to pierce; 2 kW."""
    machine = replace(PLAIN.machine, cut_feed_mm_s=25.0, pierce_time_s=0.5)
    plant = replace(PLAIN, machine=machine, heat=replace(PLAIN.heat, absorbed_power_w=2000.0))
    sheet = nest(300, 300, part("A", rect(100, 100, 80, 80), marks=[[(110, 110), (150, 110)]]))
    round_mm = 4 * 80 + 2 * 3.14159265 * 0.75
    candidates = build_candidates(sheet, plant.lead_options())
    assert {round(c.cut_mm - round_mm, 4) for c in candidates if sheet.contours[c.contour].kind == "outer"} == {6.0}
    found = most_kj(sheet, plant)
    assert found["A.mark1"] == 0.0
    assert found["A.outer"] == pytest.approx(2.0 * ((round_mm + 6.0) / 25.0 + 0.5))


@MODELS
def test_no_candidate_leaves_more(plant: Profile) -> None:
    sheet, most = plate(), most_kj(plate(), plant)
    candidates = build_candidates(sheet, plant.lead_options())
    motion = motion_of(plant, job_of_plan(plan_of_choice(sheet, plant, 0), sheet, plant).nc_blocks)
    longest: dict[str, float] = {}
    for c in candidates:
        contour = sheet.contours[c.contour]
        if contour.kind != "mark":
            cut = Cut(contour.id, c.entry, c.direction, c.pierce, c.lead_in, c.lead_out)
            on_s = motion.run_s(torch_path(contour, cut, plant.material.kerf_mm), False)
            on_s += 0.0 if c.edge_start else plant.machine.pierce_time_s
            longest[contour.id] = max(longest.get(contour.id, 0.0), plant.heat.absorbed_power_w * on_s / 1000)
    slack = {"constant": 1.000001, "blocks": 1.03, "acceleration": 1.2}[plant.time.model]
    for contour_id, kj in longest.items():
        assert kj * (1 - 1e-6) <= most[contour_id] <= kj * slack


@MODELS
@pytest.mark.parametrize("choice", [0, 5])
def test_a_simulated_plan_and_its_program_take_up_no_more(plant: Profile, choice: int) -> None:
    sheet, most = plate(), most_kj(plate(), plant)
    plan = plan_of_choice(sheet, plant, choice)
    program = read_program(write_program(plan, sheet, plant), sheet, plant)
    for path in (path_of_plan(plan, sheet, plant), path_of_program(program)):
        for burn in path.burns:
            assert plant.heat.absorbed_power_w * burn.seconds / 1000 <= most[burn.contour] * 1.001
    found = simulate(sheet, path_of_plan(plan, sheet, plant), plant.heat, plant.material.thickness_mm)
    total_kj = sum(most.values())
    assert total_kj * 0.9 <= found.run.put_in_j / 1000 <= total_kj * 1.001


def test_the_entry_that_takes_longest_counts_wherever_it_is_listed() -> None:
    corner = nest(200, 200, part("A", rect(5, 5, 80, 80)), part("B", rect(90, 5, 80, 80)))
    candidates = build_candidates(
        corner, replace(PLAIN.lead_options(), edge_start=True, reach=(-9.0, -9.0, 300.0, 300.0))
    )
    assert any(c.edge_start for c in candidates)
    assert len({round(c.cut_mm, 3) for c in candidates}) > 1
    forth, back = (contour_heat_kj(corner, listed, PLAIN) for listed in (candidates, candidates[::-1]))
    assert forth.tolist() == back.tolist()


def test_waits_make_a_program_longer_and_so_its_feed_lower() -> None:
    rules = {**BLOCKS.rules, "t-max": RuleSetting("hard", None, TMaxOptions(dwells=True))}
    waiting = most_kj(plate(), replace(BLOCKS, rules=rules))
    assert all(waiting[name] > kj for name, kj in most_kj(plate(), BLOCKS).items() if kj)
