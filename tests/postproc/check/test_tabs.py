"""Programs with tabs, damaged by hand: a tab that is missing, too narrow, too wide, or in a corner is found."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import kerfwise
from kerfwise import CheckResult, Profile, Result, read_plan
from kerfwise.rule_kit import Strength, nest, part, rect
from kerfwise.tests.checked import checked
from kerfwise.tests.postproc.plans import with_tabs

PLATE = nest(200, 120, part("A", rect(40, 30, 80, 50)))
LASER, PLASMA = "laser-st10kp-2mm", "plasma-carbon-steel"
TAB = r"N\d+ M5\n((?:N\d+ G[123] .*\n)+)N\d+ M3 S1\n"
"""How a laser's program goes over a tab."""
WHY = "its centroid is 40.0 mm from one end, and slats lie 60 mm apart"


def profile(name: str, strength: Strength = "hard") -> Profile:
    return with_tabs(name, strength, width_mm=0.8)


@cache
def made(name: str) -> Result:
    plant = profile(name)
    return kerfwise.solve(PLATE, plant, work=1)


def judged(name: str, program: str, strength: Strength = "hard") -> CheckResult:
    assert program != made(name).program or strength == "off"
    return checked(PLATE, program, profile(name, strength))


def moved(text: str, of: str, by_mm: float) -> str:
    """The program with one X word moved."""
    assert text.count(of) == 1
    return text.replace(of, f"X{float(of[1:]) + by_mm:g}")


def _filed(tab: Any) -> Any:
    return replace(tab, at=(round(tab.at[0], 6), round(tab.at[1], 6)))


@pytest.mark.parametrize(("name", "count"), [(LASER, 2), (PLASMA, 1)])
def test_plan_and_program_hold(name: str, count: int, tmp_path: object) -> None:
    planned = made(name)
    assert planned.verdict.ok
    assert len(planned.plan.cuts[0].cut.tabs) == count
    assert any(text.startswith("A is held by") for text in planned.plan.cuts[0].because)
    file = tmp_path / "plan.json"  # type: ignore[operator]
    file.write_text(planned.plan.to_json())
    again = read_plan(file)
    assert again.cuts[0].cut.tabs == tuple(map(_filed, planned.plan.cuts[0].cut.tabs))
    assert kerfwise.check(PLATE, again, profile(name)).ok


def test_a_missing_tab() -> None:
    once = re.sub(TAB, r"\1", made(LASER).program, count=1)
    result = judged(LASER, once)
    assert result.broken() == ("hold-small-parts",)
    assert f"A.outer (cut 1) has 1 tab, not 2: {WHY}" in str(result)
    none = re.sub(TAB, r"\1", made(LASER).program)
    assert f"A.outer (cut 1) has no tab: {WHY}" in str(judged(LASER, none))


def test_a_missing_tab_at_the_end() -> None:
    program = made(PLASMA).program
    (tab,) = made(PLASMA).plan.cuts[0].cut.tabs
    cut = made(PLASMA).plan.cuts[0].cut
    assert cut.lead_in is not None
    x, y = cut.lead_in.end
    closed = program.replace("M5 $0\n", f"G1 X{x:.4f} Y{y:.4f}\nM5 $0\n", 1).replace("N130 G1 X", "G1 X", 1)
    closed = re.sub(r"(?m)^N\d+ (G1 X[\d.]+ Y[\d.]+)$", r"\1", closed)
    result = judged(PLASMA, re.sub(r"N\d+ (G1 X[\d.]+ Y[\d.]+\nM5)", r"\1", closed))
    assert result.broken() == ("hold-small-parts",)
    assert "A.outer (cut 1) has no tab" in str(result)
    assert tab.width_mm == 0.8


