"""Common cuts together with tabs, links, a pierce pass and slower corners: both judges, and LinuxCNC's interpreter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kerfwise.encoder.by_hand import part, rect
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.produce import Produced, produce
from kerfwise.jobs.solve_options import options_for
from kerfwise.postproc.verdict.checking import check_program
from kerfwise.rules.profile.profile import Profile, load_profile
from kerfwise.tests.metal.common_nests import block
from kerfwise.tests.metal.plant import plant, tabs_of
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools import canon

KERFS_MM = {"laser-st10kp-2mm": 0.2, "plasma-carbon-steel": 1.5}
TABS = "rules: {hold-small-parts: {strength: hard, tabs: tipping, width: 0.5 mm, corner: 1 mm, slat_pitch: 30 mm}}\n"
COMMON = "common: {shortest: 20 mm, good_side: any}"


def beside(seed: int, kerf_mm: float) -> Nest:
    """A block of parts a kerf apart, and four small parts beside it."""
    made = block(np.random.default_rng(seed), 5, kerf_mm, holes=True)
    _, _, x, y = made.sheet.bounds
    more = tuple(part(f"S{k}", rect(x + 10 + 70 * (k % 2), 40 + 62 * (k // 2), 50, 44)) for k in range(4))
    return Nest(Sheet.rectangle(x + 160, max(y, 190)), made.parts + more)


def made(folder: Path, based_on: str, machine: str, cuts: str, more: str, seed: int) -> tuple[Nest, Profile, Produced]:
    text = f"based_on: {based_on}\nmachine: {{dialect: linuxcnc{machine}}}\ncuts: {{{COMMON}{cuts}}}\n{more}"
    (folder / "plant.yaml").write_text(text, encoding="utf-8")
    sheet, profile = beside(seed, KERFS_MM[based_on]), load_profile(folder / "plant.yaml")
    found = produce(ask(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.3))
    assert found.verdict.ok, found.verdict.broken()
    assert check_program(sheet, found.program, profile).ok
    assert simulate(sheet, found.program, **plant(profile), tabs=tabs_of(found.plan)) == []
    ran = canon.run(found.program)
    assert sum(burn.length_mm for burn in ran.cuts) == pytest.approx(found.plan.totals.cut_mm, abs=0.1)
    assert any(planned.cut.span is not None for planned in found.plan.cuts)
    return sheet, profile, found


@pytest.mark.linuxcnc
@pytest.mark.parametrize("process", ["laser-st10kp-2mm", "plasma-carbon-steel"])
def test_with_tabs(tmp_path: Path, process: str) -> None:
    """Parts that tabs hold stand beside the block, and are cut all round."""
    _, _, found = made(tmp_path, process, "", "", TABS, 1)
    held = {planned.part for planned in found.plan.cuts if planned.cut.tabs}
    assert held
    assert not held & {planned.part for planned in found.plan.cuts if planned.cut.span is not None}


@pytest.mark.linuxcnc
def test_a_group_with_a_part_that_tabs_hold_is_cut_all_round(tmp_path: Path) -> None:
    """All of its parts: a part of it that others cut once would take the tab with it."""
    (tmp_path / "plant.yaml").write_text(
        f"based_on: laser-st10kp-2mm\nmachine: {{dialect: linuxcnc}}\ncuts: {{{COMMON}}}\n{TABS}", encoding="utf-8"
    )
    profile = load_profile(tmp_path / "plant.yaml")
    group = [part("A", rect(40, 40, 90, 60)), part("B", rect(130.2, 40, 20, 60)), part("C", rect(150.4, 40, 90, 60))]
    sheet = Nest(Sheet.rectangle(320, 160), tuple(group))
    found = produce(ask(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.3))
    assert found.verdict.ok
    assert [planned.part for planned in found.plan.cuts if planned.cut.tabs] == ["B"]
    assert all(planned.cut.span is None for planned in found.plan.cuts)
    assert simulate(sheet, found.program, **plant(profile), tabs=tabs_of(found.plan)) == []


@pytest.mark.linuxcnc
@pytest.mark.parametrize("kerf_start", ["", ", kerf_start: false"])
def test_with_a_pierce_pass(tmp_path: Path, kerf_start: str) -> None:
    """What begins in an old kerf has no hole; without a kerf start it waits there as at a pierce."""
    machine = f", pierce_dwell: program{kerf_start}"
    sheet, profile, found = made(tmp_path, "plasma-carbon-steel", machine, ", pierce_pass: sheet", "", 2)
    holes = {pierce.contour for pierce in found.plan.pierces}
    assert holes == {planned.cut.contour for planned in found.plan.cuts if planned.cut.span is None}
    waits = found.program.count("G4 P0.5")
    assert waits == len(holes) + (0 if not kerf_start else len(found.plan.cuts) - len(holes))
    first = next(k for k, line in enumerate(found.program.split("\n")) if line.startswith("(PIERCE 2 "))
    lines = found.program.split("\n")
    lost = check_program(sheet, "\n".join(lines[:first] + lines[first + 5 :]), profile)
    assert "pierce-pass" in lost.broken()


@pytest.mark.linuxcnc
def test_with_links(tmp_path: Path) -> None:
    """A link leads to the part of a block that is cut first, all round, or from it."""
    _, _, found = made(tmp_path, "plasma-carbon-steel", ", pierce_time: 2 s", ", links: {longest: 90 mm}", "", 1)
    assert any(planned.cut.linked for planned in found.plan.cuts)
    assert not any(planned.cut.linked and planned.cut.span is not None for planned in found.plan.cuts)


@pytest.mark.linuxcnc
def test_with_slower_corners(tmp_path: Path) -> None:
    """The clock of the plan counts the corners of each stretch, and no others."""
    corners = "corners: {corner_feed: 0.5, corner_reach: 5 mm}\n"
    sheet, profile, found = made(tmp_path, "plasma-carbon-steel", "", "", corners, 1)
    facts = facts_of(sheet, profile)
    law = profile.corner_feed()
    assert law is not None
    spans = [c for c in facts.candidates if c.span is not None]
    assert {c.corner_mm for c in facts.candidates if c.span is None} == {None}
    for candidate in spans:
        contour = facts.nest.contours[candidate.contour]
        assert 0.0 <= candidate.at_corners_mm(contour) <= contour.corner_mm + 2 * 2 * law.reach_mm
    assert min(c.at_corners_mm(facts.nest.contours[c.contour]) for c in spans) == 0.0
    slow = found.program.replace("F1250", "F2500")
    assert "feeds" in check_program(sheet, slow, profile).broken()
