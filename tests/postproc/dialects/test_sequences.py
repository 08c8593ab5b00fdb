"""Lists of blocks for each thing that a dialect says, and arcs in pieces: as rs274 and the check's reader have them."""

from __future__ import annotations

import dataclasses
import math
import re
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.own_words import control_for
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects import Dialect, dialect_names, dialect_text, load_dialect
from kerfwise.postproc.dialects.load import parse_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.postproc.verdict.dialect_read_back import read_back
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside.mapped import in_linuxcnc

EIA = {
    "torch_station": ("M36 T1", "M37 T1"),
    "torch_on": ("M51", "M07", "{dwell}"),
    "torch_off": ("M50", "M08"),
    "mark_station": ("M36 T3", "M37 T2"),
    "mark_on": ("M50", "M07"),
    "mark_off": ("M08", "M51"),
    "dwell": ("G04 X0.2", "G04 X{seconds}"),
    "height_off": ("M50", "M50"),
    "height_on": ("M51",),
    "header": ("G21", "G90", "G40"),
}


def given(control: str) -> tuple[Plan, Nest, Profile]:
    plant, drawn = reading.with_dialect(profile(), control), plate()
    plant = dataclasses.replace(plant, machine=dataclasses.replace(plant.machine, pierce_dwell="program"))
    return plan_of(drawn, good_cuts(drawn), plant), drawn, plant


def eia() -> Dialect:
    return dataclasses.replace(load_dialect("eia"), **EIA)  # type: ignore[arg-type]


def test_sequences_of_blocks_are_written_in_order_and_read_back() -> None:
    plan, drawn, plant = given("eia")
    text = write_program(plan, drawn, plant, eia())
    rows = [re.sub(r"^N\d+ ", "", row) for row in text.splitlines()]
    at = rows.index("M07", rows.index("M37 T1"))
    assert rows[at - 1 : at + 3] == ["M51", "M07", "G04 X0.2", "G04 X0.5"]
    assert rows[rows.index("M08", at) - 1] == "M50"
    program = reading.of_check(text, drawn, plant)
    assert reading.differences(plan, drawn, plant, program).within()
    burns = read_nc(text, control=CONTROLS["eia"]).burns
    assert [burn.tool != 0 for burn in burns] == [planned.kind == "mark" for planned in plan.cuts]
    assert [burn.pierce_s for burn in burns if burn.tool == 0] == pytest.approx([0.7] * 8)


@pytest.mark.linuxcnc
def test_linuxcnc_runs_sequences_as_they_were_meant() -> None:
    plan, drawn, plant = given("eia")
    one_tool = dict(EIA, torch_station=(), mark_station=(), mark_on=("M50", "M09"), mark_off=("M10", "M51"))
    text = write_program(plan, drawn, plant, dataclasses.replace(load_dialect("eia"), **one_tool))  # type: ignore[arg-type]
    mapped = re.sub(r"(?m)^(N\d+ )?M5[01]$", r"\1", in_linuxcnc(text, "eia"))  # height control is no word of rs274's
    run = canon.run(mapped, 0.002)
    assert run.error is None
    assert [burn.tool != 0 for burn in run.burns] == [planned.kind == "mark" for planned in plan.cuts]
    machine = plant.machine
    held = [machine.mark_time_s if planned.kind == "mark" else machine.pierce_time_s for planned in plan.cuts]
    assert run.dwell_s == pytest.approx(sum(0.2 + seconds for seconds in held if seconds > 0), abs=0.01)


