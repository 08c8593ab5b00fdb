"""Bevels on the command line: planned, written, read back, judged at every depth, and refused."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import ezdxf
import pytest

import kerfwise as package
from kerfwise import load_profile, read_nest
from kerfwise.tests.checked import checked
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import full
from kerfwise.tests.tools.canon import run

ROOT = Path(package.__file__).resolve().parent
NEST, PROFILE = ROOT / "docs/bevel.nest.json", ROOT / "examples/profiles/bevel.yaml"
PLANT = "based_on: {}\nmachine: {{dialect: linuxcnc}}\nmaterial: {{thickness: 10 mm}}\n"
PLATE = [[100, 100], [220, 100], [220, 180], [100, 180]]


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the page's example, planned."""
    folder = tmp_path_factory.mktemp("bevel")
    words = ("-o", folder / "out.nc", "--plan", folder / "out.plan.json", "--picture", folder / "out.svg")
    done = kerfwise("solve", NEST, "-p", PROFILE, "--work", "0.2", *words)
    assert done.code == 0, done.err
    return folder


def verdict(program: str) -> list[str]:
    """What is wrong with the bevels of a program of the example."""
    profile = load_profile(PROFILE)
    result = checked(read_nest(NEST, profile), program, profile)
    return [str(v.text) for rule in result.rules if rule.id == "bevels" for v in rule.violations]


def test_the_plan_and_the_program_have_all_passes(solved: Path) -> None:
    rows = {row["contour"]: row for row in json.loads((solved / "out.plan.json").read_text())["cuts"]}
    assert [one["tilt"] for one in rows["Flange.outer"]["passes"]] == [45]
    assert [one["tilt"] for one in rows["Ring.outer"]["passes"]] == [-30, 0]
    assert "passes" not in rows["Gusset.outer"]
    assert rows["Flange.outer"]["because"][0] == (
        "bevel V 45 top: cut in one pass at 45 degrees; loops at 4 of 4 sharp corners"
    )
    program = (solved / "out.nc").read_text()
    assert len(re.findall(r"PASS \d OF \d", program)) == 3
    assert f"F{1200 * math.cos(math.radians(45)):.3f}" in program
    assert verdict(program) == []
    checked = kerfwise("check", NEST, solved / "out.plan.json", "-p", PROFILE)
    assert checked.code == 0, checked.out
    explained = kerfwise("explain", NEST, solved / "out.plan.json", "Ring.outer", "-p", PROFILE)
    assert "cut in 2 passes, one after the other, at -30 degrees, upright" in explained.out
    assert (solved / "out.svg").read_text().count("stroke-dasharray") > 0


@pytest.mark.linuxcnc
def test_linuxcnc_runs_the_program_as_the_reader_does(solved: Path) -> None:
    done = run((solved / "out.nc").read_text())
    assert done.error is None
    assert done.warnings == []
    assert done.ended == "M2"
    flange = next(burn for burn in done.burns if burn.axes and burn.axes[0][0] == 45)
    plan = json.loads((solved / "out.plan.json").read_text())
    (told,) = next(row for row in plan["cuts"] if row["contour"] == "Flange.outer")["passes"]
    turns = [row[3] for row in told["top"]]
    assert flange.points[0] == pytest.approx(told["top"][0][:2], abs=1e-3)
    assert flange.axes[0][2] == pytest.approx(turns[0], abs=1e-3)
    assert flange.axes[-1][2] == pytest.approx(turns[-1], abs=1e-3)
    assert {axes[0] for axes in flange.axes} == {45.0}


