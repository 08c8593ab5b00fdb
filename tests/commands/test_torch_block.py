"""Bevels by a block of three torches: set by hand, planned, written, read back, judged at every depth, and refused."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from kerfwise import load_profile, read_nest
from kerfwise.tests.checked import checked
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.metal.layers import simulate_layers
from kerfwise.tests.tools.amount import full
from kerfwise.tests.tools.canon import run

PLANT = """based_on: plasma-carbon-steel
machine: {dialect: linuxcnc}
material: {thickness: 20 mm}
cuts: {bevel: {head: block, most_turn: 720, lies_still: 0.5 kg}}
"""
PLATE = [[300, 300], [500, 300], [500, 420], [300, 420]]
K = {"kind": "K", "angle": 30, "land": 6}


def write(
    folder: Path, bevel: object, outer: object = PLATE, plant: str = PLANT, side: float = 900
) -> tuple[Path, Path]:
    other = {"id": "Q", "outer": [[40, 40], [90, 40], [90, 90], [40, 90]]}
    parts = [{"id": "P", "outer": outer, "bevel": bevel}, other]
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": side, "height": 800}, "parts": parts}
    (folder / "nest.json").write_text(json.dumps(nest))
    (folder / "plant.yaml").write_text(plant)
    return folder / "nest.json", folder / "plant.yaml"


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, str, Any]:
    folder = tmp_path_factory.mktemp("block")
    nest, plant = write(folder, K)
    words = ("-o", folder / "out.nc", "--plan", folder / "out.plan.json", "--picture", folder / "out.svg")
    done = kerfwise("solve", nest, "-p", plant, "--work", "0.05", *words)
    assert done.code == 0, done.out + done.err
    return nest, plant, (folder / "out.nc").read_text(), json.loads((folder / "out.plan.json").read_text())


def bevels_of(nest: Path, plant: Path, program: str) -> list[str]:
    profile = load_profile(plant)
    result = checked(read_nest(nest, profile), program, profile)
    return [v.text for rule in result.rules if rule.id == "bevels" for v in rule.violations]


def test_three_torches_cut_a_k_in_one_round(solved: tuple[Path, Path, str, Any]) -> None:
    nest, plant, program, plan = solved
    (row,) = (row for row in plan["cuts"] if row["contour"] == "P.outer")
    assert [one["tilt"] for one in row["passes"]] == [30, -30, 0]
    assert len({json.dumps(one["top"]) for one in row["passes"]}) == 1  # one way of the block
    assert row["because"][0] == (
        "bevel K 30 land 6: cut by 3 torches of the block together, at 30 degrees, -30 degrees, upright; "
        "loops at 4 of 4 sharp corners"
    )
    # by hand: 7 mm deep the slope meets the land, where its cut lies beside the line; a jet is 1.5 / cos 30 wide, level
    half, root = 1.5 / math.cos(math.radians(30)) / 2, 7 * math.tan(math.radians(30))
    top, bottom = half - root - 0.75, half + 13 * math.tan(math.radians(30)) - 0.75
    assert f"(BLOCK TORCH 3 OPEN TO THE TOP TILT 30 LEFT 45 OUT {top:.3f})" in program
    assert f"(BLOCK TORCH 4 OPEN TO THE BOTTOM TILT -30 LEFT -45 OUT {bottom:.3f})" in program
    assert "(ASSUMES NOT VERIFIED ON A MACHINE)" in program
    assert len(re.findall(r"N\d+ M3 S1", program)) == 2
    assert f"F{2500 * math.cos(math.radians(30)):.3f}" in program  # the slowest of the three
    assert bevels_of(nest, plant, program) == []
    profile = load_profile(plant)
    assert simulate_layers(read_nest(nest, profile), program, profile) == []
    checked = kerfwise("check", nest, nest.parent / "out.plan.json", "-p", plant)
    assert checked.code == 0, checked.out
    times = [kerfwise("time", nest, nest.parent / made, "-p", plant) for made in ("out.nc", "out.plan.json")]
    assert times[0].out == times[1].out


@pytest.mark.linuxcnc
def test_linuxcnc_turns_the_block_with_its_path(solved: tuple[Path, Path, str, Any]) -> None:
    done = run(solved[2])
    assert (done.error, done.ended) == (None, "M2")
    assert all("AUX_OUTPUT_BIT" in text for text in done.warnings)
    turned = [burn for burn in done.burns if len({round(axes[2], 3) for axes in burn.axes}) > 1]
    assert len(turned) == 1
    assert {axes[0] for axes in turned[0].axes} == {0.0}


def test_eia_selects_the_stations_of_a_block(tmp_path: Path) -> None:
    nest, plant = write(tmp_path, {"kind": "X", "angle": 30}, plant=PLANT.replace("linuxcnc", "eia"))
    done = kerfwise("solve", nest, "-p", plant, "--work", "0.05", "-o", tmp_path / "out.cnc")
    assert done.code == 0, done.out + done.err
    program = (tmp_path / "out.cnc").read_text()
    assert re.search(
        r"M38 T2\nN\d+ M28\nN\d+ G00 X\S+ Y\S+\nN\d+ G00 C\S+\nN\d+ M37 T3\nN\d+ M37 T4\nN\d+ M07", program
    )
    assert "(ASSUMES NOT VERIFIED ON A MACHINE)" in program
    assert simulate_layers(read_nest(nest), program, load_profile(plant)) == []
    assert "no pass that leans by 30" in str(bevels_of(nest, plant, program.replace("M37 T3", "M38 T3")))


@pytest.mark.parametrize(
    ("pattern", "instead", "says", "burns"),
    [
        (r"OUT (-?)(\d)", r"OUT \g<1>1\2", "", True),
        (r"TILT 30", "TILT 36", "P.outer: no pass that leans by 30 degrees", True),
        full(r"M64 P2", "M65 P2", "P.outer: no pass that leans by 30 degrees", True),
        (r"\(BLOCK TORCH 4.*\n", "", "nobody says how torch 4 of the block is set", False),
        (r"(\(BLOCK TORCH 3.*\n)", r"\1(BLOCK TORCH 3 OPEN TO THE TOP TILT 30 LEFT 45 OUT 0)\n", "in two ways", False),
        (r" C(-?\d+)(?=\nN\d+ M64)", lambda m: f" C{int(m[1]) + 20}", "", True),
    ],
)
def test_a_damaged_program_is_refused(
    solved: tuple[Path, Path, str, Any], pattern: str, instead: Any, says: str, burns: bool
) -> None:
    nest, plant, program, _ = solved
    damaged = re.sub(pattern, instead, program)
    assert damaged != program
    found = bevels_of(nest, plant, damaged)
    assert any(says in text for text in found), found
    if burns:
        profile = load_profile(plant)
        assert simulate_layers(read_nest(nest, profile), damaged, profile)


ROUND = [[300, 300], [500, 300, 0.4], [500, 420], [300, 420]]
ANGLE = [[300, 300], [500, 300], [500, 360], [400, 360], [400, 500], [300, 500]]


@pytest.mark.parametrize(
    ("bevel", "outer", "plant", "side", "says"),
    [
        (
            K,
            ROUND,
            PLANT,
            900,
            "P.outer, bevel K 30 land 6: an arc begins at (500.0, 300.0), and the torches of the block",
        ),
        (K, ANGLE, PLANT, 900, "P.outer, bevel K 30 land 6: at (400.0, 360.0) it bends into the part"),
        (K, PLATE, PLANT, 560, "no loop of the block has room at the corner"),
        ({**K, "edges": [1]}, PLATE, PLANT, 900, "take a head that tilts for single edges"),
        (K, PLATE, PLANT.replace(", lies_still: 0.5 kg", ""), 900, "the first of its 3 passes sets loose"),
        (K, PLATE, PLANT.replace("linuxcnc", "linuxcnc-qtplasmac"), 900, "has no words for several torches"),
        (K, PLATE, PLANT.replace("block,", "blocks,"), 900, "plant.yaml:4:"),
        (K, PLATE, PLANT.replace("block,", "block, left: middle,"), 900, "top"),
        (K, PLATE, PLANT.replace("block,", "block, apart: -3 mm,"), 900, "apart"),
    ],
)
def test_what_a_block_cannot_cut_is_refused(
    tmp_path: Path, bevel: object, outer: object, plant: str, side: float, says: str
) -> None:
    nest, profile = write(tmp_path, bevel, outer, plant, side)
    done = kerfwise("solve", nest, "-p", profile, "-o", tmp_path / "out.nc")
    assert done.code == 2, done.out
    assert says in done.err, done.err
    assert not (tmp_path / "out.nc").exists()


def test_a_block_is_set_to_one_bevel(tmp_path: Path) -> None:
    nest, profile = write(tmp_path, K)
    told = json.loads(nest.read_text())
    told["parts"][1]["bevel"] = {"kind": "V", "angle": 20}
    nest.write_text(json.dumps(told))
    done = kerfwise("solve", nest, "-p", profile)
    assert done.code == 2
    assert "the block of torches is set by hand to one bevel, and the nest has K 30 land 6 and V 20 top" in done.err
