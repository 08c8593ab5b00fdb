"""Scrap lines by the command line: cut when all parts are out, and refused where they cannot be cut."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import ezdxf
import pytest
from jsonschema import Draft202012Validator

from kerfwise import load_profile, read_nest
from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.tools import canon

PARTS = [
    {"id": "A", "outer": [[20, 80], [120, 80], [120, 180], [20, 180]],
     "holes": [[[50, 110], [80, 110], [80, 140], [50, 140]]]},
    {"id": "B", "outer": [[170, 80], [270, 80], [270, 180], [170, 180]], "marks": [[[200, 100], [230, 100]]]},
    {"id": "C", "outer": [[320, 20], [460, 20], [460, 250], [320, 250]]},
]  # fmt: skip
LINES = [[[145, 0], [145, 300]], [[295, 0], [295, 300]], [[121.5, 130], [145, 130]], [[390, 251.5], [390, 300]]]


def nest_file(folder: Path, scrap: list[Any], name: str = "nest.json") -> Path:
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 500, "height": 300}, "parts": PARTS, "scrap": scrap}
    (folder / name).write_text(json.dumps(nest), encoding="utf-8")
    return folder / name


def solve(nest: Path, *words: str | Path) -> Ended:
    folder = nest.parent
    files = ("-o", folder / "nest.nc", "--plan", folder / "nest.plan.json", "--conflict-picture", folder / "c.svg")
    return kerfwise("solve", nest, *files, "--work", "1", *words)


def order_in(folder: Path) -> list[str]:
    plan = json.loads((folder / "nest.plan.json").read_text(encoding="utf-8"))
    return [cut["contour"] for cut in plan["cuts"]]


@pytest.mark.linuxcnc
def test_they_are_cut_when_all_parts_are_out(tmp_path: Path) -> None:
    """The simulation burns the program besides, and LinuxCNC's interpreter reads as much torch-on length in it."""
    nest = nest_file(tmp_path, LINES)
    done = solve(nest)
    assert done.code == 0, done.err
    order = order_in(tmp_path)
    assert sorted(order[-4:]) == ["scrap1", "scrap2", "scrap3", "scrap4"]
    assert order.index("scrap3") < order.index("scrap1")
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert {(cut["part"], cut["kind"], cut["zone"]) for cut in plan["cuts"][-4:]} == {("", "scrap", 2)}
    text = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    assert sum(burn.length_mm for burn in canon.run(text).cuts) == pytest.approx(
        sum(cut["length_mm"] for cut in plan["cuts"] if cut["kind"] != "mark"), abs=0.1
    )
    for made in ("nest.nc", "nest.plan.json"):
        judged = kerfwise("check", nest, tmp_path / made)
        assert judged.code == 0, judged.out


def test_parts_are_cut_as_without_them(tmp_path: Path) -> None:
    """Leads, zones and the start side do not look at lines that are cut when all is over."""
    facts = {}
    for name, scrap in (("with", LINES), ("without", [])):
        assert kerfwise("facts", nest_file(tmp_path, scrap), "-o", tmp_path / f"{name}.json").code == 0
        facts[name] = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
    for key in ("start_side", "start_side_because", "sides"):
        assert facts["with"][key] == facts["without"][key]
    assert facts["with"]["contours"][:5] == facts["without"]["contours"]
    beside = {row["id"]: row["scrap_beside"] for row in facts["with"]["contours"][5:]}
    assert beside == {
        "scrap1": ["scrap2", "scrap3"],
        "scrap2": ["scrap1", "scrap4"],
        "scrap3": ["scrap1"],
        "scrap4": ["scrap2"],
    }
    own = [row for row in facts["with"]["candidates"] if not row["contour"].startswith("scrap")]
    assert own == facts["without"]["candidates"]


@pytest.mark.parametrize(
    ("scrap", "told"),
    [
        ([[[0, 130], [60, 130]]], "scrap1 runs through part A"),
        ([[[0, 130], [19.5, 130]]], "scrap1 comes within 0.500 mm of A.outer at (20.0, 130.0), less than the kerf"),
        ([[[145, 0], [145, 310]]], "scrap1 runs 10.000 mm off the sheet"),
        ([[[145, 0], [145, 300]], [[130, 40], [160, 40]]], "scrap1 and scrap2 cross at (145.0, 40.0)"),
        ([[[145, 0]]], "scrap line 1"),
        ([[[145, 0], [145, "x"]]], "scrap line 1, vertex 2"),
    ],
)  # fmt: skip
def test_bad_lines_are_refused_and_nothing_is_written(tmp_path: Path, scrap: list[Any], told: str) -> None:
    done = solve(nest_file(tmp_path, scrap))
    assert (done.code, "Traceback" in done.err) == (2, False)
    assert told in done.err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["nest.json"]


