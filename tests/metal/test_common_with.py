"""Common cuts together with tabs, links, a pierce pass and slower corners: both judges, and LinuxCNC's interpreter."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.cut import Cut, Tab
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check.plan_runs import burnt_before
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
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


def made(
    folder: Path, based_on: str, machine: str, cuts: str, more: str, seed: int
) -> tuple[Nest, Profile, VerifiedPlan]:
    text = f"based_on: {based_on}\nmachine: {{dialect: linuxcnc{machine}}}\ncuts: {{{COMMON}{cuts}}}\n{more}"
    (folder / "plant.yaml").write_text(text, encoding="utf-8")
    sheet, profile = beside(seed, KERFS_MM[based_on]), load_profile(folder / "plant.yaml")
    found = solve_and_verify(
        make_request(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.3)
    )
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
    found = solve_and_verify(
        make_request(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.3)
    )
    assert found.verdict.ok
    assert [planned.part for planned in found.plan.cuts if planned.cut.tabs] == ["B"]
    assert all(planned.cut.span is None for planned in found.plan.cuts)
    assert simulate(sheet, found.program, **plant(profile), tabs=tabs_of(found.plan)) == []


CHANNEL = [(40, 40), (160, 40), (160, 120), (130, 120), (130, 70), (70, 70), (70, 120), (40, 120)]
PLATE_AND_CHANNEL = [part("U", CHANNEL), part("B", rect(40, 120.2, 120, 60))]
PLATE_AND_STRIP = [part("A", rect(40, 40, 90, 60)), part("B", rect(130.2, 40, 20, 60))]
CUT_ALL_ROUND = {
    "a channel and a plate": (PLATE_AND_CHANNEL, COMMON, ""),
    "a part with tabs": (PLATE_AND_STRIP, COMMON, TABS),
    "a part with tabs, nothing common": (PLATE_AND_STRIP, "", TABS),
}


@pytest.mark.parametrize("name", CUT_ALL_ROUND)
@pytest.mark.parametrize("backwards", [False, True])
def test_what_is_left_of_parts_cut_all_round_after_a_stop(tmp_path: Path, name: str, backwards: bool) -> None:
    """One of two parts a kerf apart is out. The other is cut all round, as it would have been."""
    parts, common, more = CUT_ALL_ROUND[name]
    (tmp_path / "plant.yaml").write_text(
        f"based_on: laser-st10kp-2mm\nmachine: {{dialect: linuxcnc}}\ncuts: {{{common}}}\n{more}", encoding="utf-8"
    )
    profile, sheet = load_profile(tmp_path / "plant.yaml"), Nest(Sheet.rectangle(320, 220), tuple(parts))
    options = options_for(sheet, profile, work=0.1)
    first = replace(profile, locks=(Lock(contour=parts[-1 if backwards else 0].outer.id, position="first"),))
    whole = solve_and_verify(make_request(facts_of(sheet, first), first), first, options)
    cuts = [planned.cut for planned in whole.plan.cuts]
    assert whole.verdict.ok
    assert all(cut.span is None for cut in cuts)
    rest = solve_and_verify(
        make_request(facts_of(sheet, profile, AlreadyCut(tuple(cuts[:1]))), profile), profile, options
    )
    assert [planned.cut.span for planned in rest.plan.cuts] == [None]
    assert rest.verdict.ok, rest.verdict.broken()
    assert check_program(sheet, rest.program, profile).ok
    assert simulate(sheet, rest.program, before=whole.program, **plant(profile), tabs=tabs_of(rest.plan)) == []
    if more and backwards:
        elsewhere = re.sub(r"\(OUT 1 TAB \S+ \S+ ", "(OUT 1 TAB 130.2 70 ", rest.program, count=1)
        assert check_program(sheet, elsewhere, profile).broken() == ("tabs",), "the other part's cut takes that tab"


def test_tabs_of_cuts_before_a_stop_are_not_burnt() -> None:
    sheet, tab = Nest(Sheet.rectangle(200, 100), (part("A", rect(20, 20, 90, 60)),)), Tab((60, 20), 0.5)
    cut = Cut("A.outer", (20, 20), "ccw", (15, 15), tabs=(tab,))
    before = burnt_before(sheet, [cut], 0.2)
    (whole,) = burnt_before(sheet, [replace(cut, tabs=())], 0.2).rounds
    assert whole.length - sum(line.length for line in before.lines) == pytest.approx(0.5 + 0.2)
    assert min(line.distance(shapely.Point(60, 19.9)) for line in before.lines) == pytest.approx(0.35)


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
