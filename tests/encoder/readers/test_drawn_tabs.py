"""Tabs of drawings: short lines on the outline of a part, or across it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import kerfwise
from kerfwise import InputError
from kerfwise.tests.encoder.readers.drawings import lines, read_drawing, read_dxf, sheet, square

SVG = """\
<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">
 <rect x="20" y="20" width="60" height="40"/>
 <g id="Mikrostege"><line x1="50" y1="58" x2="50" y2="62"/></g>
</svg>
"""


def tabbed(space: Any, *drawn: tuple[tuple[float, float], tuple[float, float]], layer: str = "tab") -> None:
    """Two plates 2 mm apart, each with a hole, and lines on a layer."""
    sheet(space)
    for x in (10, 72):
        lines(space, square(x, 10, 60))
        lines(space, square(x + 20, 30, 10))
    for a, b in drawn:
        space.add_line(a, b, dxfattribs={"layer": layer})


def tabs(folder: Path, *drawn: tuple[tuple[float, float], tuple[float, float]]) -> dict[str, list[tuple[Any, float]]]:
    """By contour, place and width of each."""
    nest = read_dxf(folder, lambda space: tabbed(space, *drawn))
    return {
        p.outer.id: [(tuple(round(v, 6) for v in t.at), round(t.width_mm, 6)) for t in p.tabs]
        for p in nest.parts
        if p.tabs
    }


def test_a_line_along_the_outline_is_as_long_as_its_tab_is_wide(tmp_path: Path) -> None:
    assert tabs(tmp_path, ((30, 10), (30.6, 10))) == {"P1.outer": [((30.3, 10), 0.6)]}


def test_a_line_across_the_outline_says_its_place(tmp_path: Path) -> None:
    assert tabs(tmp_path, ((30, 8), (30, 13)), ((90, 70), (90, 74))) == {
        "P1.outer": [((30, 10), 0)],
        "P2.outer": [((90, 70), 0)],
    }


def test_a_circle_on_the_outline_says_its_place(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        tabbed(space)
        space.add_circle((40, 70), 0.8, dxfattribs={"layer": "Microjoints"})

    (tab,) = read_dxf(tmp_path, draw).parts[0].tabs
    assert tab.at == pytest.approx((40, 70), abs=0.01)
    assert tab.width_mm == 0


def test_a_group_of_an_svg_has_tabs(tmp_path: Path) -> None:
    (tmp_path / "drawing.svg").write_text(SVG, encoding="utf-8")
    (part,) = read_drawing(tmp_path / "drawing.svg").parts
    assert [tab.at for tab in part.tabs] == [(50, 40)]


@pytest.mark.parametrize(
    ("drawn", "why"),
    [
        (((200, 200), (205, 200)), "lies on no outer contour of a part"),
        (((29, 35), (32, 35)), "lies on no outer contour of a part"),
        (((69, 30), (74, 30)), "lies on two outer contours, P1.outer and P2.outer"),
    ],
)
def test_what_is_no_tab_is_refused(tmp_path: Path, drawn: Any, why: str) -> None:
    with pytest.raises(InputError) as error:
        tabs(tmp_path, drawn)
    assert why in error.value.message
    assert error.value.message.endswith("to take it for a line: drawing: {layers: {cut: '^(0|tab)$'}}")


def test_a_plant_names_the_layer(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, lambda s: tabbed(s, ((30, 8), (30, 13)), layer="7"), layers={"tab": "^7$"})
    assert [len(part.tabs) for part in nest.parts] == [1, 0]


def test_the_planner_leaves_them_there(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, lambda space: tabbed(space, ((30, 8), (30, 13))))
    ids = [contour.id for contour in nest.contours]
    plant = tmp_path / "plant.yaml"
    plant.write_text("based_on: laser-st10kp-2mm\nrules: {hold-small-parts: {strength: hard, tabs: nest, count: 1}}\n")
    ways = [way for way in kerfwise.facts(nest, plant).candidates if ids[way.contour] == "P1.outer"]
    assert {tuple(tab.at for tab in way.tabs) for way in ways} == {((30.0, 10.0),)}
