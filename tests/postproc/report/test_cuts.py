"""Directions, travel, pierces and zones are drawn as the plan says."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from kerfwise.encoder.cut import Cut, Direction
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.small_holes import HoleLimits, Under, with_small_holes
from kerfwise.postproc.report import scene as colours
from kerfwise.postproc.report.layers import direction_layer, pierce_layer, travel_layer, zone_map
from kerfwise.postproc.report.picture import Spot, make_scene
from kerfwise.postproc.report.scene import Dot, Shape, TextLine, View
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.postproc.report.plausible import plate, plausible_plan


def view_of(made: Nest) -> View:
    return View.of(made.sheet.bounds, len(made.contours), made.sheet.polygon.area)


def pointing(contour: str, direction: Direction, entry: tuple[float, float]) -> tuple[float, float]:
    """Where the first arrow head on a contour points, y up."""
    made = plate()
    cut = Cut(contour, entry, direction, entry)
    (heads,) = direction_layer(made, view_of(made), [cut]).items
    assert isinstance(heads, Shape)
    tip, _, notch, _ = heads.lines[0]
    dx, dy = tip - notch
    return float(dx / math.hypot(dx, dy)), float(-dy / math.hypot(dx, dy))


@pytest.mark.parametrize(
    ("contour", "direction", "entry", "points"),
    [
        ("B.outer", "ccw", (300, 20), (1, 0)),
        ("B.outer", "cw", (300, 20), (0, 1)),
        ("B.outer", "cw", (350, 270), (1, 0)),
        ("A.mark1", "ccw", (30, 30), (1, 0)),
        ("A.mark1", "cw", (90, 30), (-1, 0)),
    ],
)
def test_arrows_point_the_way_the_torch_goes(
    contour: str, direction: Direction, entry: tuple[float, float], points: tuple[float, float]
) -> None:
    assert pointing(contour, direction, entry) == pytest.approx(points, abs=1e-6)


def test_travel_leads_from_home_from_end_to_pierce_and_home_again() -> None:
    made = plate()
    cuts = [Cut("B.outer", (300, 20), "cw", (295, 15)), Cut("A.outer", (20, 20), "cw", (15, 15))]
    view = view_of(made)
    items = travel_layer(view, cuts, (0.0, 0.0), [0.0, 0.5, 1.0]).items
    lines = [item for item in items if isinstance(item, Shape) and item.style.dash]
    stops = [(0, 0), (295, 15), (300, 20), (15, 15), (20, 20), (0, 0)]
    assert np.concatenate([line.lines[0] for line in lines]) == pytest.approx(view.xy(stops))
    assert [line.style.stroke for line in lines] == [colours.time_colour(s) for s in (0.0, 0.5, 1.0)]


def test_pierces_are_where_the_plan_says() -> None:
    made = plate()
    view = view_of(made)
    cuts = [Cut("B.outer", (300, 20), "cw", (295, 15)), Cut("A.mark1", (30, 30), "ccw", (30, 30))]
    plain, mark = pierce_layer(made, view, cuts).items
    assert isinstance(plain, Dot)
    assert isinstance(mark, Dot)
    assert (plain.x, plain.y) == pytest.approx(view.point((295, 15)))
    assert (plain.style.fill, mark.style.fill) == (colours.PIERCE, colours.MARK)


def test_zones_that_touch_have_different_tints() -> None:
    parts = [part(f"P{k}", rect(100 * (k % 5), 100 * (k // 5), 90, 90)) for k in range(25)]
    made = nest(500, 500, *parts)
    zones = zone_map(made, {f"P{k}": 1 + (8 * k) % 25 for k in range(25)})
    for k in range(25):
        for other in ([k + 1] if k % 5 < 4 else []) + ([k + 5] if k < 20 else []):
            assert zones.colour(f"P{k}") != zones.colour(f"P{other}")


def test_a_number_stands_by_the_entry_but_not_on_the_way_in() -> None:
    made = plate()
    plan = plausible_plan(made)
    scene = make_scene(made, plan)
    numbers = {t.text: t for t in scene.layer("numbers") if isinstance(t, TextLine)}
    for k, planned in enumerate(plan.cuts, 1):
        if planned.kind != "mark":
            number = numbers[str(k)]
            away = math.dist((number.x, number.y), view_of(made).point(planned.cut.entry))
            assert 0.9 * number.size < away < 2.5 * number.size


def test_the_header_tells_the_totals_and_how_good_the_plan_is() -> None:
    made = dataclasses.replace(plate(), file="folder/plate.json")
    plan = plausible_plan(made)
    texts = [t.text for t in make_scene(made, plan).layer("header") if isinstance(t, TextLine)]
    assert texts[0] == "plate.json"
    assert texts[2] == "profile plasma-carbon-steel"
    cut_m, idle_m = plan.totals.cut_mm / 1000, plan.totals.idle_mm / 1000
    assert f"600 × 300 mm · 2 parts · 4 contours · cut {cut_m:.1f} m · idle {idle_m:.1f} m · 3 pierces" in texts[1]
    assert texts[1].endswith(" · gap 10.0 %")
    heavy = dataclasses.replace(plan.solve, objective=1_010_000.0, bound=1_009_000.0, gap=0.00099, excuses=1)
    weighed = dataclasses.replace(plan, solve=heavy)
    said = [t.text for t in make_scene(made, weighed).layer("header") if isinstance(t, TextLine)]
    assert "fewer excuses impossible · gap 10.0 % besides" in " ".join(said)
    unproven = dataclasses.replace(plan, solve=dataclasses.replace(plan.solve, bound=None, gap=None))
    assert any(
        "no bound proven" in t.text for t in make_scene(made, unproven).layer("header") if isinstance(t, TextLine)
    )


def test_colours_count_cuts_where_the_plan_has_no_times() -> None:
    plan = plausible_plan(plate())
    timeless = [dataclasses.replace(p, cut=dataclasses.replace(p.cut, start_s=0.0, end_s=0.0)) for p in plan.cuts]
    scene = make_scene(plate(), dataclasses.replace(plan, cuts=tuple(timeless)))
    assert "4 cuts" in [t.text for t in scene.layer("footer") if isinstance(t, TextLine)]


def test_the_home_is_in_the_picture_even_outside_the_sheet() -> None:
    scene = make_scene(plate(), plausible_plan(plate()), home=(-100.0, 400.0))
    ring = scene.layer("home")[0]
    assert isinstance(ring, Dot)
    assert 0 < ring.x < scene.width
    assert 0 < ring.y < scene.height


def test_a_spot_shows_its_contours_large_and_in_red() -> None:
    made = nest(6000, 1500, *(part(f"P{k}", rect(10 + 110 * k, 10, 100, 100)) for k in range(50)))
    whole, spot = make_scene(made), make_scene(made, spot=Spot(frozenset({"P20.outer", "P21.outer"}), "a clash"))
    red = [s for s in spot.layer("contours") if isinstance(s, Shape) and s.style.stroke == colours.ALERT]
    small = [s for s in whole.layer("contours") if isinstance(s, Shape)]
    assert len(red) == 2
    assert np.ptp(red[0].lines[0][:, 0]) > 4 * np.ptp(small[20].lines[0][:, 0])
    assert [t.text for t in spot.layer("numbers") if isinstance(t, TextLine)] == ["P20.outer", "P21.outer"]
    assert any(t.text == "a clash" for t in spot.layer("header") if isinstance(t, TextLine))


@pytest.mark.parametrize("under", ["spot", "skip"])
def test_a_small_hole_that_is_not_cut_is_dashed(under: Under) -> None:
    drawn = nest(300, 200, part("A", rect(20, 20, 150, 150), [circle(60, 60, 2), circle(110, 110, 9)]))
    made = with_small_holes(drawn, HoleLimits(least_mm=6, under=under))
    layers = {layer.name: layer.items for layer in make_scene(made, plausible_plan(made)).layers}
    dashed = [item for item in layers["contours"] if isinstance(item, Shape) and item.style.dash]
    assert [item.lines[0].shape[0] > 4 for item in dashed] == [True]
    assert any(isinstance(item, TextLine) and item.text == "small hole, not cut" for item in layers["footer"])
    plain = {layer.name: layer.items for layer in make_scene(drawn, plausible_plan(drawn)).layers}
    assert not [item for item in plain["contours"] if isinstance(item, Shape) and item.style.dash]
