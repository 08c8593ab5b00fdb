"""The most heat that cutting a contour leaves: no candidate, by any model of time, leaves more."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.simulation import path_of_plan, path_of_program
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.time_and_cost import motion_of
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.clock import contour_heat_kj, job_of_plan, read_program, with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import torch_path
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.t_max import TMaxOptions
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.profile.time_section import Time, shipped_laws
from kerfwise.tests.postproc.plans import plan_of, plate, profile

PLAIN = profile()
BLOCKS = replace(
    PLAIN,
    machine=replace(PLAIN.machine, cut_feed_mm_s=100.0),
    time=Time("blocks", shipped_laws()["bystar-3015-amg3m-1mm"]),
)
LIMITED = replace(PLAIN, time=Time("acceleration", acceleration_mm_s2=200.0))
MODELS = pytest.mark.parametrize("plant", [PLAIN, BLOCKS, LIMITED], ids=["constant", "blocks", "limited"])


def planned(sheet: Nest, plant: Profile, choice: int) -> Plan:
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
    motion = motion_of(plant, job_of_plan(planned(sheet, plant, 0), sheet, plant).nc_blocks)
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
    plan = planned(sheet, plant, choice)
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
