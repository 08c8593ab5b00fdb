"""Parts that touch, cut apart by one cut: what is burnt of them, by LinuxCNC's interpreter and plain areas."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, with_parts
from kerfwise.encoder.touching_edges import with_touching_edges_cut
from kerfwise.encoder.validate import validated
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check.gouging import Accepted, wrong_edge_losses
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Common, Cuts
from kerfwise.tests.metal.common_nests import block, grid
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import examples

ACCEPTED = Accepted(0.051, 20.0)
_OFF_MM, _THIN_MM, _FILLET_MM, _CHORD_MM = 0.06, 0.005, 8.0, 0.0005


def profile(kerf_mm: float) -> Profile:
    laser = load_profile("laser-st10kp-2mm")
    material = replace(laser.material, kerf_mm=kerf_mm)
    machine = replace(laser.machine, dialect="linuxcnc")
    return replace(laser, material=material, machine=machine, cuts=Cuts(common=Common(20.0, accept_loss=True)))


def made(sheet: Nest, kerf_mm: float) -> VerifiedPlan | None:
    """The plan and its program; None where the rules leave no order."""
    asked = profile(kerf_mm)
    try:
        return solve_and_verify(make_request(facts_of(sheet, asked), asked), asked, options_for(sheet, asked, work=0.2))
    except RulesConflict:
        return None


def expect_half_a_kerf(sheet: Nest, found: VerifiedPlan, kerf_mm: float) -> None:
    """Each drawn part comes off in one piece, and loses nothing but strips half a kerf wide along shared edges."""
    assert found.verdict.ok
    assert simulate(profile(kerf_mm).as_cut(sheet), found.program, **plant(profile(kerf_mm))) == []
    burns = [shapely.LineString(burn.points) for burn in canon.run(found.program).cuts]
    burnt = shapely.buffer(shapely.union_all(burns), kerf_mm / 2)
    outlines = [p.outer.line for p in sheet.parts]
    for k, drawn in enumerate(sheet.parts):
        others = shapely.buffer(shapely.union_all([line for j, line in enumerate(outlines) if j != k]), 0.01)
        edges = [shapely.LineString([s.start, s.end]) for s in drawn.outer.curve.segments if not s.is_arc]
        shared = [edge for edge in edges if edge.intersection(others).length > 0.1]
        lines = [shapely.affinity.scale(edge, *[1 + 2 * _FILLET_MM / edge.length] * 2) for edge in shared]
        strips = shapely.buffer(shapely.union_all(lines), kerf_mm / 2 + _OFF_MM)
        holes = shapely.union_all([hole.curve.polygon(_CHORD_MM) for hole in drawn.holes])
        exact = shapely.difference(drawn.outer.curve.polygon(_CHORD_MM), holes)
        lost = shapely.intersection(exact, burnt)
        assert shapely.buffer(shapely.difference(lost, strips), -_THIN_MM).is_empty
        assert not shared or lost.area > 0.4 * kerf_mm * max(edge.length for edge in shared) - 1
        assert shapely.covered_by(drawn.outer.line, shapely.buffer(burnt, _OFF_MM)), "no stretch is left uncut"


@pytest.mark.linuxcnc
def test_a_grid_of_touching_parts_is_cut_along_its_lines() -> None:
    sheet, kerf_mm = grid(3, 2, 0.0), 0.5
    found = made(sheet, kerf_mm)
    assert found is not None
    expect_half_a_kerf(sheet, found, kerf_mm)
    totals = found.plan.totals
    lines_mm = 3 * (3 * 100 + kerf_mm) + 4 * (2 * 60 + kerf_mm)
    assert totals.pierces == 1
    assert totals.cut_mm == pytest.approx(lines_mm, abs=8)  # a lead, and corners that are cut round
    assert [(loss.contour, loss.loss_mm) for loss in found.plan.losses] == [(f"P{k}.outer", 0.25) for k in range(1, 7)]
    assert "(PARTS TOUCH AND ARE CUT APART BY ONE CUT, 6 LOSE 0.25 MM THERE)" in found.program
    assert any("6 parts that touch others lose half a kerf" in text for text in found.verdict.warnings)
    strict = replace(profile(kerf_mm), cuts=Cuts(common=Common(20.0)))
    assert {"shared-metal", "no-gouging"} <= set(check_program(sheet, found.program, strict).broken())
    with pytest.raises(RulesConflict, match=r"P1\.outer and P2\.outer touch"):
        make_request(facts_of(sheet, strict), strict)


@pytest.mark.linuxcnc
@pytest.mark.parametrize(("seed", "kerf_mm"), [(1, 0.2), (4, 0.5), (10, 1.5), (15, 1.5)])
def test_blocks_of_touching_parts(seed: int, kerf_mm: float) -> None:
    sheet = block(np.random.default_rng(seed), 4, 0.0, holes=True)
    found = made(sheet, kerf_mm)
    assert found is not None
    expect_half_a_kerf(sheet, found, kerf_mm)


@pytest.mark.slow
@pytest.mark.linuxcnc
@examples(25, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), kerf_mm=st.sampled_from((0.2, 0.5, 1.5)), parts=st.integers(2, 6))
def test_any_block_of_touching_parts(seed: int, kerf_mm: float, parts: int) -> None:
    sheet = block(np.random.default_rng(seed), parts, 0.0, holes=True)
    found = made(sheet, kerf_mm)
    if found is not None:
        expect_half_a_kerf(sheet, found, kerf_mm)


def rounded(x: float, y: float, wide: float, high: float, r: float, ccw: bool = True) -> list[list[float]]:
    b = np.tan(np.pi / 8)
    rows = [
        (x + r, y), (x + wide - r, y, b), (x + wide, y + r), (x + wide, y + high - r, b), (x + wide - r, y + high),
        (x + r, y + high, b), (x, y + high - r), (x, y + r, b),
    ]  # fmt: skip
    return (Curve.of(rows) if ccw else Curve.of(rows).reversed()).as_rows()


@pytest.mark.linuxcnc
@pytest.mark.parametrize("r", [1.0, 8.0])
def test_edges_between_fillets(r: float) -> None:
    sheet = nest(260, 140, part("A", rounded(30, 30, 80, 70, r)), part("B", rounded(110, 30, 80, 70, r, ccw=False)))
    found = made(sheet, 1.5)
    assert found is not None
    expect_half_a_kerf(sheet, found, 1.5)


def two(hole: list[tuple[float, float]] | None = None) -> Nest:
    left = part("A", rect(20, 20, 60, 60), [] if hole is None else [hole])
    return nest(200, 120, left, part("B", rect(80, 20, 60, 60)))


def test_nothing_changes_where_edges_are_shorter_than_asked_or_do_not_touch() -> None:
    assert with_touching_edges_cut(two(), 1.5, 61.0, 0.05) is not two()
    sheet = two()
    assert with_touching_edges_cut(sheet, 1.5, 61.0, 0.05) is sheet
    apart = nest(200, 120, part("A", rect(20, 20, 60, 60)), part("B", rect(80.1, 20, 60, 60)))
    assert with_touching_edges_cut(apart, 1.5, 20.0, 0.05) is apart


def test_an_edge_that_has_no_room_is_refused() -> None:
    with pytest.raises(InputError, match="cannot lose half a kerf") as hole:
        with_touching_edges_cut(two(circle(70, 50, 9.5)), 1.5, 20.0, 0.05)
    assert hole.value.details == ("A.outer: A.hole1 is nearer to the edge than that",)
    tongue = [(20, 20), (80, 20), (80, 50), (79.5, 50), (79.5, 51), (80, 51), (80, 80), (20, 80)]
    sheet = nest(200, 120, part("A", tongue), part("B", rect(80, 20, 60, 60)))
    assert with_touching_edges_cut(sheet, 0.5, 20.0, 0.05).contour("A.outer").polygon.bounds[2] == pytest.approx(79.75)
    sliver = nest(200, 120, part("A", rect(79.4, 20, 0.6, 60)), part("B", rect(80, 20, 60, 60)))
    with pytest.raises(InputError, match="cannot lose half a kerf") as thin:
        with_touching_edges_cut(sliver, 1.5, 20.0, 0.05)
    assert "what lies beside its edge at (80.0, 80.0) is too small" in thin.value.details[0]


@pytest.mark.parametrize(("wide", "does"), [(57.0, "loses"), (60.5, "gains"), (59.6, "keeps")])
def test_the_check_measures_what_is_lost(wide: float, does: str) -> None:
    """A part that is judged with another loss than half a kerf along the edge that touches."""
    sheet = with_touching_edges_cut(two(), 1.5, 20.0, 0.05)
    assert list(wrong_edge_losses(sheet, 1.5, ACCEPTED)) == []
    wrong = replace(sheet.parts[0], outer=part("A", rect(20, 20, wide, 60)).outer)
    told = [found.text for found in wrong_edge_losses(replace(sheet, parts=(wrong, sheet.parts[1])), 1.5, ACCEPTED)]
    assert any(text.startswith(f"A.outer {does}") for text in told)
    other = replace(sheet.parts[0], outer=part("A", rect(20, 21, 59.25, 59)).outer)
    (found,) = wrong_edge_losses(replace(sheet, parts=(other, sheet.parts[1])), 1.5, ACCEPTED)
    assert "where no edge touches" in found.text


def test_a_name_may_hold_braces() -> None:
    drawn = nest(200, 120, part("{A}", rect(20, 20, 60, 60)), part("B", rect(80, 20, 60, 60)))
    sheet = with_touching_edges_cut(drawn, 1.5, 20.0, 0.05)
    wrong = replace(sheet.parts[0], outer=part("{A}", rect(20, 20, 60.5, 60)).outer)
    told = [found.text for found in wrong_edge_losses(replace(sheet, parts=(wrong, sheet.parts[1])), 1.5, ACCEPTED)]
    assert any(text.startswith("{A}.outer gains 30.00 mm² at (80.2, 50.0)") for text in told)


def test_the_check_asks_whether_a_loss_is_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    """By itself: that the planner's part has taken it for accepted is not enough."""
    sheet = with_touching_edges_cut(two(), 1.5, 20.0, 0.05)
    assert all(
        "touch along 60.00 mm at the most" in v.text for v in wrong_edge_losses(sheet, 1.5, Accepted(0.051, 61.0))
    )
    assert all("accepts no loss" in v.text for v in wrong_edge_losses(sheet, 1.5, Accepted(0.051, math.inf)))
    asked = profile(1.5)
    found = made(two(), 1.5)
    assert found is not None
    assert check_program(two(), found.program, asked).ok
    monkeypatch.setattr(Profile, "without_losses", lambda self, nest: with_touching_edges_cut(nest, 1.5, 20.0, 0.05))
    for common in (Common(61.0, accept_loss=True), Common(20.0)):
        other = replace(asked, cuts=Cuts(common=common))
        assert "edge-loss" in check_program(two(), found.program, other).broken()