@pytest.mark.parametrize(
    ("pattern", "instead", "says"),
    [
        (r"A45", "A40", "Flange.outer: no pass that leans by 45 degrees"),
        full(r"A45", "A-45", "it burns into Flange"),
        (r"F848.528", "F1200", "it cuts at 1200 mm/min, at its lean that should be 849"),
        full(r"A45 C\S+", lambda m: m[0].replace("A45", "A0"), "no pass that leans by 45"),
        (r"(A45[^(]*?)(G4 P)1.2", r"\g<1>\g<2>0.2", "the torch stands for 0.2 s before it moves, expected 1.2 s"),
        full(r"C(\d+)(?=\nN\d+ G1)", lambda m: f"C{int(m[1]) + 30}", ""),
        (r"(?s)\(CUT \d+ Ring.outer ZONE 1 CW PASS 1.*?M5\n", "", "Ring.outer: no pass that leans by -30 degrees"),
    ],
)
def test_a_damaged_program_is_refused(solved: Path, pattern: str, instead: Any, says: str) -> None:
    program = (solved / "out.nc").read_text()
    damaged = re.sub(pattern, instead, program, count=1)
    assert damaged != program
    found = verdict(damaged)
    assert any(says in text for text in found), found


def write(folder: Path, bevel: object, profile: str, **part: object) -> tuple[str, str]:
    entry = {"id": "P", "outer": PLATE, "bevel": bevel, **part}
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 300}, "parts": [entry]}
    (folder / "nest.json").write_text(json.dumps(nest, indent=1))
    (folder / "plant.yaml").write_text(PLANT.format("plasma-carbon-steel") + profile)
    return str(folder / "nest.json"), str(folder / "plant.yaml")


@pytest.mark.parametrize(
    ("bevel", "says"),
    [
        ({"kind": "W", "angle": 45}, "W"),
        ({"kind": "V"}, "angle"),
        ({"kind": "V", "angle": 80}, "P.outer: a bevel's angle is 80: expected 1 to 60 degrees from the vertical"),
        ({"kind": "V", "angle": 45, "land": 2}, "P.outer: a bevel V has no land"),
        ({"kind": "V", "angle": 45, "of": "hole1"}, "P.hole1: the part has no such contour: expected of: outer"),
        ([{"kind": "V", "angle": 45}] * 2, "P.outer: it is given a second bevel"),
        ({"kind": "V", "angle": 45, "edges": [5]}, "P.outer: it has no edge 5: they are counted from 1"),
        ({"kind": "V", "angle": 45, "edges": []}, "P.outer: its bevel has no edges"),
        ({"kind": "V", "angle": 45, "edges": [1, 1]}, "its edge 1 is given a second bevel"),
        ({"kind": "V", "angle": 45, "edges": [0]}, "P.outer: it has no edge 0"),
        ([{"kind": "V", "angle": 45, "edges": [1]}] * 2, "P.outer: its edge 1 is given a second bevel"),
        ([{"kind": "V", "angle": 45, "edges": [1]}, {"kind": "V", "angle": 45}], "P.outer: it is given a second bevel"),
        ({"kind": "V", "angle": 45, "tilt": 3}, "tilt"),
    ],
)
def test_a_wrong_bevel_is_refused_with_its_line(tmp_path: Path, bevel: object, says: str) -> None:
    nest, profile = write(tmp_path, bevel, "cuts: {bevel: {}}\n")
    done = kerfwise("solve", nest, "-p", profile)
    assert done.code == 2
    assert re.search(r"nest\.json:\d+:\d+: ", done.err)
    assert says in done.err, done.err
    assert "Traceback" not in done.err


EDGES: list[dict[str, object]] = [
    {"kind": "Y", "angle": 30, "land": 4, "edges": [1]},
    {"kind": "V", "angle": 20, "side": "bottom", "edges": [2, 3]},
]


@pytest.fixture(scope="module")
def edged(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str, str, Any]:
    """A plate with bevels on three edges, its plant, program and plan."""
    folder = tmp_path_factory.mktemp("edges")
    nest, plant = write(folder, EDGES, "cuts: {bevel: {}}\n")
    program, plan = folder / "out.nc", folder / "out.plan.json"
    done = kerfwise("solve", nest, "-p", plant, "--work", "0.05", "-o", program, "--plan", plan)
    assert done.code == 0, done.out + done.err
    return nest, plant, program.read_text(), json.loads(plan.read_text())


