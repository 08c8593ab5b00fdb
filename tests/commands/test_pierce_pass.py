"""Pierce passes by the command line: plans, programs of every dialect, damaged ones, and what is refused."""

from __future__ import annotations

import json
import math
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from kerfwise import load_profile, read_nest, read_plan
from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import few

PARTS = [
    {"id": "A", "outer": [[20, 20], [120, 20], [120, 120], [20, 120]],
     "holes": [[[50, 50], [80, 50], [80, 80], [50, 80]]], "marks": [[[30, 100], [60, 100]]]},
    {"id": "B", "outer": [[140, 20], [240, 20], [240, 120], [140, 120]]},
    {"id": "C", "outer": [[260, 20], [360, 20], [360, 120], [260, 120]],
     "holes": [[[290, 50], [330, 50], [330, 90], [290, 90]]]},
    {"id": "D", "outer": [[380, 20], [480, 20], [480, 120], [380, 120]]},
]  # fmt: skip
HOLES = {"A.hole1", "A.outer", "B.outer", "C.hole1", "C.outer", "D.outer"}


def nest_file(folder: Path, **more: Any) -> Path:
    parts = more.pop("parts", PARTS)
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 500, "height": 140}, "parts": parts, **more}
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    return folder / "nest.json"


def plant_file(folder: Path, text: str = "", based_on: str = "plasma-carbon-steel", mode: str = "zone") -> Path:
    dwell = "machine: {pierce_dwell: program}\n" if based_on.startswith("plasma") and "machine:" not in text else ""
    cuts = "" if "cuts:" in text else f"cuts: {{pierce_pass: {mode}}}\n"
    (folder / "plant.yaml").write_text(f"based_on: {based_on}\n{dwell}{cuts}{text}", encoding="utf-8")
    return folder / "plant.yaml"


def solve(nest: Path, *words: object) -> Ended:
    folder = nest.parent
    files = ("-o", folder / "nest.nc", "--plan", folder / "nest.plan.json", "--conflict-picture", folder / "c.svg")
    return kerfwise("solve", nest, "-p", folder / "plant.yaml", *files, "--work", "1", *words)


def planned(folder: Path, text: str = "", mode: str = "zone", **more: Any) -> tuple[Path, dict[str, Any], str]:
    plant_file(folder, text, more.pop("based_on", "plasma-carbon-steel"), mode)
    nest = nest_file(folder, **more)
    done = solve(nest)
    assert done.code == 0, done.err + done.out
    assert "holds      hard pierce-pass" in done.out
    assert " m without the way of the pierce pass" in done.out
    plan = json.loads((folder / "nest.plan.json").read_text(encoding="utf-8"))
    return nest, plan, (folder / "nest.nc").read_text(encoding="utf-8")


TWO_ZONES = "rules:\n  zone-order: {zone_contours: 4}\n"


@pytest.mark.linuxcnc
@pytest.mark.parametrize("mode", ["zone", "sheet"])
def test_all_holes_of_a_zone_come_first(tmp_path: Path, mode: str) -> None:
    """The simulation burns it besides; LinuxCNC's interpreter reads the same lengths, holes and waits."""
    nest, plan, text = planned(tmp_path, TWO_ZONES, mode)
    assert {hole["contour"] for hole in plan["pierces"]} == HOLES
    cuts = {cut["contour"]: cut for cut in plan["cuts"]}
    zones = {cut["zone"] for cut in plan["cuts"]}
    assert len(zones) > 1
    first = {}
    for cut in (cut for cut in plan["cuts"] if cut["kind"] != "mark"):
        first.setdefault(cut["zone"] if mode == "zone" else 0, cut["order"])
    for hole in plan["pierces"]:
        cut = cuts[hole["contour"]]
        assert hole["at"] == cut["pierce"]
        assert hole["before"] == first[cut["zone"] if mode == "zone" else 0]
        assert hole["end_s"] - hole["start_s"] == pytest.approx(0.5)
        assert hole["end_s"] <= cut["start_s"]
        assert any("begins at a hole of the pierce pass" in why for why in cut["because"])
    ran = canon.run(text)
    dots = [burn for burn in ran.cuts if burn.length_mm == 0]
    assert len(dots) == len(HOLES) == plan["totals"]["pierces"]
    cut_mm = sum(cut["length_mm"] for cut in plan["cuts"] if cut["kind"] != "mark")
    assert sum(burn.length_mm for burn in ran.cuts) == pytest.approx(cut_mm, abs=0.1)
    assert ran.dwell_s == pytest.approx(0.5 * len(HOLES) + load_profile().machine.mark_time_s)
    assert ran.idle_mm == pytest.approx(plan["totals"]["idle_mm"], abs=0.1)
    for made in ("nest.nc", "nest.plan.json"):
        judged = kerfwise("check", nest, tmp_path / made, "-p", tmp_path / "plant.yaml")
        assert judged.code == 0, judged.out
    told = kerfwise("explain", nest, tmp_path / "nest.plan.json", "B.outer", "-p", tmp_path / "plant.yaml")
    assert "begins at a hole of the pierce pass" in told.out


