"""Bridges: outlines and strip become one outline, or are refused with the line."""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path
from typing import Any

import ezdxf
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError, Nest, read_nest
from kerfwise.rule_kit import Curve, circle, rect
from kerfwise.tests.tools.amount import examples

A = {"id": "A", "outer": [[20, 20], [120, 20], [120, 120], [20, 120]], "holes": [[[50, 70, 1], [80, 70, 1]]]}
B = {"id": "B", "outer": [[140, 70, 1], [220, 70, 1]], "marks": [[[170, 70], [190, 70]]]}
C = {"id": "C", "outer": [[240, 20], [340, 20], [340, 120], [240, 120]]}


def bridge(one: str, other: str, start: list[float], end: list[float], width: float) -> dict[str, Any]:
    return {"parts": [one, other], "from": start, "to": end, "width": width}


def read(folder: Path, parts: list[Any], bridges: list[Any], **more: Any) -> Nest:
    document = {"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 200}, "parts": parts, **more}
    rows = ",\n".join(json.dumps(row) for row in bridges)
    text = json.dumps(document)[:-1] + f', "bridges": [\n{rows}]}}'
    (folder / "nest.json").write_text(text, encoding="utf-8")
    return read_nest(folder / "nest.json")


def test_two_parts_become_one(tmp_path: Path) -> None:
    made = read(tmp_path, [C, A, B], [bridge("A", "B", [120, 70], [142, 70], 8)])
    assert [c.id for c in made.contours] == ["C.outer", "B.mark1", "A.hole1", "A+B.outer"]
    assert {c.part for c in made.parts[1]} == {"A+B"}
    outline = made.contour("A+B.outer").curve
    radii = [s.radius_mm for s in outline.segments if s.is_arc]
    assert radii == pytest.approx([40.0] * len(radii))
    # the strip from x = 120 to the circle x = 180 - sqrt(1600 - y²), for y from -4 to 4
    gap_mm2 = 8 * 60 - (4 * math.sqrt(1600 - 16) + 1600 * math.asin(0.1))
    assert outline.signed_area_mm2 == pytest.approx(100 * 100 + math.pi * 1600 + gap_mm2, abs=1e-6)
    assert [p.id for p in made.apart] == ["C", "A", "B"]


def test_a_chain_and_a_pocket(tmp_path: Path) -> None:
    """Two strips between the same parts enclose waste: a hole. The order of ends does not matter."""
    rows = [
        bridge("A", "C", [110, 30], [250, 30], 6),
        bridge("C", "A", [110, 110], [250, 110], 6),
        bridge("B", "A", [145, 70], [119, 70], 6),
    ]
    with pytest.raises(InputError, match="meets"):
        read(tmp_path, [A, B, C], [*rows[:1], bridge("A", "C", [110, 34], [250, 34], 6)])
    chain = read(tmp_path, [A, B, C], [rows[2], bridge("B", "C", [215, 70], [240, 70], 6)])
    assert [p.id for p in chain.parts] == ["A+B+C"]
    small = {"id": "B", "outer": [[170, 60], [190, 60], [190, 80], [170, 80]]}
    ring = read(tmp_path, [A, small, C], rows[:2])
    assert [c.id for c in ring.contours] == ["A.hole1", "A+C.hole1", "A+C.outer", "B.outer"]
    assert ring.contour("A+C.hole1").polygon.area == pytest.approx(120 * (107 - 33))
    assert not ring.contour("A+C.hole1").curve.is_ccw


REFUSED = {
    "third part": ([A, B, C], bridge("A", "C", [110, 70], [250, 70], 6), "meets a third part, B, at (180.0, 70.9)"),
    "hole": ([A, C], bridge("A", "C", [75, 70], [250, 70], 6), "meets A.hole1"),
    "short": ([A, C], bridge("A", "C", [120, 70], [238, 70], 6), "does not reach part C: its end at (238.000, 70.000)"),
    "round end": ([A, B], bridge("A", "B", [120, 70], [140, 70], 8), "is wider than part B where it ends"),
    "too wide": ([A, C], bridge("A", "C", [110, 70], [250, 70], 110), "is wider than part A where it ends"),
    "along an edge": ([A, C], bridge("A", "C", [110, 110], [250, 110], 20), "runs along an edge of part A"),
    "off the sheet": ([A, C], bridge("A", "C", [110, 30], [250, 30], -1), "width"),
    "itself": ([A, C], bridge("A", "A", [20, 70], [30, 70], 6), "joins a part with itself"),
    "nobody": ([A, C], bridge("A", "D", [120, 70], [238, 70], 6), "names a part 'D' that is not there"),
    "no length": ([A, C], bridge("A", "C", [120, 70], [120, 70], 6), "has no length or no width"),
    "notch": (
        [{"id": "A", "outer": [[20, 20], [120, 20], [120, 120], [60, 120], [60, 110], [110, 110], [110, 90], [60, 90],
          [60, 80], [50, 80], [50, 120], [20, 120]]}, C],
        bridge("A", "C", [40, 100], [250, 100], 6), "crosses the outline of A more often than once"),
    "guest": (
        [{"id": "A", "outer": [[20, 20], [120, 20], [120, 120], [20, 120]],
          "holes": [[[40, 40], [100, 40], [100, 100], [40, 100]]]},
         {"id": "G", "outer": [[50, 50], [90, 50], [90, 90], [50, 90]]}],
        bridge("A", "G", [30, 70], [60, 70], 6), "lies in a hole of A"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_made_is_refused_with_its_line(tmp_path: Path, case: str) -> None:
    parts, row, told = REFUSED[case]
    with pytest.raises(InputError) as refused:
        read(tmp_path, parts, [row])
    assert told in refused.value.message
    assert refused.value.line == 2
    assert "bridge 1" in refused.value.message


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ({"parts": ["A"], "from": [0, 0], "to": [1, 1], "width": 3}, "bridge 1, parts"),
        ({"parts": ["A", "B"], "from": [0], "to": [1, 1], "width": 3}, "bridge 1, from"),
        ({"parts": ["A", "B"], "from": [0, 0], "to": [1, "x"], "width": 3}, "bridge 1, to"),
        ({"parts": ["A", "B"], "from": [0, 0], "to": [1, 1]}, "width"),
        ({"parts": ["A", "B"], "from": [0, 0], "to": [1, 1], "width": 3, "wide": 3}, "wide"),
        (7, "bridge 1"),
    ],
)
def test_wrong_rows_are_named(tmp_path: Path, row: Any, told: str) -> None:
    with pytest.raises(InputError) as refused:
        read(tmp_path, [A, B], [row])
    assert told in str(refused.value)


def test_a_name_that_is_taken_and_attributes_that_differ(tmp_path: Path) -> None:
    row = bridge("A", "B", [120, 70], [142, 70], 8)
    with pytest.raises(InputError, match="has a part of that name"):
        read(tmp_path, [A, B, {**C, "id": "A+B"}], [row])
    made = read(tmp_path, [{**A, "priority": 1}, {**B, "priority": 2, "order": 7}], [row])
    assert made.parts[0].attributes == {"priority": 1, "order": 7}
    assert [n.text.split(",")[0] for n in made.notes] == ["part B"]


def test_a_scrap_line_through_the_strip_is_told(tmp_path: Path) -> None:
    row = bridge("A", "B", [120, 70], [142, 70], 8)
    with pytest.raises(InputError, match=r"scrap1 runs through part A\+B"):
        read(tmp_path, [A, B], [row], scrap=[[[130, 0], [130, 200]]])


def test_units_are_those_of_the_nest(tmp_path: Path) -> None:
    squares = {"A": [[1, 1], [3, 1], [3, 3], [1, 3]], "B": [[4, 1], [6, 1], [6, 3], [4, 3]]}
    parts = [{"id": name, "outer": rows} for name, rows in squares.items()]
    made = read(tmp_path, parts, [bridge("A", "B", [3, 2], [4, 2], 0.5)], units="in")
    assert made.contours[0].polygon.area == pytest.approx((4 + 4 + 0.5) * 25.4**2)


@given(
    gap=st.floats(5, 40),
    turn_deg=st.floats(0, 360),
    width=st.floats(1, 12),
    shift=st.floats(-20, 20),
    deep=st.floats(2, 25),
    round_one=st.booleans(),
    round_other=st.booleans(),
)
@examples(60)
def test_the_area_is_that_of_the_union(
    gap: float, turn_deg: float, width: float, shift: float, deep: float, round_one: bool, round_other: bool
) -> None:
    """Anywhere, any way round: the outline encloses what shapely's union does, and cutting the strip gives it back."""
    cos, sin = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))

    def at(x: float, y: float, *bulge: float) -> tuple[float, ...]:
        return (500 + x * cos - y * sin, 500 + x * sin + y * cos, *bulge)

    shapes = (
        circle(-40, 0, 40) if round_one else rect(-80, -40, 80, 80),
        circle(gap + 40, 0, 40) if round_other else rect(gap, -40, 80, 80),
    )
    rings = [[at(*row) for row in rows] for rows in shapes]
    start, end = at(-deep, shift), at(gap + deep, shift)
    drawn = [{"id": name, "outer": ring} for name, ring in zip("AB", rings, strict=True)]
    joined = [bridge("A", "B", list(start), list(end), width)]
    try:
        with tempfile.TemporaryDirectory() as folder:
            plate = read(Path(folder), drawn, joined, sheet={"width": 1000, "height": 1000})
        made = plate.contours[0].curve
    except InputError as refused:
        assert any(word in str(refused) for word in ("wider than part", "does not reach"))  # noqa: PT017 - a round part that the strip does not reach far enough
        return
    areas = [Curve.of(ring).polygon(1e-5) for ring in rings]
    strip = shapely.buffer(shapely.LineString([start, end]), width / 2, cap_style="flat")
    meant = shapely.union_all([*areas, strip])
    assert made.signed_area_mm2 == pytest.approx(meant.area, rel=1e-6)
    inside = made.polygon(1e-5)
    assert all(shapely.covers(shapely.buffer(inside, 1e-3), area) for area in (*areas, strip))
    assert sum(s.is_arc for s in made.segments) >= round_one + round_other