def test_single_edges_have_bevels(edged: tuple[str, str, str, Any], tmp_path: Path) -> None:
    nest, plant, program, plan = edged
    (row,) = plan["cuts"]
    alone, whole = row["passes"]  # the slope of the Y alone, while the part is held; then once round
    assert (alone["tilt"], whole["tilt"]) == (30, -20)
    assert "tilts" not in alone
    assert {*whole["tilts"]} >= {0, -20}
    why = "bevel Y 30 land 4 top on 1 of 4 edges and V 20 bottom on 2 of 4 edges: cut in 2 passes"
    assert row["because"][0].startswith(why)
    assert "PASS 2 OF 2 TILT -20 TO UPRIGHT" in program
    for angle in (20, 30):  # the plant has no row for them
        assert f"(ASSUMES THE KERF AT {angle} DEGREES IS 1.5 MM, SQUARE TO THE JET: NOBODY HAS MEASURED IT)" in program
    (tmp_path / "out.nc").write_text(program)
    times = [kerfwise("time", nest, made, "-p", plant) for made in (tmp_path / "out.nc",)]
    assert times[0].code == 0, times[0].err
    # the slope of 30 degrees goes to 4 mm above the bottom of 10 mm: its jet's middle is tan 30 * 6 - half a cut inside
    half = 1.5 / math.cos(math.radians(30)) / 2
    along = [at for at in alone["top"] if at[4]]
    assert {round(at[1], 4) for at in along} == {round(100 + 6 * math.tan(math.radians(30)) - half, 4)}


@pytest.mark.linuxcnc
def test_linuxcnc_tilts_the_torch_between_two_edges(edged: tuple[str, str, str, Any]) -> None:
    done = run(edged[2])
    assert (done.error, done.warnings, done.ended) == (None, [], "M2")
    assert {round(axes[0], 3) for axes in done.burns[0].axes} == {30}
    leans = [axes[0] for axes in done.burns[1].axes]
    assert (min(leans), max(leans)) == (-20, 0)


@pytest.mark.parametrize(
    ("pattern", "instead", "says"),
    [
        (r" A-20", " A-14", "P.outer: no pass that leans by -20 degrees"),
        full(r" A-1\d\S*", "", ""),
        full(r"(?s)\(CUT 1 P.outer ZONE 1 C?CW PASS 1.*?M5\n", "", "P.outer: no pass that leans by 30 degrees"),
        (r"F2165.064", "F2500", "it cuts at 2500 mm/min, at its lean that should be 2165"),
    ],
)
def test_damaged_edges_are_refused(edged: tuple[str, str, str, Any], pattern: str, instead: str, says: str) -> None:
    nest, plant, program, _ = edged
    profile = load_profile(plant)
    damaged = re.sub(pattern, instead, program)
    assert damaged != program
    result = checked(read_nest(nest, profile), damaged, profile)
    found = [v.text for rule in result.rules if rule.id == "bevels" for v in rule.violations]
    assert any(says in text for text in found), found


HEAD = "cuts: {bevel: {head: tilting}}\n"