def test_own_rules_name_them_and_locks_too(tmp_path: Path) -> None:
    profile = tmp_path / "plant.yaml"
    profile.write_text(
        "own_rules:\n- name: right first\n  why: the crane stands there\n"
        "  select: {kind: scrap, left_gap_mm: '> 200'}\n  before: {kind: scrap, left_gap_mm: '< 200'}\n"
        "locks:\n- {contour: scrap1, direction: cw}\n",
        encoding="utf-8",
    )
    done = solve(nest_file(tmp_path, LINES), "-p", profile)
    assert done.code == 0, done.err
    assert order_in(tmp_path)[-4:] == ["scrap4", "scrap2", "scrap3", "scrap1"]
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert plan["cuts"][-1]["direction"] == "cw"


DAMAGES = {
    "a line before a part": (("A.outer", "scrap3"), {"scrap-last", "zone-order", "part-contiguous"}),
    "a branch after its line": (("scrap3", "scrap1"), {"scrap-last", "loose-metal"}),
}


@pytest.mark.parametrize("case", DAMAGES)
def test_a_damaged_plan_is_told(tmp_path: Path, case: str) -> None:
    (one, other), rules = DAMAGES[case]
    nest = nest_file(tmp_path, LINES)
    assert solve(nest).code == 0
    file = tmp_path / "nest.plan.json"
    plan = json.loads(file.read_text(encoding="utf-8"))
    at = {cut["contour"]: k for k, cut in enumerate(plan["cuts"])}
    a, b = plan["cuts"][at[one]], plan["cuts"][at[other]]
    plan["cuts"][at[one]], plan["cuts"][at[other]] = b, a
    for k, cut in enumerate(plan["cuts"], 1):
        cut["order"] = k
    file.write_text(json.dumps(plan), encoding="utf-8")
    judged = kerfwise("check", nest, file)
    broken = {line.split()[2] for line in judged.out.splitlines() if line.startswith("broken")}
    assert judged.code == 1
    assert rules <= broken


def test_a_line_left_out_or_moved_is_told(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, LINES)
    assert solve(nest).code == 0
    text = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    longer = nest_file(tmp_path, [*LINES, [[480, 0], [480, 300]]], "more.json")
    assert "scrap5 is not cut" in kerfwise("check", longer, tmp_path / "nest.nc").out
    (tmp_path / "moved.nc").write_text(text.replace("X390 ", "X400 "), encoding="utf-8")
    assert "burns along no contour of the nest" in kerfwise("check", nest, tmp_path / "moved.nc").out
    half = text.replace("X145 Y300", "X145 Y200")
    assert half != text
    (tmp_path / "half.nc").write_text(half, encoding="utf-8")
    assert "contour-geometry" in kerfwise("check", nest, tmp_path / "half.nc").out


@pytest.mark.slow
def test_work_goes_on_after_a_stop_among_the_lines(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, LINES)
    assert solve(nest).code == 0
    order = order_in(tmp_path)
    upto = str(order.index("scrap3") + 1)
    rest = ("--lock-from", tmp_path / "nest.plan.json", "--upto", upto)
    done = kerfwise("solve", nest, "--work", "1", *rest, "-o", tmp_path / "rest.nc", "--plan", tmp_path / "rest.json")
    assert done.code == 0, done.err
    cuts = json.loads((tmp_path / "rest.json").read_text(encoding="utf-8"))["cuts"]
    assert [cut["contour"] for cut in cuts] == [name for name in order if name in {c["contour"] for c in cuts}]
    assert kerfwise("check", nest, tmp_path / "rest.nc").code == 0


def test_a_drawing_of_the_paths_has_a_layer_for_them(tmp_path: Path) -> None:
    assert solve(nest_file(tmp_path, LINES), "--dxf", tmp_path / "paths.dxf").code == 0
    assert (tmp_path / "paths.dxf").read_text(encoding="utf-8").count("CUT_SCRAP") >= len(LINES)


