"""Programs with tabs: at the end each part is still held, and nothing is wrong with the metal."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest

import kerfwise
from kerfwise import Nest, Profile, Result
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.hand_made import KERF_MM, around, sheet, with_cut
from kerfwise.tests.metal.plant import plant, tabs_of
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.postproc.plans import with_tabs

ROWS = nest(
    420, 260,
    part("A", rect(20, 20, 50, 40)), part("B", rect(90, 20, 200, 100), [rect(150, 50, 40, 40)]),
    part("C", circle(50, 110, 30)), part("D", [(310, 20), (380, 20), (380, 60), (310, 100)]),
    part("H", rect(20, 150, 160, 90), [rect(40, 165, 120, 60)]), part("G", rect(60, 175, 50, 40)),
    part("L", [(200, 140), (260, 140), (260, 170), (230, 170), (230, 230), (200, 230)]),
)  # fmt: skip
TORCHES = ("laser-st10kp-2mm", "plasma-carbon-steel", "oxyfuel-thick-plate", "water-jet")


def made(drawn: Nest, profile: Profile) -> Result:
    return kerfwise.solve(drawn, profile, work=2)


def burnt(drawn: Nest, profile: Profile, program: str, planned: Result) -> list[Finding]:
    return simulate(drawn, program, tabs=tabs_of(planned.plan), **plant(profile))


@pytest.mark.parametrize("choose", ["tipping", "all"])
@pytest.mark.parametrize("torch", TORCHES)
def test_tabbed_parts_are_held_and_the_others_free(torch: str, choose: str) -> None:
    profile = with_tabs(torch, tabs=choose, width_mm=0.8)
    found = made(ROWS, profile)
    tabbed = {one.part for one in found.plan.cuts if one.cut.tabs}
    assert tabbed == ({"A", "C", "D", "G", "L"} if choose == "tipping" else {p.id for p in ROWS.parts})
    assert {len(one.cut.tabs) for one in found.plan.cuts if one.cut.tabs} == {2 if "laser" in torch else 1}
    assert found.verdict.ok
    assert burnt(ROWS, profile, found.program, found) == []


@pytest.mark.parametrize("out", ["line", "arc"])
def test_the_lead_out_behind_the_last_tab_leaves_its_ring_as_any_does(out: Literal["line", "arc"]) -> None:
    """The ring is lit in three stretches: the last one's lead-out leaves the kerf of the first at a low angle."""
    profile = with_tabs("laser-st10kp-2mm", tabs="all", width_mm=0.5)
    profile = replace(profile, leads=replace(profile.leads, lead="arc", lead_out=out))
    found = made(ROWS, profile)
    assert found.verdict.ok
    assert burnt(ROWS, profile, found.program, found) == []


def test_a_lead_out_that_comes_back_into_the_first_stretch_of_its_ring_is_found() -> None:
    ring = around(20, 20, 50, 50, (14, 45))
    first, second = [*ring[:5], "G1 X43 Y71", "M5 $0"], ["G1 X47 Y71", "M3 $0 S1", *ring[5:-1]]
    tabs = {"A.outer": [(45.0, 70.0, 2.0)]}

    def kinds(*out: str) -> dict[str, int]:
        text = with_cut("A.outer", [*first, *second, *out, "M5 $0"])
        return by_kind(simulate(sheet(), text, KERF_MM, tabs=tabs))

    assert kinds() == kinds("G1 X16 Y48") == {}
    assert kinds("G1 X16 Y48", "G1 X19 Y62") == {"lead-over-void": 1}


def test_a_tab_that_is_cut_is_found_loose() -> None:
    profile = with_tabs("laser-st10kp-2mm")
    found = made(ROWS, profile)
    lit = re.sub(r"N\d+ M5\n((?:N\d+ G[123] .*\n)+)N\d+ M3 S1\n", r"\1", found.program)
    assert by_kind(burnt(ROWS, profile, lit, found)) == {"part-not-held": 5}


def test_a_drawn_tab_is_where_it_is_drawn(tmp_path: Path) -> None:
    shapes = ([[20, 20], [70, 20], [70, 60], [20, 60]], [[90, 20], [290, 20], [290, 120], [90, 120]])
    parts = [{"id": name, "outer": outer} for name, outer in zip("AB", shapes, strict=True)]
    parts[0] |= {"tabs": [{"at": [50, 20]}]}
    sheet = {"width": 420, "height": 260}
    (tmp_path / "nest.json").write_text(json.dumps({"format": "kerfwise-nest/1", "sheet": sheet, "parts": parts}))
    drawn = kerfwise.read_nest(tmp_path / "nest.json")
    for torch in TORCHES[:2]:
        profile = with_tabs(torch, tabs="nest")
        found = made(drawn, profile)
        (one,) = [one for one in found.plan.cuts if one.cut.tabs]
        assert (one.cut.contour, one.cut.tabs[0].width_mm) == ("A.outer", 1.0)
        assert one.cut.tabs[0].at == pytest.approx((50, 20), abs=0.06)
        assert burnt(drawn, profile, found.program, found) == []