@pytest.mark.parametrize(
    ("profile", "says"),
    [
        (
            "",
            "P.outer has a bevel (V 30 top), and the profile has no head that tilts: say cuts: {bevel: ",
        ),
        ("cuts: {bevel: {tilt: C}}\n", "tilt and turn are both C"),
        ("cuts: {bevel: {}, pierce_pass: zone}\n", "say cuts.pierce_pass: off"),
        ("cuts: {bevel: {}, links: {longest: 30 mm}}\n", "say cuts.links.longest: 0 mm"),
        ("cuts: {bevel: {}, common: {good_side: any}}\n", "say cuts.common.shortest: off"),
        ("cuts: {bevel: {}, snake: {}}\n", "leave cuts.snake out"),
        ("cuts: {bevel: {}, split: {last: 20 mm}}\n", "leave cuts.split out"),
        ("cuts: {bevel: {}, narrow: slit}\n", "say cuts.narrow: refuse, or leave"),
        ("cuts: {bevel: {}, scrap: {grid: 500 mm}}\n", "leave scrap lines out"),
        (HEAD + "corners: {corner_feed: 0.5}\n", "say corners.corner_feed: 1"),
        (HEAD + "rules: {hold-small-parts: {strength: hard, width: 1 mm}}\n", "turn off the rule that leaves tabs"),
        (HEAD + "rules: {t-max: {strength: hard}}\n", "simulates upright torches: turn it off"),
        (HEAD + "objective: {distortion: 1}\n", "say objective: {distortion: 0}"),
    ],
)
def test_what_does_not_go_together_is_refused(tmp_path: Path, profile: str, says: str) -> None:
    nest, plant = write(tmp_path, {"kind": "V", "angle": 30}, profile)
    done = kerfwise("solve", nest, "-p", plant)
    assert done.code == 2
    assert says in done.err, done.err


def test_bevels_on_single_edges_are_named_where_nothing_cuts_them(tmp_path: Path) -> None:
    nest, plant = write(tmp_path, {"kind": "V", "angle": 30, "edges": [1]}, "cuts: {bevel: {head: off}}\n")
    done = kerfwise("solve", nest, "-p", plant)
    assert "P.outer has a bevel (V 30 top), and the profile has no head that tilts" in done.err


def test_eia_tilts_and_turns_by_the_words_of_its_manual(tmp_path: Path) -> None:
    nest, plant = write(
        tmp_path, {"kind": "Y", "angle": 30, "land": 4}, "cuts: {bevel: {lies_still: 0.5 kg, corner: turn}}\n"
    )
    (tmp_path / "plant.yaml").write_text((tmp_path / "plant.yaml").read_text().replace("linuxcnc}", "eia}"))
    done = kerfwise("solve", nest, "-p", plant, "--work", "0.05", "-o", tmp_path / "out.cnc")
    assert done.code == 0, done.out + done.err
    program = (tmp_path / "out.cnc").read_text()
    assert "(ASSUMES NOT VERIFIED ON A MACHINE)" in program
    blocks = [line.partition(" ")[2] for line in program.splitlines() if line.startswith("N")]
    first = next(k for k, block in enumerate(blocks) if " A30" in block)
    assert blocks[first - 1] == "M28"  # the follower is off
    assert re.fullmatch(r"G00 X\S+ Y\S+ A30", blocks[first])
    assert re.fullmatch(r"G00 C\S+", blocks[first + 1])
    assert blocks[first + 2] == "M07"
    turning = [block for block in blocks if re.fullmatch(r"G0[123] X.* C\S+( F\S+)?", block)]
    assert len(turning) == 4  # at each corner
    upright = next(block for block in blocks[first + 1 :] if block.startswith("G00 X"))
    assert upright.endswith(" A0")
    profile = load_profile(plant)
    drawn = read_nest(nest, profile)
    for damaged, says in (
        (program.replace(" A30", " A20"), "no pass that leans by 30 degrees"),
        (program.replace(" A30", ""), "no pass that leans by 30 degrees"),
        (re.sub(r" C(-?\d+)(?=\nN\d+ M07)", lambda m: f" C{int(m[1]) + 25}", program), ""),
    ):
        assert damaged != program
        result = checked(drawn, damaged, profile)
        found = [v.text for rule in result.rules if rule.id == "bevels" for v in rule.violations]
        assert any(says in text for text in found), found


