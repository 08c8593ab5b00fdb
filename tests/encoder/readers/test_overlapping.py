"""Outlines of SVG that overlap, and holes that are drawn with their thread or countersink, are asked about."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Questions
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_drawing, save_dxf, square

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="100mm" viewBox="0 0 300 100">'
PLATE = '<rect x="10" y="10" width="100" height="60"/>'


def svg(folder: Path, body: str) -> Path:
    path = folder / "drawing.svg"
    path.write_text(f'{HEAD}<g fill="none" stroke="black">{body}</g></svg>', encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("body", "join", "notch", "largest"),
    [
        ('<rect x="90" y="30" width="40" height="20"/>', 6400, 5600, 6000),
        ('<circle cx="60" cy="10" r="10"/>', 6000 + 50 * math.pi, 6000 - 50 * math.pi, 6000),
        ('<rect x="100" y="0" width="20" height="100"/><rect x="0" y="60" width="120" height="20"/>', None, 4500, 6000),
    ],
)
def test_outlines_that_overlap(tmp_path: Path, body: str, join: float | None, notch: float, largest: float) -> None:
    path = svg(tmp_path, PLATE + body)
    with pytest.raises(Questions) as raised:
        read_drawing(path)
    [question] = raised.value.questions
    assert (question.id, [c.value for c in question.choices]) == ("overlap", ["join", "notch", "largest", "refuse"])
    for answer, area in (("join", join), ("notch", notch), ("largest", largest)):
        found = areas(read_drawing(path, answers=(("overlap", answer),)))
        assert area is None or found == {"P1.outer": pytest.approx(area, rel=2e-3)}
    with pytest.raises(InputError, match="cannot be cut as it is drawn"):
        read_drawing(path, answers=(("overlap", "refuse"),))


def test_holes_that_overlap_are_one(tmp_path: Path) -> None:
    slot = '<circle cx="40" cy="40" r="10"/><rect x="40" y="35" width="30" height="10"/>'
    found = areas(read_drawing(svg(tmp_path, PLATE + slot), frame="part", answers=(("overlap", "join"),)))
    assert set(found) == {"P1.outer", "P1.hole1"}


def pairs(outer: float, inner: float, off: float = 0.0) -> Any:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 200))
        for x in (50, 150):
            space.add_circle((x, 50), outer)
            space.add_circle((x + off, 50), inner)

    return draw


@pytest.mark.parametrize(("outer", "inner"), [(1.5, 1.26), (5, 4.25), (5.2, 2.75), (12, 10)])
def test_a_hole_with_its_thread_or_countersink(tmp_path: Path, outer: float, inner: float) -> None:
    path = save_dxf(tmp_path, pairs(outer, inner))
    with pytest.raises(Questions) as raised:
        read_drawing(path, frame="part", kerf_mm=0.2)
    [question] = raised.value.questions
    assert (question.id, [c.value for c in question.choices]) == ("doubled", ["inner", "outer", "both"])
    assert "2 holes hold a disc each" in question.text
    for answer, radius in (("inner", inner), ("outer", outer)):
        found = areas(read_drawing(path, frame="part", kerf_mm=0.2, answers=(("doubled", answer),)))
        assert found["P1.hole2"] == pytest.approx(math.pi * radius**2, rel=1e-3)
        assert "P2.outer" not in found
    found = areas(read_drawing(path, frame="part", kerf_mm=0.2, answers=(("doubled", "both"),)))
    assert "P3.outer" in found


def test_small_neighbours_are_no_line_drawn_twice(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 0.25))
        lines(space, square(0.27, 0, 0.25))
        lines(space, square(10, 0, 50))

    found = areas(read_drawing(save_dxf(tmp_path, draw), kerf_mm=0.2, answers=(("thin", "cut"),)))
    assert len(found) == 3


@pytest.mark.parametrize(("extent", "first"), [(65, "mm"), (300, "px")])
def test_the_likeliest_unit_gives_a_sheet_that_can_be_one(tmp_path: Path, extent: int, first: str) -> None:
    path = tmp_path / "drawing.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {extent} 40">{PLATE}</svg>')
    with pytest.raises(Questions) as raised:
        read_drawing(path)
    assert raised.value.questions[0].choices[0].value == first


@pytest.mark.parametrize(("outer", "inner", "off"), [(30, 20, 0.0), (15, 5, 0.0), (15, 8, 2.0)])
def test_a_disc_that_can_be_a_part_is_one(tmp_path: Path, outer: float, inner: float, off: float) -> None:
    found = areas(read_drawing(save_dxf(tmp_path, pairs(outer, inner, off)), frame="part", kerf_mm=0.2))
    assert "P3.outer" in found


@pytest.mark.parametrize(
    ("holes", "expected"),
    [
        ('<rect x="10" y="30" width="20" height="10"/>', {"P1.outer": 5800}),  # flush with an edge
        ('<path d="M50 10 a10 10 0 0 0 20 0 z"/>', {"P1.outer": 6000 - 50 * math.pi}),
        ('<rect x="10" y="10" width="20" height="10"/>', {"P1.outer": 5800}),  # at a corner
        ('<rect x="50" y="10" width="10" height="60"/>', {"P1.outer": 2400, "P2.outer": 3000}),  # right across
        (
            '<rect x="30" y="30" width="10" height="10"/><rect x="40" y="25" width="10" height="30"/>',
            {"P1.outer": 6000, "P1.hole1": 400},
        ),
        ('<path d="M10 40 l20 10 v-20 z"/>', {"P1.outer": 6000, "P1.hole1": 200}),  # that touches at a point alone
    ],
)
def test_a_hole_that_shares_an_edge_is_a_notch(tmp_path: Path, holes: str, expected: dict[str, float]) -> None:
    nest = read_drawing(svg(tmp_path, PLATE + holes), frame="part")
    assert areas(nest) == pytest.approx(expected, rel=1e-6)
    said = [note.text for note in nest.notes if "cut as one outline" in note.text]
    assert len(said) == (0 if "P1.hole1" in expected and expected["P1.hole1"] == 200 else 1)
    arcs = sum(s.is_arc for s in nest.contours[-1].curve.segments)
    assert arcs == (1 if "a10" in holes else 0)
