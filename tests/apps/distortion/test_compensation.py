"""Nests that are compensated: what is changed, what stays, what is refused; and that parts come out truer."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kerfwise.apps.distortion.change import COMPENSATED, Change, change_of
from kerfwise.apps.distortion.compensation import CLOSE_MM, Kind, compensated, fitted, left_mm
from kerfwise.apps.distortion.cutting import Cutting, Moved, cut_sheet
from kerfwise.apps.distortion.part_errors import PartError, errors_of
from kerfwise.apps.edit.edited_nest import EditedNest
from kerfwise.apps.nesting.placement.demand import Spacing
from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Bridge, Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import nest_json, read_json
from kerfwise.tests.commands.run_cli import kerfwise

from .sheets import HEAT, around, part, rectangle, sheet_of

HALF_PER_MILLE = np.array([[-0.5, 0, 0, 0, 0], [0, -0.5, 0, 0, 0]])
"""Too small by half a mm per m."""
BENT = np.array([[-0.5, 0.1, 0.3, 0, 0], [0.1, -0.2, 1.0, 0.4, 0]])


def plates(gap: float = 40.0) -> Nest:
    """A plate of 400 × 300 with a round hole and a tab, a strip beside it, and a scrap line."""
    plate = part("plate", rectangle(100, 100, 500, 400))
    hole = replace(part("x", rectangle(0, 0, 1, 1)).outer, id="plate.hole1", part="plate", kind="hole")
    hole = replace(hole, curve=Curve.of([(250, 250, 1), (350, 250, 1)]))
    plate = replace(plate, holes=(hole,), tabs=(Tab((500.0, 250.0), 4.0),), attributes={"priority": 2})
    nest = sheet_of(rectangle(0, 0, 800, 500), plate, part("strip", rectangle(500 + gap, 100, 600 + gap, 400)))
    line = replace(hole, id="scrap1", part="", kind="scrap", curve=Curve.of([(0, 50), (800, 50)], closed=False))
    return replace(nest, scrap=(line,))


def off_by(nest: Nest, by: Floats) -> tuple[PartError, ...]:
    """Errors of all parts, each shifted and turned and off by a field: points all along the contours."""
    contours = [c for c in nest.contours if c.shapes_part]
    xy = [np.array([c.line.interpolate(s, normalized=True).coords[0] for s in np.arange(0, 1, 0.02)]) for c in contours]
    off, number = [], []
    for contour, points in zip(contours, xy, strict=True):
        own = nest.part_of[contour.part]
        x0, y0, x1, y1 = own.outer.polygon.bounds
        field = Change(((x0 + x1) / 2, (y0 + y1) / 2), by).at(points)
        off.append(field + 0.002 * np.column_stack([-points[:, 1], points[:, 0]]) + (3.0, -1.0))
        number.append(np.full(len(points), nest.index[contour.id]))
    every = np.concatenate(off)
    moved = Moved(
        np.concatenate(number), np.concatenate(xy), every, np.arange(len(every)), np.ones(len(every)), 0 * every
    )
    return errors_of(nest, moved)


@pytest.mark.parametrize(("kind", "by"), [("size", HALF_PER_MILLE), ("shape", BENT)])
def test_a_field_is_found_wherever_the_part_lies(kind: Kind, by: Floats) -> None:
    nest = plates()
    for own, error in zip(nest.parts, off_by(nest, by), strict=True):
        assert fitted(own, error, kind).by == pytest.approx(by, abs=1e-9)


def test_the_field_of_a_disc_does_not_take_a_shift_for_a_bend() -> None:
    """All points of a disc without holes are as far from its middle: x² + y² and a shift are alike there."""
    disc = part("disc", rectangle(0, 0, 1, 1))
    disc = replace(disc, outer=replace(disc.outer, curve=Curve.of([(200, 200, 1), (300, 200, 1)])))
    nest = sheet_of(rectangle(0, 0, 800, 500), disc)
    (error,) = off_by(nest, HALF_PER_MILLE)
    scatter = 0.02 * np.random.default_rng(1).standard_normal(error.off.shape)
    error = replace(error, off=error.off + scatter, xy=error.xy + 0.1 * scatter)
    assert np.abs(fitted(disc, error, "shape").by[:, 2:]).max() < 20.0  # mm per m², 0.05 mm at the edge
    (made,) = compensated(nest, (error,), "shape", 2.0).nest.parts
    assert made.outer.polygon.bounds == pytest.approx((200, 150, 300, 250), abs=0.1)


def test_size_alone_leaves_what_is_bent() -> None:
    nest = plates()
    errors = off_by(nest, BENT)
    assert left_mm(nest, errors, "shape") < 1e-9 < 0.03 < left_mm(nest, errors, "size")


def test_a_nest_compensated_in_size_has_parts_as_much_larger_about_their_middles() -> None:
    nest = plates()
    made = compensated(nest, off_by(nest, HALF_PER_MILLE), "size", 2.0).nest
    plate = made.parts[0]
    assert plate.outer.polygon.bounds == pytest.approx((99.9, 99.925, 500.1, 400.075))
    assert len(plate.outer.curve.vertices) == 4
    assert plate.holes[0].curve.start == pytest.approx((249.975, 250.0))
    assert plate.holes[0].curve.length_mm == pytest.approx(1.0005 * 100 * np.pi)
    assert plate.holes[0].curve.vertices[:, 2].tolist() == pytest.approx([1.0, 1.0])
    assert plate.tabs[0].at == pytest.approx((500.1, 250.0))
    assert plate.tabs[0].width_mm == 4.0
    assert made.sheet is nest.sheet
    again = read_json(nest_json(made).encode(), ReadOptions())
    assert [c.id for c in again.contours] == [c.id for c in nest.contours]
    assert again.parts[0].attributes["priority"] == 2
    change = change_of(again.parts[0])
    assert change is not None
    assert change.by == pytest.approx(-HALF_PER_MILLE, abs=1e-5)


def test_errors_of_a_compensated_nest_are_told_against_the_drawing() -> None:
    """What is drawn larger and comes out smaller by as much is true; what comes out as it is drawn is not."""
    nest = plates()
    made = compensated(nest, off_by(nest, HALF_PER_MILLE), "size", 2.0).nest
    assert max(e.max_mm or 0 for e in off_by(made, HALF_PER_MILLE)) < 1e-3
    plate, _ = off_by(made, 0 * HALF_PER_MILLE)
    assert plate.max_mm == pytest.approx(0.125, rel=0.02)  # half a mm per m at the corners, 250 mm from the middle


def test_what_is_left_is_compensated_the_next_time() -> None:
    nest = plates()
    once = compensated(nest, off_by(nest, HALF_PER_MILLE), "size", 2.0).nest
    twice = compensated(once, off_by(once, 1.5 * HALF_PER_MILLE), "size", 2.0).nest
    assert twice.parts[0].outer.polygon.bounds == pytest.approx((99.85, 99.8875, 500.15, 400.1125), abs=1e-3)


def test_edges_are_bent_as_near_to_the_field_as_said() -> None:
    nest = plates()
    made = compensated(nest, off_by(nest, BENT), "shape", 2.0).nest
    change = change_of(made.parts[0])
    assert change is not None
    for before, after in zip(nest.parts[0], made.parts[0], strict=True):
        length_mm = before.curve.length_mm
        points = np.array([before.curve.point_at(share * length_mm) for share in np.arange(0, 1, 0.01)])
        for point in points + change.at(points):
            assert after.curve.project(point)[1] < 1.2 * CLOSE_MM
    assert len(made.parts[0].outer.curve.vertices) < 40


def test_what_cannot_be_compensated_is_refused() -> None:
    nest = plates()
    with pytest.raises(InputError, match=r"plate would be drawn otherwise by 5\.00 mm, more .* \(1\.25 mm\)"):
        compensated(nest, off_by(nest, 40 * HALF_PER_MILLE), "size", 2.0)
    near = plates(gap=2.05)
    with pytest.raises(InputError, match="no room") as refused:
        compensated(near, off_by(near, HALF_PER_MILLE), "size", 2.0)
    assert refused.value.details == ("plate and strip would lie 1.925 mm apart: the kerf is 2 mm wide",)
    edge = sheet_of(rectangle(0, 0, 400, 300), part("all", rectangle(0, 0, 400, 300)))
    with pytest.raises(InputError, match="no room") as refused:
        compensated(edge, off_by(edge, HALF_PER_MILLE), "size", 2.0)
    assert refused.value.details == ("all would reach over the edge of the sheet",)
    bridged = replace(nest, bridges=(Bridge(("plate", "strip"), (500, 200), (540, 200), 20.0, 1),))
    with pytest.raises(InputError, match="bridges"):
        compensated(bridged, off_by(nest, HALF_PER_MILLE), "size", 2.0)


@pytest.mark.parametrize("said", [1.0005, {"along_x": [1, 2]}, {"along_x": [1, 0, 0, 0, "a"], "along_y": [0] * 5}])
def test_a_compensation_that_nobody_wrote_is_refused(said: object) -> None:
    odd = replace(plates().parts[0], attributes={COMPENSATED: said})
    with pytest.raises(InputError, match="plate: compensated: expected along_x and along_y with 5 numbers each"):
        change_of(odd)


def test_a_compensated_nest_is_not_edited() -> None:
    nest = plates()
    made = compensated(nest, off_by(nest, HALF_PER_MILLE), "size", 2.0).nest
    with pytest.raises(InputError, match="edit the one that it was made from"):
        EditedNest(made, Spacing(5.0, 5.0)).do("move plate 1 0")


@pytest.mark.full
def test_parts_of_a_compensated_nest_come_out_truer() -> None:
    """By another mesh than it was compensated by; with twice the heat that was assumed, by less."""
    nest = sheet_of(
        rectangle(0, 0, 600, 300),
        part("strip", rectangle(20, 15, 560, 75)),
        part("plate", rectangle(40, 110, 300, 280), rectangle(100, 160, 180, 220)),
    )
    order = ("strip.outer", "plate.hole1", "plate.outer")

    def errors(of: Nest, grid_mm: float, watts: float = 2000.0) -> tuple[PartError, ...]:
        heat = replace(HEAT, absorbed_power_w=watts)
        return errors_of(of, cut_sheet(of, around(of, *order), heat, Cutting(grid_mm, 2.0, 10.0)))

    def mean(of: Nest, watts: float = 2000.0) -> float:
        return float(np.mean([e.max_mm or 0.0 for e in errors(of, 13.0, watts)]))

    drawn = errors(nest, 15.0)
    size, shape = (compensated(nest, drawn, kind, 2.0).nest for kind in ("size", "shape"))
    assert mean(shape) < 0.6 * mean(nest)
    assert mean(shape) < mean(size) < 0.9 * mean(nest)
    assert mean(shape, 4000.0) < 0.9 * mean(nest, 4000.0)


@pytest.mark.slow
def test_the_command_writes_the_nest_and_says_what_it_did(tmp_path: Path) -> None:
    nest, plan, out = tmp_path / "n.json", tmp_path / "p.json", tmp_path / "c.json"
    parts = [{"id": "A", "outer": [[30, 30], [370, 30], [370, 130], [30, 130]]}]
    sheet = {"width": 400, "height": 300}
    nest.write_text(json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}))
    flame = ("-p", "oxyfuel-thick-plate")
    assert kerfwise("solve", nest, *flame, "--work", 0.2, "-o", tmp_path / "o.nc", "--plan", plan).code == 0
    done = kerfwise("distort", nest, plan, *flame, "--grid", "20 mm", "--compensated", out)
    assert done.code == 0, done.err
    assert "too small by 0." in done.out
    assert "1 of 1 parts drawn 1.000" in done.err
    assert "3300 W" in done.err
    (written,) = json.loads(out.read_text())["parts"]
    assert written["outer"][0][0] < 30.0
    assert kerfwise("check", out, tmp_path / "o.nc", *flame).code != 0  # planned anew it has a program of its own
    assert kerfwise("solve", out, *flame, "--work", 0.2, "-o", tmp_path / "c.nc", "--plan", plan).code == 0
    told = kerfwise("distort", out, plan, *flame, "--grid", "20 mm").out
    assert "against    the drawing before compensation" in told
    assert float(told.splitlines()[2].split()[1]) <= float(done.out.splitlines()[2].split()[1])
    for argv, said in (
        ((nest, plan, "--compensated", tmp_path / "c.dxf"), "give a name ending in .json"),
        ((tmp_path / "o.nc", "--compensated", tmp_path / "d.json"), "--compensated needs NEST"),
        ((nest, plan, "--compensate", "shape"), "--compensate is for --compensated"),
    ):
        refused = kerfwise("distort", *argv)
        assert (refused.code, said in refused.err) == (2, True), refused.err