Rows = list[tuple[float, float]]


def drawing(folder: Path, rectangles: list[Rows], closed: bool = True, layer: str = "bridge") -> Path:
    made = ezdxf.new(units=4)
    model = made.modelspace()
    model.add_lwpolyline([(0, 0), (400, 0), (400, 200), (0, 200)], close=True, dxfattribs={"layer": "sheet"})
    model.add_lwpolyline([(20, 20), (120, 20), (120, 120), (20, 120)], close=True, dxfattribs={"layer": "parts"})
    model.add_circle((180, 70), 40, dxfattribs={"layer": "parts"})
    for rows in rectangles:
        model.add_lwpolyline(rows, close=closed, dxfattribs={"layer": layer})
    made.saveas(folder / "nest.dxf")
    return folder / "nest.dxf"


STRIP = [(119.0, 66.0), (142.0, 66.0), (142.0, 74.0), (119.0, 74.0)]


@pytest.mark.parametrize("layer", ["bridge", "Bridges", "BRÜCKE"])
def test_a_drawing_has_rectangles_for_them(tmp_path: Path, layer: str) -> None:
    made = read_nest(drawing(tmp_path, [STRIP], layer=layer))
    assert [c.id for c in made.contours] == ["P1+P2.outer"]
    assert made.bridges[0].width_mm == pytest.approx(8)


@pytest.mark.parametrize(
    ("rows", "closed", "told"),
    [
        (STRIP, False, "does not close"),
        ([*STRIP[:3], (121.0, 90.0)], True, "is no rectangle"),
        ([*STRIP[:3], (110.0, 70.0), STRIP[3]], True, "is no rectangle"),
        ([(x + 60, y) for x, y in STRIP], True, "does not go from one part to another"),
        ([(x + 3, y) for x, y in STRIP], True, "does not go from one part to another"),
    ],
)
def test_what_is_no_bridge_in_a_drawing_is_refused(
    tmp_path: Path, rows: list[tuple[float, float]], closed: bool, told: str
) -> None:
    with pytest.raises(InputError, match=told) as refused:
        read_nest(drawing(tmp_path, [rows], closed))
    assert "on layer 'bridge'" in refused.value.message


def test_a_layer_of_parts_of_a_bridge_is_cut(tmp_path: Path) -> None:
    made = read_nest(drawing(tmp_path, [[(250.0, 20.0), (300.0, 20.0), (300.0, 60.0)]], layer="Bridge web 3"))
    assert len(made.parts) == 3