@pytest.mark.parametrize(("by_mm", "is_mm"), [(-0.3, 0.5), (0.3, 1.1)])
def test_a_tab_too_narrow_or_too_wide(by_mm: float, is_mm: float) -> None:
    program = made(LASER).program
    off = re.search(TAB, program)
    assert off is not None
    (x,) = re.findall(r"X([\d.]+)", off[1])  # where it is lit again
    start = re.findall(r"X([\d.]+)", program[: off.start()])[-1]
    onwards = 1 if float(x) > float(start) else -1
    wrong = program[: off.start()] + off[0].replace(f"X{x}", f"X{float(x) + onwards * by_mm:g}") + program[off.end() :]
    result = judged(LASER, wrong)
    assert result.broken() == ("hold-small-parts",)
    assert f"that is {is_mm:.2f} mm wide, not 0.8 mm" in str(result)


def test_a_tab_in_a_corner() -> None:
    program = re.sub(TAB, r"\1", made(LASER).program, count=1)
    row = re.compile(r"(?m)^N\d+ (G1 X([\d.]+) Y([\d.]+)).*$")
    corner = [found for found in row.finditer(program) if program[found.end() :].split()[1] == "G2"][1]
    x, y = float(corner[2]), float(corner[3])
    *_, before = re.findall(r"X([\d.]+) Y([\d.]+)", program[: corner.start()])
    away = np.array([float(before[0]) - x, float(before[1]) - y])
    (a, b), (c, d) = ((np.array([x, y]) + away / np.hypot(*away) * mm).round(4).tolist() for mm in (1.4, 0.4))
    feed = re.findall(r"F[\d.]+", program)[0]
    turn = f"G1 X{a:g} Y{b:g} {feed}\nM5\nG1 X{c:g} Y{d:g}\nM3 S1\n{corner[1]}"
    result = judged(LASER, program[: corner.start()] + turn + program[corner.end() :])
    assert result.broken() == ("hold-small-parts",)
    assert "that lies in a corner, or less than 3 mm from one" in str(result)


@pytest.mark.parametrize("name", [LASER, PLASMA])
def test_tabs_that_no_rule_asks_for_are_uncut(name: str) -> None:
    result = judged(name, made(name).program, strength="off")
    assert not result.ok
    assert {"every-contour-once", "contour-geometry"} & set(result.broken())
    found = kerfwise.check(PLATE, made(name).plan, profile(name, "off"))
    assert "every-contour-once" in found.broken()


@pytest.mark.parametrize("width_mm", [2.0, 1000.0])  # the contour is 260 mm long
def test_a_plan_that_says_another_width(width_mm: float) -> None:
    plan = made(LASER).plan
    cut = plan.cuts[0].cut
    wide = replace(cut, tabs=(cut.tabs[0], replace(cut.tabs[1], width_mm=width_mm)))
    changed = replace(plan, cuts=(replace(plan.cuts[0], cut=wide),))
    result = kerfwise.check(PLATE, changed, profile(LASER))
    assert "hold-small-parts" in result.broken()
    assert f"that is {width_mm:.2f} mm wide, not 0.8 mm" in str(result)


APART = nest(230, 120, part("A", rect(40, 30, 60, 50)), part("B", rect(101.5, 30, 60, 50)))
"""Two parts with tabs, exactly a kerf of the plasma apart: each is cut all round."""


@cache
def beside() -> Result:
    plant = profile(PLASMA)
    return kerfwise.solve(APART, plant, work=1)


def test_parts_with_tabs_a_kerf_apart_are_each_cut_all_round() -> None:
    assert all(cut.cut.tabs for cut in beside().plan.cuts)
    assert beside().verdict.ok, str(beside().verdict)


def test_a_stretch_of_the_line_between_them_that_is_burnt_again_is_found() -> None:
    program = beside().program
    again = "G0 X100.75 Y70\nM3 $0 S1\nG1 X100.75 Y40 F2500\nM5 $0\n"
    damaged = re.sub(r"(?m)^N\d+ ", "", program).replace("(HOME)\n", f"{again}(HOME)\n", 1)
    result = checked(APART, damaged, profile(PLASMA))
    assert "burnt-twice" in result.broken(), str(result)
    assert re.search(r"30\.\d mm of [AB]\.outer are burnt again", str(result))
