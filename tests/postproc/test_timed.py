"""Plans and their programs on the clock: both give the same blocks and the same times."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise import Nest, Plan, Profile
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.clock import job_of_plan, job_of_program, read_program, time_job, with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.rules.profile.plant_sections import PierceDwell
from kerfwise.rules.profile.sections import SmallHoles
from kerfwise.rules.profile.time_section import Time, shipped_laws
from kerfwise.tests.postproc.plans import cut_of, good_cuts, plan_of, plate, profile

PLAIN = profile()
BLOCKS = replace(PLAIN, time=Time("blocks", shipped_laws()["bystar-3015-amg3m-1mm"]))
LIMITED = replace(PLAIN, time=Time("acceleration", acceleration_mm_s2=500.0))
AWAY = replace(PLAIN, machine=replace(PLAIN.machine, home=(-50.0, 30.0), pierce_time_s=0.0))
SLOW_HOLES = SmallHoles(full_feed_hole=40.0, small_hole_feed=0.5)
SLOW = {
    f"slow holes, {name}": replace(of, small_holes=SLOW_HOLES)
    for name, of in (("blocks", BLOCKS), ("acceleration", LIMITED))
}
MODELS = pytest.mark.parametrize("plant", [PLAIN, BLOCKS, LIMITED, AWAY], ids=["constant", "blocks", "limited", "away"])


def made(plant: Profile) -> tuple[Nest, Plan]:
    sheet = plate()
    return sheet, plan_of(sheet, good_cuts(sheet), plant)


@pytest.mark.parametrize(
    "plant", [PLAIN, BLOCKS, LIMITED, AWAY, *SLOW.values()], ids=["constant", "blocks", "limited", "away", *SLOW]
)
def test_a_plan_and_its_program_have_the_same_blocks_and_times(plant: Profile) -> None:
    sheet, plan = made(plant)
    program = write_program(plan, sheet, plant)
    planned = job_of_plan(plan, sheet, plant)
    written = job_of_program(read_program(program, sheet, plant), sheet, plant)
    numbered = [line for line in program.splitlines() if line.startswith("N")]
    assert planned.nc_blocks == written.nc_blocks == len(numbered)
    assert (planned.pierces, planned.on_mm) == (written.pierces, pytest.approx(written.on_mm, abs=0.01))
    assert planned.idle_mm == pytest.approx(written.idle_mm, abs=0.01)
    a, b = time_job(planned, plant).times, time_job(written, plant).times
    for name in ("cut_s", "idle_s", "pierce_s"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=2e-3), name
    assert [s for span in a.spans for s in span] == pytest.approx([s for span in b.spans for s in span], rel=2e-3)


def test_constant_feed_is_the_formula_to_the_digit() -> None:
    sheet, plan = made(PLAIN)
    job, machine = job_of_plan(plan, sheet, PLAIN), PLAIN.machine
    times = time_job(job, PLAIN).times
    marked_mm = sum(run.path.length_mm for run in job.runs if run.marks)
    assert times.cut_s == pytest.approx(
        (job.on_mm - marked_mm) / machine.cut_feed_mm_s + marked_mm / machine.mark_feed_mm_s
    )
    assert times.idle_s == pytest.approx(job.idle_mm / machine.travel_mm_s)
    marks = sum(run.marks for run in job.runs)
    assert times.pierce_s == pytest.approx(job.pierces * machine.pierce_time_s + marks * machine.mark_time_s)


def test_the_feed_follows_the_blocks_of_this_very_program() -> None:
    sheet, plan = made(BLOCKS)
    job = job_of_plan(plan, sheet, BLOCKS)
    law = shipped_laws()["bystar-3015-amg3m-1mm"]
    cutting_mm = sum(run.path.length_mm for run in job.runs if not run.marks)
    marking_s = (job.on_mm - cutting_mm) / BLOCKS.machine.mark_feed_mm_s
    assert time_job(job, BLOCKS).times.cut_s == pytest.approx(cutting_mm / law.mm_s(job.nc_blocks) + marking_s)
    fewer = replace(job, nc_blocks=20)
    assert time_job(fewer, BLOCKS).times.cut_s < time_job(job, BLOCKS).times.cut_s


@MODELS
def test_the_plan_states_its_times_and_they_pass_the_check(plant: Profile, tmp_path: object) -> None:
    sheet, plan = made(plant)
    timed = with_times(plan, sheet, plant)
    assert timed.time is not None
    assert timed.totals.time_s == pytest.approx(timed.time.total_s)
    assert timed.cuts[-1].cut.end_s < timed.totals.time_s
    judged = check_plan(sheet, timed, plant)
    assert judged.rule("totals").holds
    late = replace(timed, totals=replace(timed.totals, time_s=timed.cuts[-1].cut.end_s - 1))
    assert not check_plan(sheet, late, plant).rule("totals").holds


def test_times_are_in_the_files_and_come_back(tmp_path) -> None:  # type: ignore[no-untyped-def]
    sheet, plan = made(BLOCKS)
    timed = with_times(plan, sheet, BLOCKS)
    (tmp_path / "plan.json").write_text(timed.to_json())
    again = read_plan(tmp_path / "plan.json")
    assert again.time is not None
    assert again.time.model == timed.time.model  # type: ignore[union-attr]
    assert again.to_json() == timed.to_json()
    program = write_program(again, sheet, BLOCKS)
    assert program == write_program(timed, sheet, BLOCKS)
    said = again.time.model.upper()
    assert said.endswith(f"MM/MIN AT {again.time.nc_blocks}")
    assert f"\n(TIME MODEL {said})\n" in program
    assert (tmp_path / "plan.json").read_text().count('"time": {') == 1


def test_an_untimed_plan_says_nothing_of_a_model(tmp_path) -> None:  # type: ignore[no-untyped-def]
    sheet, plan = made(PLAIN)
    assert "TIME MODEL" not in write_program(plan, sheet, PLAIN)
    (tmp_path / "plan.json").write_text(plan.to_json())
    assert read_plan(tmp_path / "plan.json").time is None


def test_an_edge_start_is_no_pierce_and_has_no_dwell() -> None:
    sheet = nest(200, 100, part("P1", rect(2, 20, 50, 50)))
    cut = cut_of(sheet.contour("P1.outer"), 0.9, "cw")
    plan = plan_of(sheet, [cut], PLAIN)
    assert cut.pierce[0] < 0
    job = job_of_plan(plan, sheet, PLAIN)
    assert job.pierces == 0
    assert time_job(job, PLAIN).times.pierce_s == 0
    written = job_of_program(read_program(write_program(plan, sheet, PLAIN), sheet, PLAIN), sheet)
    assert (written.pierces, written.nc_blocks) == (0, job.nc_blocks)


def test_a_programs_detours_and_its_own_feeds_are_read() -> None:
    """Two rapids on the way, one of them by G1 with the torch off, and a line that only a person reads."""
    sheet = nest(100, 100, part("P1", circle(50, 50, 20)))
    program = read_program(
        "%\nG21 G90\n(hello)\nG0 X30 Y0\nG1 X30 Y40 F6000\nM3 $0 S1\nG4 P0.5\nG1 X40 F600\nM5 $0\n\nG0 X0 Y0\nM2\n",
        sheet,
        PLAIN,
    )
    job = job_of_program(program, sheet)
    assert job.runs[0].travels_mm == (30.0, 40.0)
    assert job.homing_mm == pytest.approx((56.5685,))
    assert job.nc_blocks == 9
    assert program.moving_s == pytest.approx(1.0)


PLATE = plate()


def shop(who: PierceDwell | None, dialect: str = "linuxcnc-qtplasmac") -> Profile:
    return profile(machine=replace(profile().machine, pierce_dwell=who, dialect=dialect))


def written(plant: Profile) -> str:
    return write_program(plan_of(PLATE, good_cuts(PLATE), plant), PLATE, plant)


@pytest.mark.parametrize(
    ("plant", "waits"),
    [
        (shop(None), False),
        (shop("machine"), False),
        (shop("program"), True),
        (shop(None, "linuxcnc"), True),
        (shop("machine", "linuxcnc"), False),
    ],
)
def test_the_dialect_says_who_waits_and_the_profile_may_say_otherwise(plant: Profile, waits: bool) -> None:
    text = written(plant)
    assert ("G4 P0.5" in text) is waits
    assert f"(PIERCE DELAY 0.5 S, HELD BY THE {'PROGRAM' if waits else 'MACHINE'})" in text
    assert check_program(PLATE, text, plant).broken() == ()


def test_a_delay_that_comes_twice_or_never_is_refused() -> None:
    for mine, other, said in (("program", "machine", "asks for 0 s"), ("machine", "program", "asks for 0.5 s")):
        found = check_program(PLATE, written(shop(mine)), shop(other))  # type: ignore[arg-type]
        assert found.broken() == ("pierce-delay",)
        assert said in found.rule("pierce-delay").violations[1].text


def test_the_clock_counts_it_once_either_way() -> None:
    times = set()
    for who in ("machine", "program"):
        plant = shop(who)  # type: ignore[arg-type]
        plan = plan_of(PLATE, good_cuts(PLATE), plant)
        program = read_program(write_program(plan, PLATE, plant), PLATE, plant)
        for job in (job_of_plan(plan, PLATE, plant), job_of_program(program, PLATE, plant)):
            times.add(round(time_job(job, plant).times.total_s, 1))
            assert time_job(job, plant).times.pierce_s == pytest.approx(8 * 0.5 + 0.2)
        assert program.burns[-1].end_s == pytest.approx(plan.cuts[-1].cut.end_s, rel=1e-3)
    assert len(times) == 1
