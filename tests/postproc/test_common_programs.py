"""Planned common cuts as programs: read back in each dialect, by LinuxCNC, burnt in the simulation, and damaged."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from kerfwise.encoder.torch_path import compensated
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import CheckResult, Heating, check_cuts, report
from kerfwise.postproc.clock import job_of_plan, job_of_program, read_program, time_job
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.nc.ordered_drawings import write_dxf
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Common, Cuts
from kerfwise.tests.metal.plant import plant as of_metal
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.models.solved import plant
from kerfwise.tests.postproc.dialects.reading import with_dialect
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside.mapped import in_linuxcnc

K = 1.5
SHEET = replace(
    nest(
        330,
        220,
        part("A", rect(40, 40, 100, 60)),
        part("B", rect(141.5, 40, 100, 60), [circle(190, 70, 15)]),
        part("C", rect(40, 101.5, 70, 60)),
        part("D", rect(111.5, 101.5, 130, 60)),
    ),
    file="common.json",
    sha256="44" * 32,
)
"""Two rows, the upper one staggered: on A and on D three parts meet in a T. B has a hole."""


@cache
def given() -> Profile:
    made = plant()
    machine = replace(made.machine, pierce_time_s=2.0, pierce_dwell="program")
    return replace(made, cuts=Cuts(common=Common(shortest_mm=20.0, good_side="any")), machine=machine)


@cache
def planned() -> Plan:
    return solve_and_verify(
        make_request(facts_of(SHEET, given()), given()), given(), options_for(SHEET, given(), work=0.5)
    ).plan


def text() -> str:
    return write_program(planned(), SHEET, given())


def judged(program: str) -> CheckResult:
    return check_program(SHEET, program, given())


def spans(plan: Plan) -> list[str]:
    return [p.cut.contour for p in plan.cuts if p.cut.span is not None]


def test_one_part_is_pierced_and_the_others_begin_in_kerfs() -> None:
    plan = planned()
    assert plan.solve.status == "optimal"
    assert len(spans(plan)) == 3
    assert plan.totals.pierces == 2  # the hole, and the first part
    for p in plan.cuts:
        told = [text for text in p.because if text.startswith("common edges: ")]
        assert len(told) == (p.cut.span is not None)


def test_plan_and_program_pass_the_check() -> None:
    for result in (check_plan(SHEET, planned(), given()), judged(text())):
        assert result.ok, report(result)
        assert result.measured.on_mm == pytest.approx(planned().totals.cut_mm, abs=0.2)


def test_it_is_quicker_and_cuts_less_than_the_plain_plan_of_the_same_parts() -> None:
    """Further apart, so that each can be pierced, they are cut all round."""
    apart = replace(
        SHEET,
        parts=tuple(
            part(p.id, [(x * 1.2, y * 1.2) for x, y in p.outer.curve.vertices[:, :2] / 1.2 + _shift(p.id)])
            for p in SHEET.parts
        ),
    )
    plain = replace(given(), cuts=Cuts())
    without = solve_and_verify(
        make_request(facts_of(apart, plain), plain), plain, options_for(apart, plain, work=0.5)
    ).plan
    assert spans(without) == []
    assert planned().totals.cut_mm < without.totals.cut_mm - 230
    assert planned().totals.time_s < without.totals.time_s - 9


def _shift(name: str) -> tuple[float, float]:
    return {"A": (0.0, 0.0), "B": (20.0, 0.0), "C": (0.0, 20.0), "D": (20.0, 20.0)}[name]


def test_the_plan_file_keeps_spans_and_gives_the_same_program(tmp_path: Path) -> None:
    file = tmp_path / "plan.json"
    file.write_text(planned().to_json(), encoding="utf-8")
    again = read_plan(file)
    assert spans(again) == spans(planned())
    assert write_program(again, SHEET, given()) == text()


def test_clock_and_heat_of_plan_and_program_are_the_same() -> None:
    program = read_program(text(), SHEET, given())
    of_plan = job_of_plan(planned(), SHEET, given())
    of_program = job_of_program(program, SHEET, given())
    assert of_plan.pierces == of_program.pierces == planned().totals.pierces
    assert of_plan.on_mm == pytest.approx(of_program.on_mm, abs=0.1)
    assert of_plan.idle_mm == pytest.approx(of_program.idle_mm, abs=0.1)
    times = [time_job(job, given()).times.total_s for job in (of_plan, of_program)]
    assert times[0] == pytest.approx(times[1], abs=0.05)
    burns = path_of_plan(planned(), SHEET, given()).burns
    assert sum(math.hypot(*step) for burn in burns for step in burn.xy[1:] - burn.xy[:-1]) == pytest.approx(
        planned().totals.cut_mm, abs=0.5
    )


def test_the_check_of_a_plan_has_the_torch_stand_where_it_pierces_and_nowhere_else() -> None:
    stood_s: dict[str, float] = {}

    def thermometer(heatings: Sequence[Heating]) -> None:
        stood_s.update({heating.name: heating.pierce_s for heating in heatings})

    plan = planned()
    assert check_cuts(SHEET, plan.sequence(given().home_on(SHEET)), given(), thermometer=thermometer).ok
    begun = set(spans(plan))
    assert stood_s == {p.cut.contour: 0.0 if p.cut.contour in begun else 2.0 for p in plan.cuts}


def test_no_cut_leaves_more_heat_than_its_zone_counts_with() -> None:
    facts = facts_of(SHEET, given())
    power_kw = given().heat.absorbed_power_w / 1000
    for cut in (p.cut for p in planned().cuts):
        assert power_kw * (cut.end_s - cut.start_s) <= facts.torch_heat_kj[SHEET.index[cut.contour]] + 1e-6


def waiting(name: str) -> Profile:
    """With a dialect; where its control waits at every start it does so in old kerfs, too."""
    profile = with_dialect(given(), name)
    waits = load_dialect(name).pierce_dwell == "machine"
    return replace(profile, machine=replace(profile.machine, kerf_start=not waits))


def allowed_mm(name: str) -> float:
    """0.1 mm, but a little more where the control counts in whole tenths."""
    return max(0.1, 5 * 10.0 ** -load_dialect(name).decimals / load_dialect(name).scale)


@pytest.mark.parametrize("name", dialect_names())
def test_every_dialect_says_the_same_cuts(name: str) -> None:
    program = write_program(planned(), SHEET, waiting(name))
    burns = read_program(program, SHEET, waiting(name)).burns
    assert len(burns) == len(planned().cuts)
    assert sum(burn.path.length_mm for burn in burns) == pytest.approx(planned().totals.cut_mm, abs=allowed_mm(name))


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", dialect_names())
def test_linuxcnc_burns_the_plans_length(name: str) -> None:
    program = write_program(planned(), SHEET, waiting(name))
    run = canon.run(in_linuxcnc(program, load_dialect(name).control, name))
    assert (run.error, run.warnings, run.dry_feeds) == (None, [], [])
    assert len(run.burns) == len(planned().cuts)
    assert sum(burn.length_mm for burn in run.burns) == pytest.approx(planned().totals.cut_mm, abs=allowed_mm(name))


def test_the_simulation_finds_nothing() -> None:
    assert simulate(SHEET, text(), **of_metal(given())) == []


def test_each_cut_is_one_line_of_a_drawing() -> None:
    assert write_dxf(planned(), SHEET, given()).count("POLYLINE") == len(planned().cuts)


def of_contour(name: str) -> tuple[list[str], int, int]:
    """The lines of the program, and where those of a cut begin and end."""
    lines = text().splitlines()
    begin = next(k for k, line in enumerate(lines) if re.match(rf"\(CUT \d+ {re.escape(name)} ", line))
    return lines, begin, next(k for k in range(begin, len(lines)) if re.search(r"M5\b", lines[k]))


def test_an_edge_left_out_is_found() -> None:
    """The last moves of a cut along a stretch are missing."""
    lines, _, end = of_contour(spans(planned())[-1])
    damaged = "\n".join([*lines[: end - 2], *lines[end:], ""])
    assert "every-contour-once" in judged(damaged).broken()
    assert {"left-uncut", "part-not-free"} & set(by_kind(simulate(SHEET, damaged, **of_metal(given()))))


def test_an_edge_cut_twice_is_found() -> None:
    """The last cut goes on all along the edges that its neighbours have cut."""
    last = next(p for p in reversed(planned().cuts) if p.cut.span is not None).cut
    assert last.span is not None
    lines, _, end = of_contour(last.contour)
    ring = compensated(SHEET.contour(last.contour), K).towards(last.direction)
    begin_mm, end_mm = (ring.project(at)[0] for at in (last.span.begin, last.span.end))
    rest = ring.between(end_mm, (begin_mm - end_mm) % ring.length_mm)
    moves = [f"G1 X{a:.4f} Y{b:.4f}" for a, b in rest.flatten(0.005).tolist()]
    damaged = "\n".join([*lines[:end], *moves, *lines[end:], ""])
    assert "burnt-twice" in judged(damaged).broken(), report(judged(damaged))
    assert by_kind(simulate(SHEET, damaged, **of_metal(given())))["cut-twice"] >= 1


def test_a_cut_along_a_stretch_that_comes_too_early_is_found() -> None:
    """Before its neighbour there is no kerf to begin in, and no edge cut."""
    plan = planned()
    k = next(k for k, p in enumerate(plan.cuts) if p.cut.span is not None)
    cuts = list(plan.cuts)
    cuts[k - 1], cuts[k] = cuts[k], cuts[k - 1]
    swapped = write_program(replace(plan, cuts=tuple(cuts)), SHEET, given())
    found = judged(swapped)
    assert {"pierce", "burnt-twice"} & set(found.broken()), report(found)


def test_without_the_option_such_a_program_is_refused() -> None:
    plain = replace(given(), cuts=Cuts())
    broken = check_program(SHEET, text(), plain).broken()
    assert {"pierce", "pierce-delay"} <= set(broken)


def test_where_a_machine_waits_at_every_start_each_way_costs_a_pierce() -> None:
    slow = replace(given(), machine=replace(given().machine, kerf_start=False))
    made = solve_and_verify(make_request(facts_of(SHEET, slow), slow), slow, options_for(SHEET, slow, work=0.5))
    assert made.verdict.ok
    assert made.plan.totals.pierces == len(made.plan.cuts)
    assert len(spans(made.plan)) == 3
    assert made.plan.totals.time_s == pytest.approx(planned().totals.time_s + 3 * 2.0, abs=0.5)