def test_a_short_edge_goes_with_a_long_one() -> None:
    """Of parts that hang together one has to touch along as much as is asked."""
    three = nest(300, 120, *two().parts, part("C", rect(140, 70, 60, 30)))
    sheet = with_touching_edges_cut(three, 1.5, 20.0, 0.05)
    assert [loss.contour for loss in sheet.losses] == ["A.outer", "B.outer", "C.outer"]
    assert list(wrong_edge_losses(sheet, 1.5, Accepted(0.051, 20.0))) == []


@pytest.mark.parametrize("rise_mm", [0.25, 0.9])
def test_nothing_is_asked_of_an_edge_that_only_meets_another_at_a_small_angle(rise_mm: float) -> None:
    """C's edge parts from A's by 0.2° or 0.9°, so that these two do not lose anything."""
    wedge = part("C", [(20, 80), (80, 80 + rise_mm), (80, 110), (20, 110)])
    sheet = with_touching_edges_cut(nest(300, 120, *two().parts, wedge), 1.5, 20.0, 0.05)
    assert [loss.contour for loss in sheet.losses] == ["A.outer", "B.outer"]
    assert list(wrong_edge_losses(sheet, 1.5, ACCEPTED)) == []


def test_a_mark_in_what_is_lost_is_told() -> None:
    sheet = two()
    engraved = replace(
        sheet.parts[0], marks=(Contour("A.mark1", "A", "mark", Curve.of([(79.5, 30), (79.5, 50)], closed=False)),)
    )
    marked = replace(sheet, parts=(engraved, sheet.parts[1]))
    found = made(marked, 1.5)
    assert found is not None
    assert any("made and then cut away" in text and "A.mark1" in text for text in found.verdict.warnings)


def test_the_drawings_doubt_is_answered_where_the_loss_is_accepted() -> None:
    noted = replace(validated(two()), drawn=None)
    assert any("no room for the kerf" in note.text for note in noted.notes)
    assert with_touching_edges_cut(noted, 1.5, 20.0, 0.05).notes == ()
    assert with_touching_edges_cut(noted, 1.5, 61.0, 0.05).notes == noted.notes


def test_an_outline_that_is_judged_otherwise_without_a_word_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The check measures outlines, and does not ask what was noted of them."""
    sheet, asked = two(), profile(1.5)
    found = made(sheet, 1.5)
    assert found is not None
    wrong = replace(sheet.parts[0], outer=part("A", rect(20, 20, 57, 60)).outer)
    untold = with_parts(sheet, (wrong, sheet.parts[1]))
    with monkeypatch.context() as patched:
        patched.setattr(Profile, "without_losses", lambda self, nest: untold)
        assert "edge-loss" in check_program(sheet, found.program, asked).broken()