def test_order_and_leads_are_those_without_it(tmp_path: Path) -> None:
    _, plan, _ = planned(tmp_path)
    plant_file(tmp_path, mode="off")
    assert solve(tmp_path / "nest.json").code == 0
    plain = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert "pierces" not in plain
    keys = ("contour", "pierce", "lead_in", "lead_out", "direction", "length_mm", "zone")
    assert [[cut[key] for key in keys] for cut in plan["cuts"]] == [[cut[key] for key in keys] for cut in plain["cuts"]]
    assert plan["totals"]["pierces"] == plain["totals"]["pierces"]
    assert plan["totals"]["idle_mm"] > plain["totals"]["idle_mm"]


def _marks_s(plan: dict[str, Any]) -> float:
    return sum(cut["end_s"] - cut["start_s"] for cut in plan["cuts"] if cut["kind"] == "mark")


def test_the_plan_is_of_its_published_form(tmp_path: Path) -> None:
    _, plan, _ = planned(tmp_path)
    form = json.loads((Path(__file__).parents[2] / "models" / "plan" / "plan.schema.json").read_text(encoding="utf-8"))
    assert [error.message for error in Draft202012Validator(form).iter_errors(plan)] == []
    again = json.loads(read_plan(tmp_path / "nest.plan.json").to_json())
    assert again["pierces"] == plan["pierces"]


@pytest.mark.parametrize("dialect", ["linuxcnc", "grbl", "eia", "burny", "essi"])
def test_every_dialect_spells_it(tmp_path: Path, dialect: str) -> None:
    based_on = "laser-st10kp-2mm" if dialect == "grbl" else "plasma-carbon-steel"
    plain = [{"id": part["id"], "outer": part["outer"]} for part in PARTS]  # ESSI's steps leave some of small holes
    text = f"machine: {{dialect: {dialect}, pierce_dwell: program}}\n"
    nest, plan, _ = planned(tmp_path, text, "sheet", based_on=based_on, parts=plain)
    assert len(plan["pierces"]) == len(PARTS)
    words = ("-p", tmp_path / "plant.yaml", "--plan", tmp_path / "nest.plan.json")
    judged = kerfwise("check", nest, tmp_path / "nest.nc", *words)
    assert judged.code == 0, judged.out
    assert "holds      hard pierce-pass" in judged.out


def _pierces(text: str) -> list[list[str]]:
    """The blocks of each pierce."""
    lines = text.split("\n")
    at = [k for k, line in enumerate(lines) if line.startswith("(PIERCE ") and "DELAY" not in line]
    return [lines[k : k + 5] for k in at]


def _left_out(text: str) -> str:
    return text.replace("\n".join(_pierces(text)[2]) + "\n", "")


def _moved(text: str) -> str:
    block = _pierces(text)[2]
    x = re.search(r"X(\S+)", block[1])
    assert x is not None
    return text.replace("\n".join(block), "\n".join(block).replace(x[0], f"X{float(x[1]) + 0.2:g}"))


def _late(text: str) -> str:
    """A hole after the cut that begins there."""
    block = "\n".join(_pierces(text)[2]) + "\n"
    return text.replace(block, "").replace("(HOME)\n", block + "(HOME)\n")


def _extra(text: str) -> str:
    more = "(PIERCE 99)\nG0 X250 Y130\nM3 $0 S1\nG4 P0.5\nM5 $0\n"
    return text.replace("\n".join(_pierces(text)[0]), more + "\n".join(_pierces(text)[0]))


def _in_dropped_waste(text: str) -> str:
    """A hole in the slug of A.hole1, when that is out."""
    lines = text.split("\n")
    k = next(k for k, line in enumerate(lines) if re.match(r"\(CUT \d+ A\.outer", line))
    return "\n".join([*lines[:k], "(PIERCE 99)", "G0 X70 Y70", "M3 $0 S1", "G4 P0.5", "M5 $0", *lines[k:]])


