"""Each kind of entity as a CAD system writes it, and what is made of it."""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from scipy.interpolate import BSpline

from kerfwise import InputError
from kerfwise.rule_kit import Contour
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_dxf, sheet, square, texts

SLOT = [(50, 50, 0, 0, 0), (100, 50, 0, 0, 1), (100, 80, 0, 0, 0), (50, 80, 0, 0, 1)]
SLOT_AREA = round(50 * 30 + math.pi * 225, 3)


def only(folder: Path, draw: Any, **options: Any) -> Contour:
    """The one contour of a drawing with a sheet around it."""

    def with_sheet(space: Any) -> None:
        sheet(space)
        draw(space)

    nest = read_dxf(folder, with_sheet, **options)
    [contour] = nest.contours
    return contour


def arcs(contour: Contour) -> int:
    return sum(s.is_arc for s in contour.curve.segments)


def test_a_circle_is_two_arcs(tmp_path: Path) -> None:
    contour = only(tmp_path, lambda space: space.add_circle((100, 100), 30))
    assert arcs(contour) == len(contour.curve.segments) == 2
    assert contour.curve.signed_area_mm2 == pytest.approx(math.pi * 900)


def test_a_polyline_with_bulges(tmp_path: Path) -> None:
    contour = only(tmp_path, lambda space: space.add_lwpolyline(SLOT, close=True))
    assert arcs(contour) == 2
    assert areas_of(contour) == SLOT_AREA


def areas_of(contour: Contour) -> float:
    return round(abs(contour.curve.signed_area_mm2), 3)


def test_an_open_polyline_that_ends_where_it_began(tmp_path: Path) -> None:
    assert areas_of(only(tmp_path, lambda s: s.add_lwpolyline([*SLOT, (50, 50, 0, 0, 0)], close=False))) == SLOT_AREA


def test_an_old_polyline_with_bulges(tmp_path: Path) -> None:
    points = [(x, y, b) for x, y, _, _, b in SLOT]
    assert areas_of(only(tmp_path, lambda s: s.add_polyline2d(points, format="xyb", close=True))) == SLOT_AREA


def test_a_3d_polyline_is_seen_from_above(tmp_path: Path) -> None:
    points = [(10, 10, 5), (50, 10, 7), (50, 50, -9)]
    assert areas_of(only(tmp_path, lambda s: s.add_polyline3d(points, close=True))) == 800


STAIRS = [(10, 10, 0), (50, 10, 30), (50, 50, 0)]
MARK = {"layer": "Mark"}
BEHIND, SEEN_BEHIND = [(-x, y) for x, y, _ in STAIRS], {"extrusion": (0, 0, -1)}


def rise(line: Any) -> None:
    """Lift the vertices of a 2D polyline, whose heights the format allows and nobody draws."""
    for vertex, (_, _, z) in zip(line.vertices, STAIRS, strict=True):
        vertex.dxf.location = vertex.dxf.location.replace(z=z)


def turned_up(space: Any) -> None:
    """A flat line in a block that is turned up by a right angle about x."""
    space.doc.blocks.new("flat").add_line((0, 0), (40, 30))
    space.add_blockref("flat", (10, 0, 50), dxfattribs=MARK | {"extrusion": (0, -1, 0)})


@pytest.mark.parametrize(
    ("draw", "kind", "lost_mm"),
    [
        (lambda space: space.add_line(*STAIRS[:2], MARK), "LINE", 10),
        (lambda space: space.add_polyline3d(STAIRS, dxfattribs=MARK), "POLYLINE", 20),
        (lambda space: space.add_open_spline(STAIRS, 2, dxfattribs=MARK), "SPLINE", 20),
        (lambda space: rise(space.add_polyline2d(STAIRS, format="xy", dxfattribs=MARK)), "POLYLINE", 20),
        (lambda space: rise(space.add_polyline2d(BEHIND, format="xy", dxfattribs=MARK | SEEN_BEHIND)), "POLYLINE", 20),
        (lambda space: space.add_spline(STAIRS, dxfattribs=MARK), "SPLINE", 20),
        (lambda space: space.add_helix(5, 20, 3, dxfattribs=MARK).translate(10, 10, 0), "HELIX", None),
        (turned_up, "LINE", 10),
    ],
)
def test_lines_whose_height_varies_are_told_with_their_place(
    tmp_path: Path, draw: Callable[[Any], object], kind: str, lost_mm: float | None
) -> None:
    def with_part(space: Any) -> None:
        lines(space, square(0, 0, 90))
        space.add_line((10, 80, 0), (80, 80, 1), MARK)  # 7 micrometres longer than it is seen
        draw(space)

    (told,) = [text for text in texts(read_dxf(tmp_path, with_part).notes) if "heights" in text]
    assert told.startswith("drawn at heights that vary, and read as seen from above: 1 on 'Mark'; most of all ")
    assert f"the {kind} at (1" in told
    assert lost_mm is None or told.endswith(f"{lost_mm:.3f} mm shorter than it is drawn")