def test_height_control_stops_in_slow_holes_and_starts_again() -> None:
    base = reading.with_dialect(load_profile(), "eia")
    holes = dataclasses.replace(base.small_holes, small_hole_feed=0.5)
    plant = dataclasses.replace(base, small_holes=holes)
    drawn = plant.as_cut(nest(200, 120, part("A", rect(20, 20, 100, 80), [circle(50, 60, 10), circle(90, 60, 12)])))
    made = solve_and_verify(
        make_request(facts_of(drawn, plant), plant), plant, options_for(drawn, plant, work=0.5)
    ).plan
    text = write_program(made, drawn, plant, dataclasses.replace(eia(), torch_on=("M07",), torch_off=("M08",)))
    slow = [planned.cut.contour for planned in made.cuts if drawn.contour(planned.cut.contour).feed_share < 1]
    rows = [re.sub(r"^N\d+ ", "", row) for row in text.splitlines()]
    assert len(slow) == 2
    assert (rows.count("M50"), rows.count("M51")) == (2 * len(slow), len(slow))
    for k, row in enumerate(rows):
        if row == "M50" and rows[k - 1] == "M50":
            assert "M51" in rows[k : rows.index("M08", k)]
    assert check_program(drawn, text, plant, plan=made).ok


@pytest.mark.parametrize("name", [name for name in dialect_names() if load_dialect(name).arc_centre != "none"])
@pytest.mark.parametrize("sweep_deg", [30.0, 90.0])
def test_no_arc_turns_further_than_the_dialect_allows(name: str, sweep_deg: float) -> None:
    plan, drawn, plant = given(name)
    if not load_dialect(name).marks:
        drawn = dataclasses.replace(drawn, parts=tuple(dataclasses.replace(p, marks=()) for p in drawn.parts))
        plan = plan_of(drawn, [cut for cut in good_cuts(plate()) if cut.contour in drawn.index], plant)
    dialect = dataclasses.replace(load_dialect(name), greatest_sweep_deg=sweep_deg)
    read_back(dialect, name)
    text = write_program(plan, drawn, plant, dialect)
    burns = read_nc(text, control=control_for(dialect)).burns
    sweeps = [abs(math.degrees(s.sweep_rad)) for burn in burns for s in burn.path.segments if s.is_arc]
    assert sweeps
    assert max(sweeps) <= sweep_deg + 0.1  # points are rounded
    assert reading.differences(plan, drawn, plant, reading.of_check(text, drawn, plant)).within()


@pytest.mark.linuxcnc
def test_linuxcnc_runs_arcs_in_pieces() -> None:
    plan, drawn, plant = given("linuxcnc")
    dialect = dataclasses.replace(load_dialect("linuxcnc"), greatest_sweep_deg=45.0)
    text = write_program(plan, drawn, plant, dialect)
    assert reading.differences(plan, drawn, plant, reading.of_linuxcnc(text, "linuxcnc")).within()
    assert max(abs(s) for burn in canon.run(text).burns for s in burn.sweeps_rad) <= math.radians(45.1)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "dwell: G04 X{seconds}",
            "dwell: [G04 X1]",
            "dwell: expected one {seconds} or {milliseconds} in all its blocks",
        ),
        ("dwell: G04 X{seconds}", "dwell: ['G04 X{seconds}', 'G04 X{seconds}']", "dwell: expected one"),
        (
            "dwell: G04 X{seconds}",
            "dwell: ['G04 X{second}']",
            "dwell: expected a line of text, with no braces but {seconds}",
        ),
        ("decimals: 4", "decimals: 4\ngreatest_sweep_deg: 270", "greatest_sweep_deg: expected"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(old: str, new: str, said: str) -> None:
    text = dialect_text("eia")
    assert old in text
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        parse_dialect(text.replace(old, new, 1), "d.yaml")
    assert caught.value.line is not None


def test_a_sequence_that_pauses_in_a_way_of_its_own_may_stand_in_a_file(tmp_path: Path) -> None:
    text = dialect_text("eia").replace("dwell: G04 X{seconds}", "dwell:\n  - M50\n  - G04 X{seconds}\n  - M51")
    (tmp_path / "d.yaml").write_text(text)
    read_back(load_dialect(str(tmp_path / "d.yaml")), "d.yaml")
