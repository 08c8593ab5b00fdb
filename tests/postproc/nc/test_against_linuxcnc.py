"""LinuxCNC's own interpreter accepts our programs and makes of them the paths that the plan asks for."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.clock import read_program
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.nc.gcode import GcodeWriter
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import torch_path
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.dialects.reading import apart_mm
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile, with_tabs
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import examples

pytestmark = pytest.mark.linuxcnc

TOLERANCE_MM = 0.01
PLATE, PROFILE = plate(), profile()
PLAN = plan_of(PLATE, good_cuts(PLATE), PROFILE)


def differences(plan: Plan, nest: Nest, profile: Profile, run: canon.Run) -> list[str]:
    """Where what the machine would do is not what the plan says."""
    found = [*run.warnings, *([run.error] if run.error else [])]
    machine, at = profile.machine, profile.machine.home
    if len(run.burns) != len(plan.cuts):
        return [*found, f"{len(run.burns)} paths for {len(plan.cuts)} cuts"]
    travels = iter([*run.rapids, None])
    for planned, burn in zip(plan.cuts, run.burns, strict=True):
        cut, mark = planned.cut, planned.kind == "mark"
        path = torch_path(nest.contour(cut.contour), cut, profile.material.kerf_mm)
        share = nest.contour(cut.contour).feed_share
        feed = 60 * (machine.mark_feed_mm_s if mark else machine.cut_feed_mm_s * share)
        start, end = next(travels) or ((0, 0), (0, 0))
        if max(math.dist(at, start), math.dist(burn.pierce, end), math.dist(cut.pierce, end)) > TOLERANCE_MM:
            found.append(f"{cut.contour}: travels from {start} to {end}")
        if apart_mm(path, burn.points) > TOLERANCE_MM or abs(path.length_mm - burn.length_mm) > TOLERANCE_MM:
            found.append(f"{cut.contour}: the path is {apart_mm(path, burn.points):.4f} mm off")
        if burn.tool != (1 if mark else 0) or burn.feeds_mm_min != [pytest.approx(feed, abs=1e-3)]:
            found.append(f"{cut.contour}: tool {burn.tool} at {burn.feeds_mm_min} mm/min")
        at = burn.points[-1]
    if run.position != machine.home or math.dist(at, run.rapids[-1][0]) > TOLERANCE_MM or run.dry_feeds:
        found.append("does not travel home")
    return found


def test_the_program_does_what_the_plan_says() -> None:
    run = canon.run(write_program(PLAN, PLATE, PROFILE))
    assert differences(PLAN, PLATE, PROFILE, run) == []
    assert run.ended == "M2"
    assert run.arc_mismatch_mm < 3e-4
    assert run.idle_mm == pytest.approx(PLAN.totals.idle_mm, abs=0.01)
    assert sum(b.length_mm for b in run.burns) == pytest.approx(PLAN.totals.cut_mm, abs=0.01)
    assert run.dwell_s == pytest.approx(8 * 0.5 + 0.2)


def test_another_home_and_kerf() -> None:
    plant = profile(
        machine=replace(PROFILE.machine, home=(-50.0, 210.5), pierce_time_s=0.0, mark_time_s=0.0),
        material=replace(PROFILE.material, kerf_mm=0.3),
    )
    plan = plan_of(PLATE, good_cuts(PLATE, 0.3), plant)
    text = write_program(plan, PLATE, plant)
    # the machine of the test stands at the origin, not at the plant's home
    home = f"G0 X{plant.machine.home[0]} Y{plant.machine.home[1]}\n"
    run = canon.run(home + text)
    run.rapids.pop(0)
    assert differences(plan, PLATE, plant, run) == []
    assert run.dwell_s == 0


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text.replace("G1 X64 Y19.25", "G1 X64 Y19.3"),
        lambda text: text.replace("M5 $0", "", 1),
        lambda text: text.replace("F2500", "F2400", 1),
        lambda text: text.replace("M3 $1", "M3 $0"),
        lambda text: text.replace("G0 X0 Y0", "G0 X0 Y1"),
        lambda text: text.replace("G2 X19.25 Y20 I0", "G2 X19.25 Y20 I4"),
    ],
)
def test_the_comparison_can_fail(damage: object) -> None:
    good = write_program(PLAN, PLATE, PROFILE)
    bad = damage(good)  # type: ignore[operator]
    assert bad != good
    assert differences(PLAN, PLATE, PROFILE, canon.run(bad)) != []


def test_a_machine_that_dwells_by_itself() -> None:
    plant = profile(machine=replace(PROFILE.machine, pierce_dwell=None))
    assert canon.run(write_program(PLAN, PLATE, plant)).dwell_s == 0
    assert canon.run(write_program(PLAN, PLATE, PROFILE)).dwell_s > 0


@pytest.mark.parametrize("name", list(shipped_profiles()))
def test_every_shipped_profile_has_a_program_that_linuxcnc_reads(name: str) -> None:
    plant = load_profile(name)
    plate = plant.as_cut(PLATE)
    plan = plan_of(plate, good_cuts(plate, plant.material.kerf_mm), plant)
    text = write_program(plan, plate, plant)
    run = canon.run(text)
    assert differences(plan, plate, plant, run) == []
    assert run.ended == "M2"
    # and the check's own reader makes the same of it
    program = read_program(text, plate, plant)
    assert [burn.tool for burn in program.burns] == [burn.tool for burn in run.burns]
    assert program.idle_mm == pytest.approx(run.idle_mm, abs=1e-3)
    assert [b.path.length_mm for b in program.burns] == pytest.approx([b.length_mm for b in run.burns], abs=1e-2)
    (home,) = [c for c in run.comments if c.startswith("PIERCE DELAY")]
    assert home.endswith("MACHINE" if run.dwell_s == 0 else "PROGRAM")


def test_linuxcnc_reads_a_program_with_slits() -> None:
    """A plate with a slot 1 mm wide: the slit is led into, runs along the slot, and then the contour is cut."""
    plant = load_profile(Path(__file__).parents[3] / "examples" / "profiles" / "narrow-slots.yaml")
    rows = [(20, 20), (100, 20), (100, 120), (60.5, 120), (60.5, 60), (59.5, 60), (59.5, 120), (20, 120)]
    drawn = nest(120, 150, part("P", rows))
    asked = make_request(facts_of(drawn, plant), plant)
    made = solve_and_verify(asked, plant, SolveOptions(work=1, home_mm=plant.machine.home))
    run = canon.run(made.program)
    assert [planned.kind for planned in made.plan.cuts] == ["slit", "outer"]
    assert differences(made.plan, plant.as_cut(drawn), plant, run) == []
    assert run.burns[0].points[-1] == pytest.approx((60, 60.75), abs=1e-3)


@pytest.mark.parametrize(("name", "burns"), [("laser-st10kp-2mm", 6), ("plasma-carbon-steel", 2)])
def test_linuxcnc_reads_a_program_with_tabs(name: str, burns: int) -> None:
    """A plate and a disc with tabs: the torch is on for as long as the plan says, and off over each tab."""
    plant = with_tabs(name, width_mm=0.8)
    drawn = nest(250, 120, part("A", rect(40, 30, 80, 50)), part("C", circle(170, 60, 30)))
    made = solve_and_verify(
        make_request(facts_of(drawn, plant), plant), plant, SolveOptions(work=1, home_mm=plant.machine.home)
    )
    run = canon.run(made.program)
    assert (run.error, run.warnings, len(run.burns)) == (None, [], burns)
    assert sum(burn.length_mm for burn in run.burns) == pytest.approx(made.plan.totals.cut_mm, abs=0.1)
    off_mm = plant.material.kerf_mm + 0.8
    gaps = [math.dist(a.points[-1], b.pierce) for a, b in pairwise(run.burns)]
    at_tabs = [gap for gap in gaps if gap < 5]
    assert at_tabs == pytest.approx([off_mm] * (burns - 2), abs=0.01)


bulges = st.one_of(
    st.just(0.0),
    st.floats(-2.5, 2.5).map(lambda b: round(b, 6)),
    st.sampled_from([1.0, -1.0, 1e-3, -1e-4, 1e-5, 1e-7, 0.999999, 40.0, -400.0]),
)
steps = st.one_of(st.floats(-300, 300), st.floats(-0.02, 0.02), st.just(0.0))


@pytest.mark.slow
@examples(40)
@given(
    st.tuples(st.floats(-5000, 5000), st.floats(-5000, 5000)),
    st.lists(st.tuples(steps, steps, bulges), min_size=1, max_size=12),
)
def test_any_path_survives_rounding(start: canon.Point, moves: list[tuple[float, float, float]]) -> None:
    rows = [(*start, 0.0)]
    for dx, dy, bulge in moves:
        rows[-1] = (*rows[-1][:2], bulge if math.hypot(dx, dy) * abs(bulge) < 1000 else 0.0)
        rows.append((rows[-1][0] + dx, rows[-1][1] + dy, 0.0))
    path = Curve.of(rows, closed=False)
    x, y = (round(v, 4) for v in start)
    blocks = GcodeWriter(load_dialect("linuxcnc-qtplasmac"), (x, y)).path(path, 40.0)
    run = canon.run("\n".join([f"G21\nG0 X{x:.4f} Y{y:.4f}\nM3 $0 S1", *blocks, "M5 $0\nM2\n"]))
    assert run.error is None
    assert run.warnings == []
    assert run.arc_mismatch_mm < 5e-4
    (burn,) = run.burns
    if len(burn.points) > 1:
        assert apart_mm(path, burn.points) < TOLERANCE_MM
        assert burn.length_mm == pytest.approx(path.length_mm, abs=0.01 * len(rows), rel=1e-4)
    else:
        assert path.length_mm < 0.01 * len(rows)