def _twice(text: str) -> str:
    """A cut that waits at its hole as if it pierced."""
    lines = text.split("\n")
    k = next(k for k, line in enumerate(lines) if re.match(r"\(CUT \d+ B\.outer", line))
    lit = next(j for j in range(k, k + 6) if "M3 $0" in lines[j])
    return "\n".join([*lines[: lit + 1], "G4 P0.5", *lines[lit + 1 :]])


DAMAGES = {
    "left out": (_left_out, "pierce-pass", "where no hole was pierced before", {"not-pierced"}),
    "moved": (_moved, "pierce-pass", "where no hole was pierced before", {"not-pierced", "pierce-unused"}),
    "late": (_late, "pierce-pass", "is pierced after cut", {"not-pierced", "pierce-unused"}),
    "left over": (_extra, "pierce-pass", "no cut begins at the hole that is pierced at (250", {"pierce-unused"}),
    "in a slug": (_in_dropped_waste, "pierce-pass", "is pierced in A.hole1", {"pierce-unused", "loose-waste-burnt"}),
    "waits twice": (_twice, "pierce-delay", "the torch stands for 0.5 s before it moves", set()),
}  # fmt: skip
ALIKE = ("moved", "left over")
"""Each has a like one: a hole that is left out, one in a slug."""


@pytest.mark.parametrize("case", few(sorted(DAMAGES, key=lambda case: case in ALIKE), 4))
def test_a_damaged_program_is_told(tmp_path: Path, case: str) -> None:
    """By the check, and by the simulation."""
    damage, rule, told, kinds = DAMAGES[case]
    nest, _, text = planned(tmp_path, TWO_ZONES, "sheet")
    damaged = damage(text)
    assert damaged != text
    (tmp_path / "damaged.nc").write_text(damaged, encoding="utf-8")
    judged = kerfwise("check", nest, tmp_path / "damaged.nc", "-p", tmp_path / "plant.yaml")
    assert judged.code == 1
    assert f"broken     hard {rule} " in judged.out
    assert told in judged.out
    profile = load_profile(tmp_path / "plant.yaml")
    assert kinds <= {found.kind for found in simulate(read_nest(nest), damaged, **plant(profile))}


def test_a_hole_with_another_zone_is_told(tmp_path: Path) -> None:
    """A program of one pass is judged by a profile that asks for one a zone."""
    nest, _, _ = planned(tmp_path, TWO_ZONES, "sheet")
    plant_file(tmp_path, TWO_ZONES, mode="zone")
    judged = kerfwise("check", nest, tmp_path / "nest.nc", "-p", tmp_path / "plant.yaml")
    assert "broken     hard pierce-pass" in judged.out
    assert "with another zone" in judged.out
    plant_file(tmp_path, TWO_ZONES, mode="off")
    judged = kerfwise("check", nest, tmp_path / "nest.nc", "-p", tmp_path / "plant.yaml")
    assert judged.code == 1
    assert "burns along no contour" in judged.out


@pytest.mark.parametrize("change", few(["left out", "of another", "late", "moved", "too soon"], 3))
def test_a_damaged_plan_is_told(tmp_path: Path, change: str) -> None:
    nest, plan, _ = planned(tmp_path)
    hole = plan["pierces"][1]
    if change == "left out":
        plan["pierces"].remove(hole)
    elif change == "moved":
        hole["at"] = [hole["at"][0] + 0.2, hole["at"][1]]
    elif change == "of another":
        hole["contour"] = plan["pierces"][0]["contour"]
    elif change == "too soon":
        hole["start_s"], hole["end_s"] = 0.0, 0.0
    else:
        hole["before"] = 99
    (tmp_path / "nest.plan.json").write_text(json.dumps(plan), encoding="utf-8")
    judged = kerfwise("check", nest, tmp_path / "nest.plan.json", "-p", tmp_path / "plant.yaml")
    assert judged.code == 1
    assert f"broken     hard {'totals' if change == 'too soon' else 'pierce-pass'}" in judged.out


CLOSE = [{"id": f"R{k}", "outer": [[x, 20], [x + 60, 20], [x + 60, 120], [x, 120]]}
         for k, x in enumerate(range(20, 440, 68), 1)]  # fmt: skip


def test_links_need_no_hole(tmp_path: Path) -> None:
    text = "cuts: {pierce_pass: zone, links: {longest: 60 mm}}\nmachine: {pierce_dwell: program, pierce_time: 2 s}\n"
    _, plan, _ = planned(tmp_path, text, parts=CLOSE)
    linked = {cut["contour"] for cut in plan["cuts"] if cut.get("linked")}
    assert linked
    assert {hole["contour"] for hole in plan["pierces"]} == {cut["contour"] for cut in plan["cuts"]} - linked


