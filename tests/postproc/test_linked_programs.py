"""Planned chains as programs: read back in each dialect, by LinuxCNC, burnt in the simulation, and damaged."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import pytest

from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.plan.plan import LINKED, Plan
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import CheckResult, report
from kerfwise.postproc.clock import job_of_plan, job_of_program, read_program, time_job
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.nc.ordered_drawings import write_dxf
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Cuts, Links, RuleSetting
from kerfwise.rules.registry import RULES
from kerfwise.tests.metal.plant import plant as of_metal
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.models.solved import plant
from kerfwise.tests.postproc.dialects.reading import with_dialect
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside.mapped import in_linuxcnc

SHEET = replace(
    nest(
        330,
        160,
        part("A", rect(10, 10, 60, 60)),
        part("B", rect(82, 10, 60, 60)),
        part("C", circle(184, 40, 30)),
        part("D", rect(226, 10, 60, 60), [circle(256, 40, 10)]),
        part("E", rect(10, 82, 132, 50)),
    ),
    file="chain.json",
    sha256="11" * 32,
)


@cache
def given() -> Profile:
    made = plant()
    machine = replace(made.machine, pierce_time_s=2.0)
    return replace(made, cuts=Cuts(links=Links(longest_mm=60.0)), machine=machine)


@cache
def planned() -> Plan:
    asked = make_request(facts_of(SHEET, given()), given())
    return solve_and_verify(asked, given(), options_for(SHEET, given(), work=0.5)).plan


def linked(plan: Plan) -> list[str]:
    return [p.cut.contour for p in plan.cuts if p.cut.linked]


def text() -> str:
    return write_program(planned(), SHEET, given())


def judged(program: str) -> CheckResult:
    return check_program(SHEET, program, given())


def test_the_best_plan_has_chains_and_says_why() -> None:
    plan = planned()
    assert plan.solve.status == "optimal"
    assert len(linked(plan)) >= 2
    assert plan.totals.pierces == len(plan.cuts) - len(linked(plan))
    for before, after in pairwise(plan.cuts):
        assert after.linked_because.startswith(LINKED) is after.cut.linked
        if after.cut.linked:
            assert math.dist(before.cut.end, after.cut.pierce) < 1e-6
            assert after.cut.start_s == pytest.approx(before.cut.end_s, abs=1e-9)


def test_plan_and_program_pass_the_check() -> None:
    for result in (check_plan(SHEET, planned(), given()), judged(text())):
        assert result.ok, report(result)
        assert result.measured.paths == len(planned().cuts) - len(linked(planned()))


def test_it_is_quicker_than_the_plain_plan() -> None:
    plain = replace(given(), cuts=Cuts())
    without = solve_and_verify(
        make_request(facts_of(SHEET, plain), plain), plain, options_for(SHEET, plain, work=0.5)
    ).plan
    assert planned().totals.time_s < without.totals.time_s - 2
    assert linked(without) == []


def test_a_hard_lag_of_heat_leaves_no_links_between_near_parts() -> None:
    """With little else to keep, an order is found in which no two near parts follow each other."""
    free = plant(off=tuple(name for name in RULES if name != "inner-before-outer"))
    cool = RuleSetting("hard", None, HeatLagOptions(heat_radius_mm=13.0, lag_cuts=1))
    strict = replace(free, rules={**free.rules, "heat-lag": cool}, cuts=given().cuts, machine=given().machine)
    loose = replace(strict, rules=free.rules)
    plans = [
        solve_and_verify(make_request(facts_of(SHEET, p), p), p, options_for(SHEET, p, work=0.5)).plan
        for p in (strict, loose)
    ]
    near = {frozenset(pair) for pair in (("A", "B"), ("B", "C"), ("C", "D"), ("A", "E"), ("B", "E"))}
    assert not any(pair in near for pair in followed(plans[0]))
    assert any(pair in near for pair in followed(plans[1], linked_ones=True))


def followed(plan: Plan, linked_ones: bool = False) -> list[frozenset[str]]:
    """The parts of cuts that follow each other, of links alone if so asked."""
    steps = ((a, b) for a, b in pairwise(plan.cuts) if b.cut.linked or not linked_ones)
    return [frozenset((a.part, b.part)) for a, b in steps]


def test_clock_and_heat_of_plan_and_program_are_the_same() -> None:
    program = read_program(text(), SHEET, given())
    of_plan, of_program = job_of_plan(planned(), SHEET, given()), job_of_program(program, SHEET)
    assert of_plan.pierces == of_program.pierces == planned().totals.pierces
    assert of_plan.on_mm == pytest.approx(of_program.on_mm, abs=0.1)
    assert of_plan.idle_mm == pytest.approx(of_program.idle_mm, abs=0.1)
    assert of_plan.nc_blocks == of_program.nc_blocks
    times = [time_job(job, given()).times.total_s for job in (of_plan, of_program)]
    assert times[0] == pytest.approx(times[1], abs=0.05)
    burns = {burn.contour: burn for burn in path_of_plan(planned(), SHEET, given()).burns}
    for before, after in pairwise(planned().cuts):
        if after.cut.linked:
            assert burns[before.cut.contour].at_s[-1] == pytest.approx(burns[after.cut.contour].at_s[0])


def test_no_linked_cut_leaves_more_heat_than_its_zone_counts_with() -> None:
    facts = facts_of(SHEET, given())
    power_kw = given().heat.absorbed_power_w / 1000
    for cut in (planned.cut for planned in planned().cuts):
        assert power_kw * (cut.end_s - cut.start_s) <= facts.torch_heat_kj[SHEET.index[cut.contour]] + 1e-6


@pytest.mark.parametrize("name", dialect_names())
def test_every_dialect_stays_on_along_a_link(name: str) -> None:
    profile = with_dialect(given(), name)
    program = write_program(planned(), SHEET, profile)
    plain = write_program(unlinked(planned()), SHEET, profile)
    offs = [sum(line.endswith(load_dialect(name).torch_off[-1]) for line in p.splitlines()) for p in (program, plain)]
    assert offs[1] - offs[0] == len(linked(planned()))
    burns = read_program(program, SHEET, profile).burns
    assert len(burns) == planned().totals.pierces
    assert sum(burn.path.length_mm for burn in burns) == pytest.approx(planned().totals.cut_mm, abs=allowed_mm(name))


def allowed_mm(name: str) -> float:
    """0.1 mm, or five of the control's steps; beside it what chords cut off their arcs.

    A chord that is h off its arc is h / 3 shorter for each radian that it turns by, and each contour turns round once.
    """
    dialect = load_dialect(name)
    step_mm = 10.0**-dialect.decimals / dialect.scale
    chords_mm = dialect.chord_mm / 3 * 2 * math.pi * len(SHEET.contours) if dialect.arc_centre == "none" else 0.0
    return max(0.1, 5 * step_mm) + chords_mm


def unlinked(plan: Plan) -> Plan:
    return replace(plan, cuts=tuple(replace(p, cut=replace(p.cut, linked=False)) for p in plan.cuts))


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", dialect_names())
def test_linuxcnc_burns_the_plans_length(name: str) -> None:
    program = write_program(planned(), SHEET, with_dialect(given(), name))
    run = canon.run(in_linuxcnc(program, load_dialect(name).control, name))
    assert (run.error, run.warnings, run.dry_feeds) == (None, [], [])
    assert len(run.burns) == planned().totals.pierces
    assert sum(burn.length_mm for burn in run.burns) == pytest.approx(planned().totals.cut_mm, abs=allowed_mm(name))


def test_the_simulation_finds_nothing() -> None:
    assert simulate(SHEET, text(), **of_metal(given())) == []


def test_a_chain_is_one_line_of_a_drawing() -> None:
    drawn = write_dxf(planned(), SHEET, given())
    assert drawn.count("POLYLINE") == planned().totals.pierces


def test_a_link_moved_over_a_part_is_found() -> None:
    """The link makes a detour through the part that it comes from."""
    k = next(k for k, p in enumerate(planned().cuts) if p.cut.linked)
    x, y = SHEET.contour(planned().cuts[k - 1].cut.contour).polygon.centroid.coords[0]
    damaged = _before_link(f"G1 X{x:.4f} Y{y:.4f}")
    assert "no-gouging" in judged(damaged).broken()
    assert simulate(SHEET, damaged, **of_metal(given()))


def _before_link(block: str) -> str:
    """The program with a block before the first link."""
    lines = text().splitlines()
    contour = linked(planned())[0]
    at = next(k for k, line in enumerate(lines) if re.match(rf"\(CUT \d+ {re.escape(contour)} ", line))
    return "\n".join([*lines[: at + 1], block, *lines[at + 1 :], ""])


def test_a_pierce_left_out_is_found() -> None:
    """The torch stays on where the plan has it off: a link that nobody allowed."""
    lines = text().splitlines()
    off = next(k for k, line in enumerate(lines) if line.endswith("M5 $0"))
    on = next(k for k in range(off, len(lines)) if lines[k].endswith("M3 $0 S1"))
    joined = [line.replace("G0 ", "G1 ") for line in lines[off + 1 : on]]
    wait = 1 if "G4" in lines[on + 1] else 0
    damaged = "\n".join([*lines[:off], *joined, *lines[on + 1 + wait :], ""])
    found = judged(damaged)
    assert not found.ok
    assert {"links", "no-gouging", "contour-geometry"} & set(found.broken()), report(found)


def test_links_longer_than_the_profile_allows_are_found() -> None:
    shorter = replace(given(), cuts=Cuts(links=Links(longest_mm=5.0)))
    assert "links" in check_program(SHEET, text(), shorter).broken()
    assert "links" in check_plan(SHEET, planned(), replace(given(), cuts=Cuts())).broken()