def test_eia_does_not_tilt_while_it_turns(tmp_path: Path) -> None:
    nest, plant = write(tmp_path, {"kind": "V", "angle": 30, "edges": [1]}, HEAD)
    (tmp_path / "plant.yaml").write_text((tmp_path / "plant.yaml").read_text().replace("linuxcnc}", "eia}"))
    done = kerfwise("solve", nest, "-p", plant, "--work", "0.05", "-o", tmp_path / "out.cnc")
    assert done.code == 2
    assert (
        "'eia' does not tilt a torch while it turns, and P.outer has bevels on single edges: take linuxcnc" in done.err
    )


@pytest.mark.parametrize("dialect", ["linuxcnc-qtplasmac", "essi"])
def test_a_dialect_without_axes_is_refused(tmp_path: Path, dialect: str) -> None:
    nest, plant = write(tmp_path, {"kind": "V", "angle": 30}, HEAD)
    (tmp_path / "plant.yaml").write_text((tmp_path / "plant.yaml").read_text().replace("linuxcnc}", dialect + "}"))
    done = kerfwise("solve", nest, "-p", plant)
    assert done.code == 2
    assert (
        f"the dialect '{dialect}' has no words for axes that tilt (A) and turn (C) a torch: take eia or linuxcnc"
        in done.err
    )


def test_a_drawing_has_bevels_by_layer_and_colour(tmp_path: Path) -> None:
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()
    space.add_lwpolyline([(100, 100), (220, 100), (220, 180), (100, 180)], close=True, dxfattribs={"layer": "V45"})
    space.add_circle((160, 140), 20, dxfattribs={"layer": "0", "color": 1})
    space.add_lwpolyline([(300, 100), (380, 100), (380, 180), (300, 180)], close=True)
    drawing.saveas(tmp_path / "plate.dxf")
    (tmp_path / "plant.yaml").write_text(
        PLANT.format("plasma-carbon-steel")
        + "drawing: {layers: {bevel: {'^V45$': V 45 bottom, red: Y 30 land 4}}}\ncuts: {bevel: {}}\n"
    )
    profile = load_profile(tmp_path / "plant.yaml")
    nest = read_nest(tmp_path / "plate.dxf", profile)
    assert {c.id: str(c.bevel) for c in nest.contours if c.bevel} == {
        "P1.hole1": "Y 30 land 4 top",
        "P1.outer": "V 45 bottom",
    }
    bad = (tmp_path / "plant.yaml").read_text().replace("V 45 bottom", "V 95")
    (tmp_path / "plant.yaml").write_text(bad)
    done = kerfwise("profile", "check", str(tmp_path / "plant.yaml"))
    assert done.code == 2
    assert "a bevel's angle is 95" in done.err
    assert "plant.yaml:4:" in done.err


def test_a_program_of_bevels_alone_is_timed_and_judged(tmp_path: Path) -> None:
    nest, plant = write(tmp_path, {"kind": "X", "angle": 30}, "cuts: {bevel: {lies_still: 0.5 kg}}\n")
    program, plan = tmp_path / "out.nc", tmp_path / "out.plan.json"
    assert kerfwise("solve", nest, "-p", plant, "--work", "0.05", "-o", program, "--plan", plan).code == 0
    checked = kerfwise("check", nest, program, "-p", plant)
    assert checked.code == 0, checked.out + checked.err
    times = [kerfwise("time", nest, made, "-p", plant) for made in (program, plan)]
    assert times[0].out == times[1].out
    assert "along no contour" not in times[0].err
    program.write_text(re.sub(r"(?s)\(CUT 1 P.outer ZONE 1 CW PASS 2.*?M5\n", "", program.read_text()))
    checked = kerfwise("check", nest, program, "-p", plant)
    assert checked.code == 1
    assert "P.outer: no pass that leans by -30 degrees" in checked.out


def test_a_plan_with_bevels_is_not_gone_on_with_after_a_stop(solved: Path) -> None:
    told = ("--lock-from", solved / "out.plan.json", "--upto", "2", "-o", solved / "rest.nc")
    resumed = kerfwise("solve", NEST, "-p", PROFILE, *told)
    assert resumed.code == 2
    assert "is not gone on with after a stop" in resumed.err