@pytest.mark.parametrize("kind", ["2d", "3d"])
def test_the_control_points_of_a_smoothed_polyline_are_no_part_of_it(tmp_path: Path, kind: str) -> None:
    def draw(space: Any) -> None:
        corners = square(10, 10, 50)
        flat = kind == "2d"
        line = space.add_polyline2d(corners, close=True) if flat else space.add_polyline3d(corners, close=True)
        line.vertices[1].dxf.flags = 16 if flat else 16 + 32

    assert areas_of(only(tmp_path, draw)) == 1250


@pytest.mark.parametrize("angles", [(0, 360), (45, 45), (2.8, 362.8), (359.4, 719.4), (10.1, -349.9), (30, 30 + 1e-12)])
def test_an_arc_that_ends_where_it_begins_is_a_circle(tmp_path: Path, angles: tuple[float, float]) -> None:
    assert areas_of(only(tmp_path, lambda s: s.add_arc((50, 50), 20, *angles))) == round(400 * math.pi, 3)
    params = map(math.radians, angles)
    area = areas_of(only(tmp_path, lambda s: s.add_ellipse((50, 50), (20, 0), 0.5, *params)))
    assert area == pytest.approx(200 * math.pi, abs=0.5)


@pytest.mark.parametrize(("end", "told"), [(45, ["2 on '0'"]), (405, []), (-315, [])])
def test_an_arc_whose_angles_are_one_is_told(tmp_path: Path, end: float, told: list[str]) -> None:
    def draw(space: Any) -> None:
        space.add_arc((50, 50), 20, 45, end)
        space.add_ellipse((150, 50), (20, 0), 0.5, math.radians(45), math.radians(end))
        space.add_circle((50, 150), 20)

    notes = [note for note in texts(read_dxf(tmp_path, draw, open_lines="ignore").notes) if "angles" in note]
    assert [note.split(": ")[1].split(";")[0] for note in notes] == told


