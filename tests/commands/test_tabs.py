"""Tabs by the command line: what a planner can ask for, and what is refused, in one message, nothing written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise

A: dict[str, Any] = {"id": "A", "outer": [[40, 30], [120, 30], [120, 80], [40, 80]]}
TINY: dict[str, Any] = {"id": "T", "outer": [[20, 20], [25, 20], [25, 25], [20, 25]]}
LASER, PLASMA = "laser-st10kp-2mm", "plasma-carbon-steel"


def solved(folder: Path, part: dict[str, Any], rule: str, base: str = LASER, locks: str = "[]") -> Ended:
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 200, "height": 120}, "parts": [part]}
    (folder / "nest.json").write_text(json.dumps(nest))
    (folder / "plant.yaml").write_text(f"based_on: {base}\nrules:\n  hold-small-parts: {rule}\nlocks: {locks}\n")
    words = ("--plan", folder / "plan.json", "--work", "1", "-o", folder / "out.nc")
    return kerfwise("solve", folder / "nest.json", "-p", folder / "plant.yaml", *words)


def tabs(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((folder / "plan.json").read_text())["cuts"][0].get("tabs", [])
    return found


def nothing_written(folder: Path) -> bool:
    return sorted(file.name for file in folder.iterdir()) == ["nest.json", "plant.yaml"]


@pytest.mark.parametrize("base", [LASER, PLASMA])
def test_tabs_are_off_by_default(tmp_path: Path, base: str) -> None:
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 200, "height": 120}, "parts": [A]}
    (tmp_path / "nest.json").write_text(json.dumps(nest))
    ended = kerfwise("solve", tmp_path / "nest.json", "-p", base, "--plan", tmp_path / "plan.json", "--work", "1")
    assert ended.code == 0
    assert tabs(tmp_path) == []
    assert "tabs" not in (tmp_path / "plan.json").read_text()


def test_explain_says_why_a_tab_is_there(tmp_path: Path) -> None:
    assert solved(tmp_path, A, "{strength: hard, slat_pitch: 70 mm}").code == 0
    said = kerfwise("explain", tmp_path / "nest.json", tmp_path / "plan.json", "A.outer", "-p", tmp_path / "plant.yaml")
    text = "A is held by 2 tabs of 1 mm: its centroid is 40.0 mm from its left end, and slats lie 70 mm apart"
    assert text in said.out


def test_a_planner_locks_a_tab_there_and_none(tmp_path: Path) -> None:
    there = "[{contour: A.outer, tab: [60, 30]}]"
    assert solved(tmp_path, A, "{strength: hard}", locks=there).code == 0
    assert tabs(tmp_path) == [{"at": [60.0, 30.0], "width": 1.0}]
    assert "the operator has locked it" in (tmp_path / "plan.json").read_text()
    assert solved(tmp_path, A, "{strength: hard, tabs: all}", locks="[{contour: A.outer, tab: off}]").code == 0
    assert tabs(tmp_path) == []
    assert solved(tmp_path, A, "{strength: hard}", PLASMA, there).code == 0
    (one,) = tabs(tmp_path)
    assert one["at"] == pytest.approx([60.0, 30.0], abs=0.06)


def test_a_lock_without_the_rule_is_refused(tmp_path: Path) -> None:
    ended = solved(tmp_path, A, "off", locks="[{contour: A.outer, tab: [60, 30]}]")
    assert ended.code == 2
    assert "A.outer is locked to have a tab, and rule hold-small-parts, which makes tabs, is off" in ended.err
    assert nothing_written(tmp_path)


def test_drawn_tabs_that_the_profile_leaves_out_are_said(tmp_path: Path) -> None:
    ended = solved(tmp_path, {**A, "tabs": [{"at": [60, 30]}]}, "off")
    assert ended.code == 0
    assert "warning: the nest draws tabs (A.outer), and the profile's rule that leaves tabs is off" in ended.err
    assert tabs(tmp_path) == []


WRONG: dict[str, tuple[dict[str, Any], str, str, str]] = {
    "in a corner": (
        {**A, "tabs": [{"at": [41, 30]}]},
        "hard",
        LASER,
        "A.outer: the tab at (41, 30) lies in a corner, or less than 3 mm from one; move it along its edge, or lower "
        "corner of rules.hold-small-parts",
    ),
    "wider than its edge": (
        {**A, "tabs": [{"at": [40, 60], "width": 49.9}]},
        "hard",
        LASER,
        "A.outer: the tab at (40, 60) is wider than its edge: 50.1 mm with the kerf, on an edge of 50.0 mm",
    ),
    "off the contour": (
        {**A, "tabs": [{"at": [60, 40]}]},
        "hard",
        PLASMA,
        "A.outer: the tab at (60, 40) is 10.0 mm from the contour: give a point on it",
    ),
    "two of a torch that pierces": (
        {**A, "tabs": [{"at": [60, 30]}, {"at": [60, 80]}]},
        "hard",
        PLASMA,
        "A.outer: 2 tabs are asked for: each but the last would cost a pierce on the part; leave one",
    ),
    "no room": (TINY, "hard", LASER, "T.outer: no room for a tab: each needs a straight of 7 mm and a kerf"),
    "room for one of five": (
        {"id": "T", "outer": [[20, 20], [34, 20], [34, 34], [20, 34]]},
        "{strength: hard, count: 5}",
        LASER,
        "T.outer: room for 4 of 5 tabs",
    ),
    "no room where a cut ends": (TINY, "hard", PLASMA, "T.outer: its tab has no room beside the lead-in"),
    "width below 0 in the nest": (
        {**A, "tabs": [{"at": [60, 30], "width": -1}]},
        "hard",
        LASER,
        "part 'A', tab 1, width: -1 given, expected over 0",
    ),
    "width below 0 in the profile": (A, "{strength: hard, width: -1 mm}", LASER, "rules.hold-small-parts.width"),
    "width of 0": (A, "{strength: hard, width: 0}", LASER, "rules.hold-small-parts.width"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_cannot_be_is_one_message(what: str, tmp_path: Path) -> None:
    part, rule, base, text = WRONG[what]
    ended = solved(tmp_path, part, rule, base)
    assert ended.code == 2, ended.out + ended.err
    assert text in ended.err
    assert ended.err.count("kerfwise: ") == 1
    assert "Traceback" not in ended.err
    assert nothing_written(tmp_path)


def test_the_picture_and_the_drawing_show_tabs(tmp_path: Path) -> None:
    assert solved(tmp_path, A, "hard").code == 0
    words = ("--dxf", tmp_path / "out.dxf", "--picture", tmp_path / "out.svg", "--work", "1", "-o", tmp_path / "out.nc")
    assert kerfwise("solve", tmp_path / "nest.json", "-p", tmp_path / "plant.yaml", *words).code == 0
    assert (tmp_path / "out.dxf").read_text().count("POLYLINE\n") == 3
    assert "tab that holds the part" in (tmp_path / "out.svg").read_text()


def test_a_program_goes_on_past_a_tabbed_part(tmp_path: Path) -> None:
    other = {"id": "B", "outer": [[130, 30], [180, 30], [180, 80], [130, 80]]}
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 200, "height": 120}, "parts": [A, other]}
    assert solved(tmp_path, A, "hard").code == 0
    (tmp_path / "nest.json").write_text(json.dumps(nest))
    words = ("solve", tmp_path / "nest.json", "-p", tmp_path / "plant.yaml", "--work", "1", "-o")
    assert kerfwise(*words, tmp_path / "out.nc", "--plan", tmp_path / "plan.json").code == 0
    again = kerfwise(*words, tmp_path / "rest.nc", "--lock-from", tmp_path / "plan.json", "--upto", "1")
    assert again.code == 0, again.out + again.err
    assert " TAB " in (tmp_path / "rest.nc").read_text()
    rest = kerfwise("check", tmp_path / "nest.json", tmp_path / "rest.nc", "-p", tmp_path / "plant.yaml")
    assert rest.code == 0, rest.out
    third = kerfwise(*words, tmp_path / "third.nc", "--lock-from", tmp_path / "out.nc", "--upto", "1")
    assert third.code == 0, third.out + third.err
