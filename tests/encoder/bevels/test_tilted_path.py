"""The ways of tilted torches, known by hand: a V of 45 degrees on 20 mm, and turns at corners of every kind."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
import shapely

from kerfwise import InputError, Nest, load_profile, read_nest, read_plan
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.bevels.cut_nest import BevelOptions, with_bevels
from kerfwise.encoder.bevels.room import plan_bevels, section
from kerfwise.jobs.heat_path import path_of_made
from kerfwise.jobs.inputs import Inputs, silent
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.rule_kit import Contour, Curve, Cut, Part, Sheet
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_bevels import NEST, PROFILE, solved  # noqa: F401 - a fixture

OPTIONS = BevelOptions(20.0, ((0.0, 2.0), (45.0, 2.4)), corner="turn")
HALF = 2.4 / math.cos(math.radians(45)) / 2


def plate(bevel: str, options: BevelOptions = OPTIONS, sheet: tuple[float, float] = (500, 400)) -> Nest:
    """A rectangle of 200 × 120 mm with a bevel, as it is cut."""
    outer = Curve.of([(100, 100), (300, 100), (300, 220), (100, 220)])
    contour = Contour("P.outer", "P", "outer", outer, bevel=Bevel.parse(bevel))
    return with_bevels(Nest(Sheet.rectangle(*sheet), (Part("P", contour),)), options)


def round_of(nest: Nest, options: BevelOptions = OPTIONS, bevel_of: int = 0):  # type: ignore[no-untyped-def]
    """The passes of a cut that begins in the middle of the lower edge, counter-clockwise."""
    lead_in = Curve.of([(200, 100 - HALF - 8), (200, 100 - HALF)], closed=False)
    cut = Cut("P.outer", (200, 100), "ccw", (200, 100 - HALF - 8), lead_in)
    drawn = (nest.drawn or nest).contours[bevel_of]
    return plan_bevels(nest, options).passes_of(drawn, cut)


def test_a_v_of_45_degrees_on_20_mm_by_hand() -> None:
    (path,) = round_of(plate("V 45"))
    # the jet is 2.4 / cos 45° wide, half of it outside the contour at the bottom; 20 mm higher it is 20 mm further in
    inside = 20.0 - HALF
    assert path.tilt_deg == 45
    assert path.half_mm == pytest.approx(1.69706, abs=1e-5)
    assert inside == pytest.approx(18.30294, abs=1e-5)
    assert path.start == pytest.approx((200, 100 - HALF - 8 + 20))
    along = [step for step in path.steps if step.along]
    edges = [step.segment.length_mm for step in along if not step.segment.is_arc]
    assert edges == pytest.approx([100, 120, 200, 120, 100])
    corners = [step.segment for step in along if step.segment.is_arc]
    assert [c.radius_mm for c in corners] == pytest.approx([inside] * 4)
    assert path.length_mm == pytest.approx(8 + 2 * (200 + 120) + 2 * math.pi * inside)
    assert along[-1].end_deg - along[0].begin_deg == pytest.approx(360)
    assert [step.begin_deg % 360 for step in along if not step.segment.is_arc] == pytest.approx([270, 0, 90, 180, 270])
    assert path.feed_share == pytest.approx(20 / math.hypot(20, 20))
    (below,) = path.lines(20.0, along=True)
    assert below.bounds == pytest.approx((100 - HALF, 100 - HALF, 300 + HALF, 220 + HALF))


def test_a_loop_at_a_corner_by_hand() -> None:
    options = BevelOptions(20.0, OPTIONS.kerfs, corner="loop", run_mm=5.0)
    (path,) = round_of(plate("V 45", options), options)
    # where both edges meet at the top lies 18.303 mm before the drawn corner; the torch goes 5 mm past that corner
    radius = 5 + 20 - HALF
    loops = [step.segment for step in path.steps if not step.along and step.segment.is_arc]
    assert len(loops) == 8
    assert [one.radius_mm for one in loops] == pytest.approx([radius] * 8)
    assert sum(one.length_mm for one in loops) == pytest.approx(4 * radius * 1.5 * math.pi)
    assert path.length_mm == pytest.approx(8 + 640 + 4 * (2 * 5 + radius * 1.5 * math.pi))


def test_a_v_open_to_the_bottom_turns_about_the_drawn_corner() -> None:
    (path,) = round_of(plate("V 45 bottom"))
    corners = [step.segment.radius_mm for step in path.steps if step.along and step.segment.is_arc]
    assert path.tilt_deg == -45
    assert corners == pytest.approx([HALF] * 4)
    (below,) = path.lines(20.0, along=True)
    assert below.bounds == pytest.approx((100, 100, 300, 220))


@pytest.mark.parametrize(
    ("written", "tilts", "roots"),
    [
        ("V 30", [30], [20]),
        ("V 30 bottom", [-30], [0]),
        ("Y 30 land 4", [30, 0], [16, 0]),
        ("Y 30 land 4 bottom", [-30, 0], [4, 0]),
        ("X 30", [30, -30], [10, 10]),
        ("K 30 land 6", [30, -30, 0], [7, 13, 0]),
    ],
)
def test_each_kind_has_its_passes(written: str, tilts: list[float], roots: list[float]) -> None:
    bevel = Bevel.parse(written)
    passes = bevel.passes(20.0)
    assert [one.tilt_deg for one in passes] == tilts
    assert [one.root_mm for one in passes] == roots
    assert Bevel.of_json(bevel.as_json()) == bevel == Bevel.parse(str(bevel))


def test_a_part_is_smaller_where_its_edge_slopes() -> None:
    nest = plate("K 45 land 4").drawn
    assert nest is not None
    areas = [section(nest.parts[0], z, 20.0).area for z in (0.0, 8.0, 12.0, 20.0)]
    assert areas == pytest.approx([(200 - 16) * (120 - 16), 200 * 120, 200 * 120, (200 - 16) * (120 - 16)])


@pytest.mark.parametrize(
    ("written", "why"),
    [
        ("W 45", "'W 45' is no bevel: expected a kind, an angle"),
        ("V", "its angle is no number"),
        ("V 75", "a bevel's angle is 75: expected 1 to 60 degrees"),
        ("V 45 land 3", "a bevel V has no land: leave it out, or the kind is Y"),
        ("Y 45", "a bevel Y has a land"),
        ("X 45 top", "a bevel X opens to both faces: leave out side: top"),
        ("X 45 land 2", "the kind is K"),
        ("V 45 left", "'left' is not understood"),
        ("Y 45 land", "its land is no number"),
    ],
)
def test_what_is_no_bevel_is_refused(written: str, why: str) -> None:
    with pytest.raises(InputError) as refused:
        Bevel.parse(written)
    assert why in str(refused.value)


@pytest.mark.parametrize(
    ("written", "options", "sheet", "why"),
    [
        ("Y 30 land 25", {}, (500, 400), "its land, 25 mm, is no less than the sheet's thickness, 20 mm"),
        ("X 45", {}, (500, 400), "the first of its 2 passes sets loose what the others cut: P weighs 3.77 kg"),
        ("X 45", {"lies_still_kg": 5.0}, (500, 400), "less than 5 kg"),
        ("X 60", {"lies_still_kg": 1.0}, (500, 225), "would burn beyond the sheet"),
        ("V 45", {"corner": "loop"}, (310, 400), "no loop has room at the corner (300.0, 100.0)"),
    ],
)
def test_what_has_no_room_is_refused(
    written: str, options: dict[str, object], sheet: tuple[float, float], why: str
) -> None:
    given = BevelOptions(20.0, OPTIONS.kerfs, **({"corner": "turn"} | options))  # type: ignore[arg-type]
    with pytest.raises(InputError) as refused:
        plan_bevels(plate(written, given, sheet), given)
    assert why in str(refused.value)
    assert "P.outer" in str(refused.value)


def test_a_bevel_that_leaves_no_wall_is_refused() -> None:
    nest = plate("V 45").drawn
    assert nest is not None
    part = nest.parts[0]
    hole = Contour("P.hole1", "P", "hole", Curve.of([(115, 150, 1), (125, 150, 1)]))
    given = Nest(nest.sheet, (Part("P", part.outer, (hole,)),))
    with pytest.raises(InputError) as refused:
        plan_bevels(with_bevels(given, OPTIONS), OPTIONS)
    assert "at the top face it leaves less than a kerf of wall between P.outer and P.hole1" in str(refused.value)


def test_eia_turns_on_the_spot_in_turns_a_minute() -> None:
    program = (
        "G21\nG90\nG40\nM28\nG00 X10 Y10 A30\nG00 C0\nM07\nG01 X20 Y10 F600\nG01 C90 F2.5\nG01 X20 Y20 F600\nM08\nM02\n"
    )
    read = read_nc(program, control=replace(CONTROLS["eia"], rotary="AC"))
    (burn,) = read.burns
    assert burn.axes == ((30, 0), (30, 0), (30, 90), (30, 90))
    assert burn.end_s - burn.start_s == pytest.approx(1 + 6 + 1)  # a quarter of a turn at 2.5 a minute takes 6 s


def test_simulations_burn_each_pass_where_its_jet_is_and_as_long_as_it_takes(solved: Path) -> None:  # noqa: F811 - a fixture
    profile = load_profile(PROFILE)
    nest, plan = read_nest(NEST), read_plan(solved / "out.plan.json")
    path = path_of_made(plan, Inputs(nest, profile), silent, None)
    passes = {planned.cut.contour: planned.passes for planned in plan.cuts}
    upright = sum(1 for planned in plan.cuts if not planned.passes)
    assert len(path.burns) == upright + sum(map(len, passes.values())), "one burn a pass"
    assert path.seconds_on == pytest.approx(sum(c.cut.end_s - c.cut.start_s for c in plan.cuts), rel=0.1)
    flange = next(burn for burn in path.burns if burn.contour == "Flange.outer")
    (one,) = passes["Flange.outer"]
    (x0, y0), (x1, y1) = nest.contour("Flange.outer").curve.vertices[:2, :2].tolist()
    for point in flange.xy[5:-5:7].tolist():
        assert min(shapely.distance(line, shapely.Point(point)) for line in one.lines(10.0)) < 0.05
    # by hand: 20 mm, V 45: half of 3.394 mm outside the contour at the bottom face, 10 mm further in at half the depth
    middle = shapely.Point((x0 + x1) / 2, (y0 + y1) / 2)
    assert shapely.distance(middle, shapely.LineString(flange.xy)) == pytest.approx(10 - 1.697, abs=0.05)
    for verb in (("heat", "--model", "logical"), ("distort", "--grid", "40")):
        done = kerfwise(*verb, NEST, solved / "out.plan.json", "-p", PROFILE)
        assert done.code == 0, done.err
        assert "upright" not in done.err