def test_lines_and_arcs_in_any_order(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_arc((100, 65), 15, 270, 90)
        space.add_line((50, 80), (100, 80))
        space.add_arc((50, 65), 15, 90, 270)
        space.add_line((100, 50), (50, 50))

    contour = only(tmp_path, draw)
    assert arcs(contour) == 2
    assert areas_of(contour) == SLOT_AREA


def test_heights_are_dropped(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        corners = [(10, 10, 1), (50, 10, 2), (50, 50, -3)]
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            space.add_line(a, (*b[:2], 99))

    assert areas_of(only(tmp_path, draw)) == 800


@pytest.mark.parametrize("kind", ["circle", "arcs", "lwpolyline", "polyline"])
def test_entities_on_a_plane_seen_from_behind_are_mirrored(tmp_path: Path, kind: str) -> None:
    behind = {"extrusion": (0, 0, -1)}

    def draw(space: Any) -> None:
        if kind == "circle":
            space.add_circle((-100, 100), 30, dxfattribs=behind)
        elif kind == "arcs":  # in the plane's own coordinates the half to the right: in the world the one to the left
            space.add_arc((-100, 100), 30, -90, 90, dxfattribs=behind)
            space.add_line((100, 70), (100, 130))
        elif kind == "lwpolyline":
            space.add_lwpolyline([(-100, 70, 0, 0, 1), (-100, 130, 0, 0, 0)], close=True, dxfattribs=behind)
        else:
            space.add_polyline2d([(-100, 70, 1), (-100, 130, 0)], format="xyb", close=True, dxfattribs=behind)

    contour = only(tmp_path, draw)
    left, bottom, right, top = contour.polygon.bounds
    assert (left, bottom, top) == pytest.approx((70, 70, 130), abs=0.02)
    assert right == pytest.approx(130 if kind == "circle" else 100, abs=0.02)


def test_a_circle_on_a_tilted_plane_is_an_ellipse(tmp_path: Path) -> None:
    tilted = {"extrusion": (math.sin(math.pi / 3), 0, math.cos(math.pi / 3))}
    contour = only(tmp_path, lambda s: s.add_circle((150, 100, 100), 30, dxfattribs=tilted))
    assert areas_of(contour) == pytest.approx(math.pi * 900 / 2, rel=1e-3)
    assert 4 <= len(contour.curve.segments) < 40


def test_an_ellipse_becomes_a_few_arcs(tmp_path: Path) -> None:
    contour = only(tmp_path, lambda s: s.add_ellipse((150, 100), (60, 0), 0.5))
    assert areas_of(contour) == pytest.approx(math.pi * 60 * 30, rel=1e-4)
    assert arcs(contour) == len(contour.curve.segments) < 30


def test_an_ellipse_of_equal_axes_is_a_circle(tmp_path: Path) -> None:
    contour = only(tmp_path, lambda s: s.add_ellipse((150, 100), (60, 0), 1.0))
    assert len(contour.curve.segments) == 2
    assert areas_of(contour) == round(math.pi * 3600, 3)


def test_an_elliptical_arc_joins_a_line(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_ellipse((150, 100), (60, 0), 0.5, 0, math.pi)
        space.add_line((90, 100), (210, 100))

    assert areas_of(only(tmp_path, draw)) == pytest.approx(math.pi * 900, rel=1e-4)


def test_a_spline_becomes_arcs_close_to_it(tmp_path: Path) -> None:
    points = [(50, 50), (150, 20), (250, 100), (150, 180), (50, 150), (50, 50)]

    def draw(space: Any) -> None:
        space.add_spline(points)

    contour = only(tmp_path, draw)
    spline = ezdxf.new().modelspace().add_spline(points).construction_tool()
    drawn = [(p.x, p.y) for p in spline.flattening(0.0005)]
    assert max(contour.curve.project(p)[1] for p in drawn[::7]) <= 0.011
    assert len(contour.curve.segments) < len(drawn) / 10


@pytest.mark.parametrize("first_knot", [0.0, -3.0])
def test_a_closed_spline_is_drawn_between_its_ends_only(tmp_path: Path, first_knot: float) -> None:
    """Its knots are not repeated at the ends, as CAD systems write closed splines."""
    corners = [(50, 50, 0), (150, 20, 0), (250, 100, 0), (150, 180, 0), (50, 150, 0)]
    knots = [first_knot + k for k in range(12)]

    def draw(space: Any) -> None:
        spline = space.add_spline()
        spline.set_closed(corners)
        spline.knots = knots

    contour = only(tmp_path, draw)
    around = BSpline(knots, [c[:2] for c in (*corners, *corners[:3])], 3)
    drawn = around(np.linspace(knots[3], knots[8], 400))
    assert np.allclose(drawn[0], drawn[-1])
    assert max(contour.curve.project(p)[1] for p in drawn.tolist()) <= 0.011
    assert contour.polygon.area == pytest.approx(shapely.Polygon(drawn).area, rel=1e-3)
    assert arcs(contour) == len(contour.curve.segments) < 60


def test_nested_blocks_scaled_and_mirrored(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        inner = space.doc.blocks.new("hole")
        inner.add_circle((5, 0), 2)
        outer = space.doc.blocks.new("plate with a hole")
        outer.add_lwpolyline([(0, -5), (10, -5), (10, 5), (0, 5)], close=True)
        outer.add_blockref("hole", (0, 0))
        space.add_blockref("plate with a hole", (20, 100), dxfattribs={"xscale": 3, "yscale": 3})
        space.add_blockref("plate with a hole", (300, 100), dxfattribs={"xscale": -3, "yscale": 3})
        space.add_blockref("plate with a hole", (200, 200), dxfattribs={"rotation": 90})

    nest = read_dxf(tmp_path, draw)
    assert [c.id for c in nest.contours] == ["P1.hole1", "P1.outer", "P2.hole1", "P2.outer", "P3.hole1", "P3.outer"]
    hole, plate = round(math.pi * 4, 3), 100
    assert list(areas(nest).values()) == pytest.approx([9 * hole, 9 * plate] * 2 + [hole, plate], abs=0.01)
    assert all(s.is_arc for c in nest.contours if c.kind == "hole" for s in c.curve.segments)
    assert nest.contour("P2.outer").polygon.bounds == (270, 85, 300, 115)


def test_a_block_stretched_in_one_direction(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.doc.blocks.new("disc").add_circle((0, 0), 10)
        space.add_blockref("disc", (100, 100), dxfattribs={"xscale": 4, "yscale": 2})

    assert areas_of(only(tmp_path, draw)) == pytest.approx(math.pi * 40 * 20, rel=1e-4)


def test_a_block_that_is_turned_in_one_stretched_in_one_direction(tmp_path: Path) -> None:
    """A square turned by 30° and then made twice as wide is none; it keeps the layer that it is inserted on."""

    def draw(space: Any) -> None:
        sheet(space)
        space.doc.blocks.new("square").add_lwpolyline(square(0, 0, 20), close=True)
        outer = space.doc.blocks.new("outer")
        outer.add_blockref("square", (10, 0), dxfattribs={"rotation": 30, "layer": "Turned"})
        space.add_blockref("outer", (100, 100), dxfattribs={"xscale": 2, "yscale": 1})

    [contour] = read_dxf(tmp_path, draw).contours
    assert areas_of(contour) == pytest.approx(800)
    side, up = 20 * math.cos(math.pi / 6), 10.0
    assert contour.polygon.bounds == pytest.approx((120 - 2 * up, 100, 120 + 2 * side, 100 + side + up))
    assert (contour.source.layer, contour.source.block) == ("Turned", "outer/square")


def test_a_block_inserted_in_rows(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        space.doc.blocks.new("disc").add_circle((0, 0), 10)
        rows = {"row_count": 2, "column_count": 3, "row_spacing": 50, "column_spacing": 40}
        space.add_blockref("disc", (50, 50), dxfattribs=rows)

    assert len(read_dxf(tmp_path, draw).parts) == 6


def test_layer_0_of_a_block_is_the_layer_it_is_inserted_on(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        block = space.doc.blocks.new("frame")
        block.add_lwpolyline(square(0, 0, 200), close=True)
        space.add_blockref("frame", (0, 0), dxfattribs={"layer": "SHEET"})
        space.add_circle((100, 100), 30)

    nest = read_dxf(tmp_path, draw)
    assert nest.sheet.bounds == (0, 0, 200, 200)
    assert len(nest.parts) == 1


def test_a_block_that_contains_itself_is_refused(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        block = space.doc.blocks.new("snake")
        block.add_blockref("snake", (0, 0))
        space.add_blockref("snake", (0, 0))

    with pytest.raises(InputError, match="a block seems to contain itself"):
        read_dxf(tmp_path, draw)


def test_writing_dimensions_and_fillings_are_passed_over_and_said(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        space.add_text("P1").set_placement((20, 20))
        space.add_mtext("20 mm")
        space.add_point((5, 5))
        space.add_hatch().paths.add_polyline_path(square(10, 10, 50))
        space.add_linear_dim((0, 0), (10, 10), (60, 10)).render()

    nest = read_dxf(tmp_path, draw)
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes) == [
        "left out, as they are not lines one can cut: 1 DIMENSION, 1 HATCH; explode them in CAD if they are to be cut",
        "left out, as layer '0' is not for marks: 2 texts ('P1', '20 mm'); --answer text:0=mark engraves them",
        "left out, as layer '0' is not for marks: 1 point; --answer point:0=mark marks it",
    ]


def test_meshes_are_left_out_and_counted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        space.add_polymesh((3, 3))
        space.add_polyface()
        space.add_3dface([(0, 0), (1, 0), (1, 1)])

    nest = read_dxf(tmp_path, draw)
    assert texts(nest.notes) == [
        "left out, as they are not lines one can cut: 1 3DFACE, 2 POLYLINE; explode them in CAD if they are to be cut"
    ]


def test_what_is_off_frozen_or_invisible_is_left_out_and_counted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        space.doc.layers.add("construction").off()
        space.doc.layers.add("old").freeze()
        space.add_circle((200, 100), 10, dxfattribs={"layer": "Construction"})
        space.add_circle((200, 100), 20, dxfattribs={"layer": "old"})
        space.add_circle((200, 100), 30, dxfattribs={"invisible": 1})

    nest = read_dxf(tmp_path, draw)
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes) == [
        "left out, as they are invisible or their layer is off or frozen: 1 on '0', 1 on 'Construction', 1 on 'old'"
    ]


@pytest.mark.parametrize("kind", ["line", "spline", "ellipse", "circle"])
@pytest.mark.parametrize("far", [1e9, 1e300])
def test_curves_of_astronomic_size_are_refused_at_once(tmp_path: Path, kind: str, far: float) -> None:
    """Before hundreds of thousands of chords are made of them: that took seconds."""

    def draw(space: Any) -> None:
        match kind:
            case "line":
                space.add_line((0, 0), (far, 0))
            case "spline":
                space.add_spline([(0, 0), (far, far), (far, 0), (5, 5)])
            case "ellipse":
                space.add_ellipse((0, 0), (far, 0), 0.5)
            case "circle":
                space.add_circle((0, 0), far)

    began_s = time.process_time()
    with pytest.raises(InputError, match=r"kilometre|damaged|finite"):
        read_dxf(tmp_path, draw)
    assert time.process_time() - began_s < 1.0