def test_nothing_is_asked_of_them_by_default() -> None:
    assert load_profile().drawing.scrap_lines == "ignore"


STEPPED = [{"id": "A", "outer": [[20, 20], [220, 20], [220, 280], [20, 280]]},
           {"id": "B", "outer": [[240, 20], [340, 20], [340, 80], [240, 80]]}]  # fmt: skip


def made_lines(folder: Path, parts: list[Any], scrap: str) -> Ended:
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 500, "height": 300}, "parts": parts}
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    (folder / "plant.yaml").write_text(f"cuts: {{scrap: {scrap}}}\n", encoding="utf-8")
    return solve(folder / "nest.json", "-p", folder / "plant.yaml")


def test_a_grid_and_a_remnant_are_made_and_the_remnant_is_written(tmp_path: Path) -> None:
    done = made_lines(tmp_path, STEPPED, "{grid: 150 mm, remnant: right}")
    assert done.code == 0, done.err
    assert "nest.remnant.json" in done.out
    assert "nest.remnant.dxf" in done.out
    rest = json.loads((tmp_path / "nest.remnant.json").read_text(encoding="utf-8"))
    # 500 - 220 less the kerf of A and half that of the line; 300 - 80 less as much
    assert rest["sheet"] == {"width": 277.74, "height": 217.74}
    judged = kerfwise("check", tmp_path / "nest.json", tmp_path / "nest.nc", "-p", tmp_path / "plant.yaml")
    assert judged.code == 0, judged.out
    rest["parts"] = [{"id": "C", "outer": [[20, 20], [120, 20], [120, 120], [20, 120]]}]
    for name in ("next.json", "next.dxf"):
        if name.endswith("json"):
            (tmp_path / name).write_text(json.dumps(rest), encoding="utf-8")
            sheet = read_nest(tmp_path / name).sheet
        else:
            drawing = ezdxf.readfile(tmp_path / "nest.remnant.dxf")
            drawing.modelspace().add_circle((100, 100), 20, dxfattribs={"layer": "parts"})
            drawing.saveas(tmp_path / name)
            sheet = read_nest(tmp_path / name).sheet
        assert sheet.bounds == pytest.approx((0, 0, 277.74, 217.74))
        assert sheet.stated


FULL = [*STEPPED[:1], {"id": "B", "outer": [[240, 20], [480, 20], [480, 280], [240, 280]]}]


@pytest.mark.parametrize(
    ("parts", "scrap", "told"),
    [
        (FULL, "{remnant: right}", "cuts.scrap.remnant: right leaves nothing to save: the largest unused rectangle"),
        (FULL, "{grid: 0 mm}", "cuts.scrap.grid"),
        (FULL, "{remnant: west}", "cuts.scrap.remnant"),
    ],
)
def test_what_cannot_be_made_is_refused_and_nothing_is_written(
    tmp_path: Path, parts: list[Any], scrap: str, told: str
) -> None:
    done = made_lines(tmp_path, parts, scrap)
    assert (done.code, "Traceback" in done.err) == (2, False)
    assert told in done.err.replace("'", "")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["nest.json", "plant.yaml"]


def test_a_remnant_alone_is_no_nest(tmp_path: Path) -> None:
    assert made_lines(tmp_path, STEPPED, "{remnant: right}").code == 0
    done = kerfwise("solve", tmp_path / "nest.remnant.json")
    assert (done.code, "the nest has no parts: a sheet alone is there to nest parts on" in done.err) == (2, True)


def test_the_remnant_of_a_nest_is_not_written_over_it(tmp_path: Path) -> None:
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 500, "height": 300}, "parts": STEPPED}
    (tmp_path / "a.remnant.json").write_text(json.dumps(nest), encoding="utf-8")
    (tmp_path / "plant.yaml").write_text("cuts: {scrap: {remnant: right}}\n", encoding="utf-8")
    done = kerfwise("solve", tmp_path / "a.remnant.json", "-p", tmp_path / "plant.yaml", "-o", tmp_path / "a.nc")
    assert done.code == 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.remnant.json", "plant.yaml"]


def test_the_plan_is_of_its_published_form(tmp_path: Path) -> None:
    assert solve(nest_file(tmp_path, LINES)).code == 0
    form = json.loads((Path(__file__).parents[2] / "models" / "plan" / "plan.schema.json").read_text(encoding="utf-8"))
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert [error.message for error in Draft202012Validator(form).iter_errors(plan)] == []