MIDDLE = {"id": "M", "outer": [[200, 60], [300, 60], [300, 80], [200, 80]]}


@pytest.mark.slow
def test_scrap_lines_edge_starts_and_tabs(tmp_path: Path) -> None:
    """Lines and edge starts begin as ever; a part that tabs hold is pierced with the others."""
    _, plan, _ = planned(tmp_path, scrap=[[[250, 0], [250, 140]]])
    assert "scrap1" not in {hole["contour"] for hole in plan["pierces"]}
    at_edge = [{"id": "A", "outer": [[4, 40], [64, 40], [64, 100], [4, 100]]}, MIDDLE]
    text = "machine: {edge_preheat: 7 s, travel_x: [-20, 3000], travel_y: [-20, 1500]}\n"
    text += "leads: {edge_start: true}\nobjective: {time: 92}\n"
    _, plan, _ = planned(tmp_path, text, based_on="oxyfuel-thick-plate", parts=at_edge)
    begins = {cut["contour"]: cut["pierce"] for cut in plan["cuts"]}
    off = {name for name, (x, y) in begins.items() if not (0 < x < 500 and 0 < y < 140)}
    assert off
    assert not off & {hole["contour"] for hole in plan["pierces"]}
    tabs = "rules:\n  hold-small-parts: {strength: hard, width: 0.5 mm, count: 2, slat_pitch: 90 mm, slats: y}\n"
    _, plan, _ = planned(tmp_path, tabs, based_on="laser-st10kp-2mm", parts=CLOSE)
    assert any("tabs" in cut for cut in plan["cuts"])
    assert len(plan["pierces"]) == len(CLOSE)


REFUSED = {
    "machine waits": ("machine: {dialect: linuxcnc-qtplasmac, pierce_dwell: machine}\n", "waits at every start"),
    "dwells": ("rules:\n  t-max: {strength: hard, dwells: true}\n", "where the torch waits for metal to cool"),
    "no such word": ("cuts: {pierce_pass: part}\nmachine: {pierce_dwell: program}\n", "cuts.pierce_pass"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_go_together_is_refused(tmp_path: Path, case: str) -> None:
    text, told = REFUSED[case]
    plant_file(tmp_path, text)
    done = solve(nest_file(tmp_path))
    assert (done.code, "Traceback" in done.err) == (2, False)
    assert told in done.err
    assert "plant.yaml" in done.err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["nest.json", "plant.yaml"]


def test_no_plan_goes_on_from_a_pass_or_with_one(tmp_path: Path) -> None:
    nest, _, _ = planned(tmp_path)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    rest = ("-o", tmp_path / "rest.nc", "--upto", 2, "--work", 1)
    words = ("solve", nest, "-p", tmp_path / "plant.yaml", *rest)
    for old in ("nest.plan.json", "nest.nc"):
        done = kerfwise(*words, "--lock-from", tmp_path / old)
        assert (done.code, "has a pierce pass" in done.err) == (2, True)
    plant_file(tmp_path, mode="off")
    assert solve(nest).code == 0
    plant_file(tmp_path, mode="zone")
    done = kerfwise(*words, "--lock-from", tmp_path / "nest.plan.json")
    assert (done.code, "cannot have a pierce pass" in done.err) == (2, True)
    assert not (tmp_path / "rest.nc").exists()
    assert "nest.nc" in before


def test_old_programs_with_a_pass_keep_their_order(tmp_path: Path) -> None:
    planned(tmp_path)
    done = kerfwise("resequence", tmp_path / "nest.nc", "-p", tmp_path / "plant.yaml", "-o", tmp_path / "new.nc")
    assert (done.code, "does not move, as in a pierce pass" in done.err) == (2, True)
    assert not (tmp_path / "new.nc").exists()


def test_the_picture_has_the_way_of_the_pass(tmp_path: Path) -> None:
    nest, plan, _ = planned(tmp_path)
    assert kerfwise("plot", nest, tmp_path / "nest.plan.json", "-o", tmp_path / "nest.svg").code == 0
    assert "pierce pass" in (tmp_path / "nest.svg").read_text(encoding="utf-8")
    stops = [hole["at"] for hole in plan["pierces"]]
    assert sum(math.dist(a, b) for a, b in pairwise(stops)) < 700
