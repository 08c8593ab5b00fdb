"""Several torches with scrap lines, tabs, locks, own rules and a range of spacings: the check, and the simulation."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import pytest

import kerfwise
from kerfwise import InputError, Nest, Profile, Result, load_profile, read_nest
from kerfwise.tests.checked import checked
from kerfwise.tests.commands.test_torches import STEP, nest_file, part, plant_file
from kerfwise.tests.metal.plant import plant, tabs_of
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.tools import canon

TOGETHER = {"C.hole1": "A.hole1", "C.outer": "A.outer", "D.outer": "B.outer"}
TABS = "rules: {hold-small-parts: {strength: hard, tabs: all, width: 0.5 mm, corner: 1 mm, slat_pitch: 60 mm}}\n"
LASER = "machine: {process: laser, dialect: linuxcnc, torches: {count: 2, spacing: 150 mm}}\n"


def made(folder: Path, text: str) -> tuple[Nest, Profile, Result]:
    """The nest, the profile and a plan that both judges find nothing wrong with."""
    plant_file(folder, text=text)
    profile = load_profile(folder / "plant.yaml")
    sheet = read_nest(nest_file(folder), profile)
    found = planned_of(sheet, profile)
    assert checked(sheet, found.program, profile).ok
    assert kerfwise.check(sheet, found.plan, profile).ok
    assert burnt(sheet, profile, found, found.program) == {}
    return sheet, profile, found


def planned_of(sheet: Nest, profile: Profile, work: float = 0.5) -> Result:
    found = kerfwise.solve(sheet, profile, work=work)
    assert found.verdict.ok, found.verdict.broken()
    return found


def burnt(sheet: Nest, profile: Profile, found: Result, program: str) -> dict[str, int]:
    return by_kind(simulate(profile.as_cut(sheet), program, **plant(profile), tabs=tabs_of(found.plan)))


def together(found: Result) -> dict[str, str]:
    return {planned.cut.contour: planned.cut.together for planned in found.plan.cuts if planned.cut.torch > 1}


@pytest.mark.slow
@pytest.mark.linuxcnc
def test_scrap_lines_are_cut_by_the_first_torch_alone(tmp_path: Path) -> None:
    sheet, profile, found = made(tmp_path, "cuts: {scrap: {grid: 200 mm}}\n")
    assert together(found) == TOGETHER
    lines = [planned for planned in found.plan.cuts if planned.kind == "scrap"]
    assert lines
    assert {planned.cut.torch for planned in lines} == {1}
    ran = canon.run(found.program)
    first_mm = sum(planned.length_mm for planned in found.plan.cuts if planned.cut.torch == 1)
    assert sum(burn.length_mm for burn in ran.cuts) == pytest.approx(first_mm, abs=0.1)
    head, tail = found.program.split(f" {lines[0].cut.contour} ZONE", 1)
    lit = head.rindex("M65 P1")
    both = f"{head[:lit]}M64 P1{head[lit + 6 :]} {lines[0].cut.contour} ZONE{tail}"
    assert not checked(sheet, both, profile).ok


@pytest.mark.linuxcnc
@pytest.mark.parametrize("process", ["plasma", "laser"])
def test_copies_have_the_same_tabs(tmp_path: Path, process: str) -> None:
    """A laser goes over its tabs with all torches off, and lights them again."""
    plant_file(tmp_path, text=TABS)
    if process == "laser":
        text = f"based_on: laser-st10kp-2mm\n{LASER}{TABS}"
        (tmp_path / "plant.yaml").write_text(text, encoding="utf-8")
    profile = load_profile(tmp_path / "plant.yaml")
    sheet = read_nest(nest_file(tmp_path), profile)
    found = planned_of(sheet, profile)
    assert burnt(sheet, profile, found, found.program) == {}
    cuts = {planned.cut.contour: planned.cut for planned in found.plan.cuts}
    held = [name for name, cut in cuts.items() if cut.torch > 1 and cut.tabs]
    assert held
    for name in held:
        first = cuts[cuts[name].together]
        assert len(first.tabs) == len(cuts[name].tabs) == (1 if process == "plasma" else 2)
        for one, other in zip(first.tabs, cuts[name].tabs, strict=True):
            assert other.at == pytest.approx((one.at[0], one.at[1] + STEP))


def test_a_tab_that_only_a_second_torch_leaves_out_is_missed(tmp_path: Path) -> None:
    """The path goes on to where it began: no torch leaves its tab."""
    sheet, profile, found = made(tmp_path, TABS)
    rows = found.program.split("\n")
    at = next(k for k, row in enumerate(rows) if " C.outer ZONE" in row)
    off = next(k for k in range(at, len(rows)) if rows[k].endswith("M5"))
    joined = next(planned.cut for planned in found.plan.cuts if planned.cut.contour == "A.outer")
    assert joined.lead_in is not None
    x, y = joined.lead_in.end
    closed = "\n".join([*rows[:off], f"G1 X{x:.4f} Y{y:.4f}", *rows[off:]])
    judged = checked(sheet, closed, profile)
    assert "hold-small-parts" in judged.broken()
    names = {name for j in judged.rules for v in j.violations if j.id == "hold-small-parts" for name in v.contours}
    assert {"A.outer", "C.outer"} <= names
    assert burnt(sheet, profile, found, closed)


@pytest.mark.parametrize(
    ("lock", "apart"),
    [
        ("{contour: A.outer, entry: [120, 60]}", set()),
        ("{contour: C.outer, entry: [120, 210]}", set()),
        ("{contour: C.outer, direction: cw}", set()),
        ("{part: D, zone: 1}", set()),
        ("{contour: S.outer, position: last}", set()),
        ("{contour: D.outer, position: first}", {"D.outer"}),
        ("{contour: A.outer, before: C.outer}", {"C.hole1", "C.outer"}),
    ],
)
def test_locks_hold_for_what_any_torch_cuts(tmp_path: Path, lock: str, apart: set[str]) -> None:
    """Parts that have a place or an order of their own are cut by themselves."""
    _, _, found = made(tmp_path, f"locks:\n  - {lock}\n")
    assert together(found) == {name: first for name, first in TOGETHER.items() if name not in apart}
    if "entry" in lock:
        one, other = (planned.cut for planned in found.plan.cuts if planned.cut.contour in ("A.outer", "C.outer"))
        assert one.entry == pytest.approx((120, 60))
        assert other.entry == pytest.approx((120, 60 + STEP))


def test_zones_know_orders_of_own_rules_about_copies(tmp_path: Path) -> None:
    own = "own_rules:\n  - {name: x, why: y, select: {part: D}, before: {part: S}}\n"
    _, _, found = made(tmp_path, f"rules: {{zone-order: {{zone_contours: 3}}}}\n{own}")
    assert together(found) == TOGETHER
    at = {planned.cut.contour: k for k, planned in enumerate(found.plan.cuts)}
    assert at["D.outer"] < at["S.outer"]


ROWS = [part(f"P{k}", 20 + 120 * (k % 2), 20 + 130 * (k // 2)) for k in range(8)]
"""Four rows of two plates, 130 mm apart."""


def movable(folder: Path, least: float, most: float, parts: list[dict[str, Any]]) -> tuple[Nest, Profile]:
    torches = f"{{count: 2, spacing: {least} mm, up_to: {most} mm}}"
    text = f"based_on: plasma-carbon-steel\nmachine: {{dialect: linuxcnc, torches: {torches}}}\n"
    (folder / "plant.yaml").write_text(text, encoding="utf-8")
    profile = load_profile(folder / "plant.yaml")
    return read_nest(nest_file(folder, parts, sheet={"width": 360, "height": 600}), profile), profile


@pytest.mark.parametrize(("least", "most", "spacing"), [(100, 300, 130), (200, 300, 260), (300, 450, 390)])
def test_torches_that_can_be_moved_stand_where_fewest_cuts_are_left(
    tmp_path: Path, least: float, most: float, spacing: float
) -> None:
    """Of rows 130 mm apart two and two are cut together, next to each other or with one between; else the ends."""
    sheet, profile = movable(tmp_path, least, most, ROWS)
    found = planned_of(sheet, profile)
    assert f"(TORCHES 2, {spacing} MM APART ALONG Y)" in found.program
    assert len(together(found)) == (2 if spacing == 390 else 4)
    assert checked(sheet, found.program, profile).ok
    assert kerfwise.check(sheet, found.plan, profile).ok
    assert burnt(sheet, profile.at_spacing(spacing), found, found.program) == {}


def test_no_spacing_leaves_fewer_cuts(tmp_path: Path) -> None:
    """Each distance between two parts is tried by itself."""
    sheet, profile = movable(tmp_path, 100, 450, [*ROWS[:5], part("Q", 20, 480)])
    chosen = planned_of(sheet, profile).plan.sequence().spacing_mm("y")
    fewest = {}
    for mm in (130, 190, 200, 260, 330, 450):
        alone, at = movable(tmp_path, mm, mm, [*ROWS[:5], part("Q", 20, 480)])
        with contextlib.suppress(InputError):  # no two parts are so far apart
            fewest[mm] = len(together(planned_of(alone, at, work=0.05)))
    assert chosen is not None
    assert len(fewest) > 2
    assert fewest[int(chosen)] == max(fewest.values())


def test_a_program_for_torches_out_of_reach_is_found(tmp_path: Path) -> None:
    sheet, profile = movable(tmp_path, 100, 300, ROWS)
    found = planned_of(sheet, profile)
    for told, broken in (("260", {"every-contour-once"}), ("330", {"torches"})):
        other = found.program.replace("(TORCHES 2, 130 MM", f"(TORCHES 2, {told} MM")
        judged = checked(sheet, other, profile)
        assert broken <= set(judged.broken())
    texts = [v.text for j in judged.rules if j.id == "torches" for v in j.violations]
    assert texts == ["the program is for 2 torches 330 mm apart along Y, the profile has 2 100 to 300 mm apart along Y"]
    silent = found.program.replace("(TORCHES 2, 130 MM APART ALONG Y)\n", "")
    assert "torches" in checked(sheet, silent, profile).broken()
    assert checked(sheet, silent, profile, found.plan).ok


def test_no_spacing_fits(tmp_path: Path) -> None:
    sheet, profile = movable(tmp_path, 10, 20, ROWS)
    with pytest.raises(InputError, match="has a copy 10 to 20 mm along y from it"):
        kerfwise.facts(sheet, profile)
    with pytest.raises(InputError, match="up_to: 20 mm is less than the least spacing, 30 mm"):
        movable(tmp_path, 30, 20, ROWS)
