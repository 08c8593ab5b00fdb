"""How a skeleton is cut up is seen from kerfs alone: pieces no larger than asked for, and the remnant saved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from kerfwise import Nest
from kerfwise.encoder.bridges import with_bridges
from kerfwise.encoder.nest import Bridge
from kerfwise.encoder.scrap import with_scrap
from kerfwise.encoder.small_holes import Under
from kerfwise.postproc.check.loose_metal import broken_bridges, cuts_in_loose_skeleton, wrong_pieces
from kerfwise.postproc.check.plan_runs import runs_from_cuts
from kerfwise.postproc.check.small_features import judged_nest
from kerfwise.postproc.check.torch_run import SENTENCES
from kerfwise.rule_kit import FactOptions, Part, Point, Side, in_order, nest, part, rect
from kerfwise.rules.catalogue.scrap_last.skeleton import skeleton_of
from kerfwise.rules.judging.holding import bounding, loose_scrap_cuts
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Cuts, Scrap, SmallHoles
from kerfwise.tests.commands.run_cli import kerfwise

A = part("A", rect(50, 50, 300, 300))
ACROSS = [(500.0, 0.0), (500.0, 400.0)]


def wrong(sheet: Nest, grid_mm: float | None = None, remnant: Side | None = None, order: str = "") -> list[str]:
    profile = replace(load_profile(), cuts=Cuts(scrap=Scrap(grid_mm, remnant)))
    cuts = in_order(sheet, order or " ".join(c.id for c in sheet.contours))
    runs = runs_from_cuts(sheet, cuts, profile.material.kerf_mm)[0]
    return [v.text for v in wrong_pieces(sheet, runs, (), profile)]


def test_pieces_as_large_as_the_grid_pass() -> None:
    assert wrong(nest(1000, 400, A, scrap=[ACROSS]), 500.0) == []


def test_larger_ones_are_named_with_size_and_place() -> None:
    first, second = wrong(nest(1000, 400, A, scrap=[ACROSS]), 450.0)
    assert {first.split(" is left")[0], second.split(" is left")[0]} == {"a piece of the skeleton of 499 × 400 mm"}
    assert first.endswith("more than 450 mm (cuts.scrap.grid)")


def test_a_line_that_is_not_cut_leaves_one() -> None:
    sheet = nest(1000, 400, A, scrap=[ACROSS])
    (text,) = wrong(sheet, 500.0, order="A.outer")
    assert text.startswith("a piece of the skeleton of 1000 × 400 mm is left")


def test_a_line_that_ends_too_soon_leaves_one() -> None:
    (text,) = wrong(nest(1000, 400, A, scrap=[[(500, 0), (500, 390)]]), 500.0)
    assert text.startswith("a piece of the skeleton of 1000 × 400 mm is left")


def test_what_parts_alone_cut_off_is_not_looked_at() -> None:
    """A part from edge to edge divides the skeleton: the smaller side has no lines, and nobody says that it has."""
    wall = part("W", rect(750, 0, 20, 400))
    assert wrong(nest(1200, 400, A, wall, scrap=[[(400, 0), (400, 400)]]), 410.0) == []
    said = SENTENCES["scrap-pieces"]
    assert said.startswith("The skeleton's largest piece is cut into pieces no larger than asked for")


def test_the_remnant_may_be_larger_than_the_grid() -> None:
    sheet = nest(1000, 400, A, scrap=[[(399, 0), (399, 400)]])
    assert wrong(sheet, 400.0, "right") == []
    assert len(wrong(sheet, 400.0)) == 1


def test_a_remnant_that_is_no_rectangle_is_not_saved() -> None:
    slanted = nest(1000, 400, A, scrap=[[(399, 0), (460, 400)]])
    assert wrong(slanted, remnant="right") == [
        "no rectangle with sides of 50 mm or more is saved along the right side (cuts.scrap.remnant)"
    ]
    assert wrong(nest(1000, 400, A, scrap=[[(399, 0), (399, 400)]]), remnant="left") != []


def test_nothing_is_asked_where_the_profile_asks_for_nothing() -> None:
    assert wrong(nest(1000, 400, A)) == []


@pytest.mark.slow
def test_the_planner_s_own_pass(tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    files = [str(root / "docs" / "scrap.nest.json"), "-p", str(root / "examples" / "profiles" / "scrap-grid.yaml")]
    ran = kerfwise("solve", *files, "--work", "0.3", "-o", str(tmp_path / "out.nc"))
    assert ran.code == 0
    assert any(line.split()[:3] == ["holds", "hard", "scrap-pieces"] for line in ran.out.splitlines())


KERF_MM = 1.0
OF_SKELETON = part("OF_SKELETON", rect(90, 6, 8, 8))
ROW = nest(440, 20, OF_SKELETON, scrap=[[(x, 0), (x, 20)] for x in (50, 160, 260, 360)])
"""The piece from 50 to 160 is the largest, but only a little, for OF_SKELETON lies in it."""


def loose(sheet: Nest, order: str, lead: list[tuple[float, float]] | None = None) -> list[str]:
    """What the check finds, the first cut with a lead."""
    runs = list(runs_from_cuts(sheet, in_order(sheet, order), KERF_MM)[0])
    if lead:
        runs[0] = replace(runs[0], lead_in=shapely.LineString(lead))
    return [v.contours[0] for v in cuts_in_loose_skeleton(sheet, runs, (), KERF_MM)]


@pytest.mark.parametrize("lead", [None, [(60, 17), (120, 17), (120, 3), (60, 3)]])
def test_a_lead_in_the_frame_does_not_make_another_piece_the_frame(lead: list[tuple[float, float]] | None) -> None:
    assert loose(ROW, "OF_SKELETON.outer scrap4 scrap3 scrap2 scrap1", lead) == []
    assert loose(ROW, "OF_SKELETON.outer scrap2 scrap3 scrap4 scrap1", lead) == ["scrap3", "scrap4"]


def webbed(web_mm: float) -> Nest:
    """Two plates with so much metal between their kerfs, and a grid over the sheet."""
    left = part("OF_SKELETON", [(5, 5), (105, 5), (105, 25), (45, 25), (45, 95), (105, 95), (105, 115), (5, 115)])
    right = part("B", rect(107 + web_mm, 5, 40, 110))
    return with_scrap(nest(250, 120, left, right), KERF_MM, 50.0, None)


def test_no_line_is_made_in_a_web_that_the_kerf_would_burn_away() -> None:
    def across(web_mm: float) -> list[float]:
        lines = shapely.bounds([line.line for line in webbed(web_mm).scrap])
        return sorted(lines[(lines[:, 0] > 104) & (lines[:, 2] < 109), 2] - lines[0, 0])

    assert len(across(1.5)) > 0
    assert across(0.3) == []


@pytest.mark.parametrize("web_mm", [0.3, 1.5])
def test_what_only_narrow_webs_hold_is_not_the_frame(web_mm: float) -> None:
    """Between the arms of OF_SKELETON lies more than in any piece of the grid."""
    sheet = webbed(web_mm)
    framed, pairs = bounding(sheet, KERF_MM)
    facts, ids = skeleton_of(sheet, FactOptions(kerf_mm=KERF_MM)), [c.id for c in sheet.contours]
    assert {ids[k] for k in np.flatnonzero(facts["scrap_framed"].values)} == framed != set()
    assert {(ids[a], ids[b]) for a, b in facts["scrap_beside"].values.tolist()} == pairs
    done = sorted(framed)[:1]
    while ready := sorted({a for a, b in pairs if b in done} - {*done}):
        done.append(ready[0])
    done += sorted({line.id for line in sheet.scrap} - {*done})
    order = " ".join(["OF_SKELETON.outer B.outer", *done[::-1]])
    assert list(loose_scrap_cuts(sheet, in_order(sheet, order), KERF_MM)) == []
    assert loose(sheet, order) == []


def test_a_line_in_a_narrow_web_may_be_cut_at_any_time() -> None:
    plates = (part("OF_SKELETON", rect(10, 20, 50, 60)), part("B", rect(62.3, 20, 40, 60)))
    web, upright = [(61, 50), (61.3, 50)], [(150.0, 0.0), (150.0, 100.0)]
    sheet = nest(300, 100, *plates, scrap=[web, upright])
    assert bounding(sheet, KERF_MM)[0] == {"scrap1", "scrap2"}
    framed = skeleton_of(sheet, FactOptions(kerf_mm=KERF_MM))["scrap_framed"]
    assert framed.values.tolist() == [False, False, True, True]
    for order in ("scrap1 scrap2", "scrap2 scrap1"):
        assert loose(sheet, f"OF_SKELETON.outer B.outer {order}") == []
        assert list(loose_scrap_cuts(sheet, in_order(sheet, f"OF_SKELETON.outer B.outer {order}"), KERF_MM)) == []


OF_BRIDGES = part("OF_BRIDGES", rect(20, 20, 60, 60), holes=[rect(30, 30, 20, 20), rect(60, 60, 4, 4)])
B = part("B", rect(82, 20, 60, 60))
STRIPS = (
    Bridge(("OF_BRIDGES", "B"), (75, 40), (90, 40), 4.0, 1),
    Bridge(("OF_BRIDGES", "B"), (75, 47), (90, 47), 4.0, 2),
)


def joined(count: int = 1) -> Nest:
    return with_bridges(replace(nest(400, 200, OF_BRIDGES, B), bridges=STRIPS[:count]))


def told(sheet: Nest) -> list[str]:
    return [v.text for v in broken_bridges(sheet, [], 1.5)]


def with_part(sheet: Nest, change: Callable[[Part], Part]) -> Nest:
    return replace(sheet, parts=(change(sheet.parts[0]), *sheet.parts[1:]))


@pytest.mark.parametrize("count", [1, 2])
def test_what_is_as_drawn_passes(count: int) -> None:
    assert told(joined(count)) == []


WRONG_HOLES: dict[str, tuple[Callable[[Part], Part], str]] = {
    "lost": (lambda p: replace(p, holes=p.holes[1:]), "(40.0, 40.0)"),
    "moved": (
        lambda p: replace(p, holes=(replace(p.holes[0], curve=p.holes[0].curve.moved(3, 0)), *p.holes[1:])),
        "(51.5, 40.0)",
    ),
    "one more": (
        lambda p: replace(p, holes=(*p.holes, replace(p.holes[1], curve=p.holes[1].curve.moved(-38, 0)))),
        "(24.0, 62.0)",
    ),
    "pocket lost": (lambda p: replace(p, holes=p.holes[:-1]), "(81.0, 43.5)"),
}


@pytest.mark.parametrize("case", WRONG_HOLES)
def test_a_hole_that_the_joined_part_does_not_have_is_told(case: str) -> None:
    change, at = WRONG_HOLES[case]
    assert told(with_part(joined(2), change)) == [
        f"the holes in OF_BRIDGES+B.outer are not those that its parts and bridges leave at {at}"
    ]


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_a_wrong_rectangle_of_strips_cannot_hide(monkeypatch: pytest.MonkeyPatch, share: float) -> None:
    """Where what reads and joins takes strips for narrower or wider than they are, the check does not follow."""
    side = Bridge.side

    def wrong(self: Bridge, left: bool, beyond_mm: float = 0.0) -> tuple[Point, Point]:
        return side(replace(self, width_mm=share * self.width_mm), left, beyond_mm)

    monkeypatch.setattr(Bridge, "side", wrong)
    (text,) = told(joined())
    assert text.startswith("OF_BRIDGES+B.outer is not the outline of its parts and bridges at (")


@pytest.mark.parametrize("third", [part("C", rect(83, y, 10, h)) for y, h in ((20, 60), (39, 2), (41.9, 20))])
def test_a_bridge_over_a_third_part_cannot_hide(monkeypatch: pytest.MonkeyPatch, third: Part) -> None:
    """Where the reading lets a strip lie on a part that it does not join, that part's kerf enters it."""
    monkeypatch.setattr("kerfwise.encoder.bridges._expect_clear", lambda *_: None)
    strip = Bridge(("OF_BRIDGES", "B"), (75, 40), (100, 40), 4.0, 1)
    apart = nest(400, 200, OF_BRIDGES, part("B", rect(96, 20, 60, 60)), third)
    sheet = with_bridges(replace(apart, bridges=(strip,)))
    runs = runs_from_cuts(sheet, in_order(sheet, " ".join(c.id for c in sheet.contours)), 1.5)[0]
    (text,) = [v.text for v in broken_bridges(sheet, runs, 1.5)]
    assert "the kerf of C.outer enters bridge 1" in text


@pytest.mark.parametrize("under", ["spot", "skip"])
def test_small_holes_and_pockets_that_a_profile_does_not_cut_are_as_drawn(under: Under) -> None:
    profile = load_profile()
    profile = replace(profile, small_holes=SmallHoles(min_hole=5.0, under=under))
    judged = judged_nest(joined(2), profile).nest
    assert [c.id for c in judged.contours if c.kind == "hole"] == ["OF_BRIDGES.hole1"]
    assert told(judged) == []
