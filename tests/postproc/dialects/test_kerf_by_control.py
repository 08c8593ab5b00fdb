"""Kerf that the control adds: contours stand in the program, LinuxCNC and the check make the torch's paths of them."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
import shapely

import kerfwise as package
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects.load import new_dialect_text
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program, held_to_plan
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.options.yaml_positions import with_value
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import cut_of, plan_of, profile
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import full

NESTS = Path(package.__file__).parent / "examples" / "nests"
DYNAMIC = '{left: "G41.1 D{kerf}", right: "G42.1 D{kerf}"}'
BY_TABLE = '{left: "G41 D1", right: "G42 D1"}'
PLATE = nest(
    400,
    200,
    part("A", [(20, 20), (120, 20), (120, 80), (90, 110), (20, 110)], [circle(60, 60, 15), rect(90, 30, 20, 30)]),
    part("B", [(150, 20), (250, 20, 1.0), (250, 100), (220, 100), (220, 60), (190, 60), (190, 100), (150, 100)]),
)


def shop(folder: Path, like: str, kerf: str = "control", **more: str) -> Profile:
    """A machine whose control adds the kerf."""
    text = new_dialect_text("shop", like)
    for key, value in {"kerf": kerf, **more}.items():
        text = with_value(text, [key], value)
    (folder / "shop.yaml").write_text(text)
    made = reading.with_dialect(profile(), str(folder / "shop.yaml"))
    trusted_dialect(made)
    return made


def planned(plant: Profile, drawn: Nest = PLATE, turned: bool = False) -> tuple[Plan, str]:
    order = sorted(drawn.contours, key=lambda contour: (contour.part, contour.kind == "outer"))
    cuts = [cut_of(c, 0.1, "cw" if (c.kind == "outer") != turned else "ccw") for c in order]
    plan = plan_of(drawn, cuts, plant)
    return plan, write_program(plan, drawn, plant)


@pytest.mark.linuxcnc
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kerf", [DYNAMIC, BY_TABLE])
def test_linuxcnc_and_the_check_make_the_torchs_paths_of_it(kerf: str, turned: bool, tmp_path: Path) -> None:
    plant = shop(tmp_path, "linuxcnc", kerf)
    plan, text = planned(plant, turned=turned)
    assert len(re.findall(r"G4[12]", text)) == len(plan.cuts)
    assert {"G41" in text, "G42" in text} == {True, False}
    assert "(ASSUMES THE CONTROL ADDS A KERF OF 1.5 MM)" in text
    heard = [reading.of_check(text, PLATE, plant)]
    heard.append(reading.of_linuxcnc(text, "linuxcnc", kerf_mm=plant.material.kerf_mm))
    for one in heard:
        found = reading.differences(plan, PLATE, plant, one)
        assert (found.burns, found.apart_mm < 0.005, abs(found.cut_mm) < 0.2) == (found.paths, True, True), found
        assert 0 < found.idle_mm < 12 * len(plan.cuts)  # it runs up to each pierce
    result = check_program(PLATE, text, plant, plan=plan)
    assert set(held_to_plan(result, PLATE, text, plan, plant).broken()) <= {"cut-direction"}


@pytest.mark.parametrize("like", ["eia", "burny", "linuxcnc-qtplasmac", "linuxcnc"])
@pytest.mark.parametrize("name", ["e1x_6.json", "plate40.json"])
def test_whole_nests_are_read_back(name: str, like: str, tmp_path: Path) -> None:
    plant, drawn = shop(tmp_path, like), read_nest(NESTS / name)
    plan, text = planned(plant, drawn)
    found = reading.differences(plan, drawn, plant, reading.of_check(text, drawn, plant))
    assert (found.burns, found.apart_mm < 0.005, abs(found.cut_mm) < 0.2) == (found.paths, True, True), found


SQUARE = """G21
G90
G40
G00 X-10 Y50
G41
G00 X-5 Y50
M07
G01 X0 Y50 F2000
G01 Y100
G01 X100
G01 Y0
G01 X0
G01 Y50
M08
G40
G00 X0 Y0
M02
"""


def test_a_square_by_hand() -> None:
    """In the manner of EIA programs: 4 mm of lead, 49 and 50 mm of one side, three sides, and four rounded corners."""
    control = replace(CONTROLS["eia"], kerf_mm=2.0)
    burn = read_nc(SQUARE, control=control).burns[0]
    assert burn.path.length_mm == pytest.approx(4 + 49 + 50 + 300 + 2 * math.pi)
    assert burn.start == (-5.0, 51.0)
    assert burn.path.end == pytest.approx([-1.0, 50.0])
    inside = read_nc(SQUARE.replace("G41", "G42"), control=control).burns[0]
    assert inside.path.line().bounds == pytest.approx((-5.0, 1.0, 99.0, 99.0))
    with pytest.raises(InputError, match="a line of at least half the kerf"):
        read_nc(SQUARE.replace("X-10 Y50", "X-5.5 Y50"), control=control)
    with pytest.raises(InputError, match="the control would shift the path by its own kerf"):
        read_nc(SQUARE, control=CONTROLS["eia"])


SPECIAL = """
based_on: plasma-carbon-steel
machine: {dialect: DIALECT, accept_dialect: true}
leads: {lead: arc, lead_out: line}
corners: {corner_feed: 0.7, corner_reach: 3 mm}
small_holes: {min_hole: 1 mm}
rules: {hold-small-parts: {strength: hard, tabs: all}}
"""


@pytest.mark.linuxcnc
@pytest.mark.parametrize("base", ["plasma-carbon-steel", full("laser-st10kp-2mm")])
def test_tabs_slow_corners_and_arcs_are_beside_it_too(base: str, tmp_path: Path) -> None:
    """As LinuxCNC hears it, a program burns what the one burns that has the kerf in its path."""
    text, heard = SPECIAL.replace("plasma-carbon-steel", base), []
    shop(tmp_path, "linuxcnc", DYNAMIC)
    for dialect in ("linuxcnc", str(tmp_path / "shop.yaml")):
        path = tmp_path / f"plant{len(heard)}.yaml"
        path.write_text(text.replace("DIALECT", dialect), encoding="utf-8")
        program = tmp_path / f"{len(heard)}.nc"
        done = kerfwise("solve", NESTS / "e1x_6.json", "-p", path, "--work", "0.1", "-o", program)
        assert done.code == 0, done.err
        assert kerfwise("check", NESTS / "e1x_6.json", program, "-p", path).code == 0
        heard.append(canon.run(program.read_text(encoding="utf-8"), tolerance_mm=0.002))
    plain, beside = heard
    assert (plain.error, beside.error) == (None, None)
    assert len(beside.burns) == len(plain.burns) > 10
    for one, other in zip(plain.burns, beside.burns, strict=True):
        assert one.length_mm == pytest.approx(other.length_mm, abs=0.1)
        assert shapely.hausdorff_distance(shapely.LineString(one.points), shapely.LineString(other.points)) < 0.03


def test_a_wrong_side_or_kerf_is_found(tmp_path: Path) -> None:
    plant = shop(tmp_path, "linuxcnc", DYNAMIC)
    plan, text = planned(plant)
    swapped = re.sub(r"G41\.1", "G42.1", text, count=1)
    assert check_program(PLATE, swapped, plant, plan=plan).broken()
    other = re.sub(r"(G41\.1 D)1\.5", r"\g<1>1.2", text, count=1)
    result = check_program(PLATE, other, plant, plan=plan)
    assert "program-state" in result.broken()
    never_off = re.sub(r"N\d+ G40\n(?=\()", "", text, count=1)
    assert never_off != text
    with pytest.raises(InputError, match=r"another G41 or G42 before G40"):
        check_program(PLATE, never_off, plant, plan=plan)
    tight = re.sub(r"(G3 X\S+ Y\S+) I\S+ J\S+", r"\1 I0.4 J0", text, count=1)
    with pytest.raises(InputError):
        check_program(PLATE, tight, plant, plan=plan)


@pytest.mark.parametrize(
    ("like", "more", "said"),
    [
        ("grbl", {}, "kerf: the control cannot add it here: programs for 'grbl' have no such words"),
        ("linuxcnc", {"subprogram": "{}"}, "subprograms are called with the torch on its path"),
        ("linuxcnc", {"kerf": "{left: G42 D1, right: G41 D1}"}, "half the kerf beside the path"),
        ("linuxcnc", {"kerf": "{off: G49}"}, "kerf"),
        ("linuxcnc", {"kerf": "yes"}, "control, or a mapping of left, right, off, run_up"),
    ],
)
def test_what_no_control_could_do_is_refused(like: str, more: dict[str, str], said: str, tmp_path: Path) -> None:
    kerf = more.pop("kerf", "control")
    with pytest.raises(InputError) as caught:
        shop(tmp_path, like, kerf, **more)
    assert said in str(caught.value)
    assert "shop.yaml" in str(caught.value)


def test_its_own_programs_are_not_put_into_another_order(tmp_path: Path) -> None:
    shop(tmp_path, "linuxcnc", DYNAMIC)
    (tmp_path / "plant.yaml").write_text(
        "based_on: plasma-carbon-steel\nmachine: {dialect: shop.yaml, accept_dialect: true}\n", encoding="utf-8"
    )
    (tmp_path / "old.nc").write_text(planned(shop(tmp_path, "linuxcnc", DYNAMIC))[1], encoding="utf-8")
    done = kerfwise("resequence", tmp_path / "old.nc", "-p", tmp_path / "plant.yaml", "-o", tmp_path / "new.nc")
    assert done.code == 2
    assert "another order would need other run-ups" in done.err
    assert not (tmp_path / "new.nc").exists()
