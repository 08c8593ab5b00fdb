"""Drawings that were once read wrongly without a word: what each asks, and what it holds once that is answered."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Nest, Questions
from kerfwise.tests.encoder.readers.drawings import read_drawing

CASES = Path(__file__).parent / "cases"
PART = {"frame": "part"}


def read(name: str, answers: dict[str, str], **options: Any) -> Nest:
    return read_drawing(CASES / name, answers=tuple(answers.items()), **options)


def asked(name: str, **options: Any) -> dict[str, list[str]]:
    """The questions of a file with the choices of each."""
    with pytest.raises(Questions) as error:
        read_drawing(CASES / name, **options)
    return {question.id: [choice.value for choice in question.choices] for question in error.value.questions}


def sizes(nest: Nest) -> dict[str, tuple[float, float]]:
    """Width and height of each contour, mm."""
    boxes = {c.id: c.curve.line().bounds for c in nest.contours}
    return {name: (round(x1 - x0, 1), round(y1 - y0, 1)) for name, (x0, y0, x1, y1) in boxes.items()}


@pytest.mark.parametrize(
    ("name", "questions"),
    [
        ("01-svg-clippath.svg", {"clip": ["clipped", "whole", "ignore"]}),
        ("05-svg-illustrator-points.svg", {"frame": ["part", "sheet"]}),
        ("20-dxf-inch-measurement0.dxf", {"units": ["in", "mm"], "frame": ["part", "sheet"]}),
        (
            "27-dxf-overlapping-collinear.dxf",
            {"frame": ["part", "sheet"], "layer:0": ["open:ignore", "open:mark", "mark", "ignore"]},
        ),
        ("28-dxf-doubled-nearly.dxf", {"frame": ["part", "sheet"]}),
        ("31-dxf-corners-overrun.dxf", {"layer:0": ["open:close", "ignore", "mark", "scrap"]}),
        ("50-dxf-freecad-sketch-layer.dxf", {"frame": ["part", "sheet"]}),
        ("51-dxf-plate-and-holes-layers.dxf", {"layer:PLATE": ["cut", "sheet", "ignore"]}),
        ("54-dxf-escaped-layer-names.dxf", {"frame": ["part", "sheet"]}),
        (
            "71-svg-colours-cut-and-engrave.svg",
            {
                "colour:black": ["mark", "cut", "ignore"],
                "colour:blue": ["cut", "mark", "ignore"],
                "frame": ["part", "sheet"],
            },
        ),
        ("77-svg-page-resized-to-rectangular-part.svg", {"frame": ["part", "sheet"]}),
    ],
)
def test_what_nobody_can_tell_is_asked(name: str, questions: dict[str, list[str]]) -> None:
    assert asked(name) == questions


@pytest.mark.parametrize(
    ("name", "answers", "expected"),
    [
        ("01-svg-clippath.svg", {"clip": "clipped"}, {"P1.outer": (60, 80)}),
        ("01-svg-clippath.svg", {"clip": "whole"}, {"P1.outer": (120, 80)}),
        ("05-svg-illustrator-points.svg", PART, {"P1.hole1": (40, 40), "P1.outer": (100, 100)}),
        (
            "20-dxf-inch-measurement0.dxf",
            PART | {"units": "in"},
            {"P1.hole1": (203.2, 203.2), "P1.hole2": (203.2, 203.2), "P1.outer": (1219.2, 609.6)},
        ),
        (
            "27-dxf-overlapping-collinear.dxf",
            PART | {"layer:0": "open:ignore"},
            {"P1.hole1": (20, 20), "P1.outer": (100, 60)},
        ),
        ("31-dxf-corners-overrun.dxf", {"layer:0": "open:close"}, {"P1.outer": (100, 60)}),
        ("28-dxf-doubled-nearly.dxf", PART, {"P1.hole1": (20, 20), "P1.outer": (100, 60)}),
        (
            "50-dxf-freecad-sketch-layer.dxf",
            PART,
            {**{f"P1.hole{k}": (18, 18) for k in range(1, 5)}, "P1.hole5": (60, 40), "P1.outer": (200, 100)},
        ),
        (
            "51-dxf-plate-and-holes-layers.dxf",
            {"layer:PLATE": "cut"},
            {**{f"P1.hole{k}": (18, 18) for k in range(1, 5)}, "P1.hole5": (60, 40), "P1.outer": (200, 100)},
        ),
        (
            "54-dxf-escaped-layer-names.dxf",
            PART,
            {"P1.mark1": (60, 40), "P1.hole1": (20, 20), "P1.outer": (200, 100)},
        ),
        (
            "71-svg-colours-cut-and-engrave.svg",
            PART | {"colour:blue": "mark", "colour:black": "mark"},
            {"P1.mark1": (60, 30), "P1.mark2": (20, 9), "P1.hole1": (18, 18), "P1.outer": (120, 90)},
        ),
        (
            "77-svg-page-resized-to-rectangular-part.svg",
            PART,
            {"P1.hole1": (18, 18), "P1.outer": (50, 50)},
        ),
    ],
)
def test_what_it_holds_once_it_is_answered(
    name: str, answers: dict[str, str], expected: dict[str, tuple[float, float]]
) -> None:
    assert sizes(read(name, answers)) == expected


def test_colours_as_a_plant_maps_them() -> None:
    nest = read(
        "71-svg-colours-cut-and-engrave.svg", PART, layers={"colour": {"red": "cut", "blue": "mark", "black": "ignore"}}
    )
    assert list(sizes(nest)) == ["P1.mark1", "P1.hole1", "P1.outer"]


def test_a_number_with_a_comma_is_refused_with_its_line() -> None:
    with pytest.raises(InputError) as error:
        read("63-dxf-comma-decimals.dxf", {})
    assert (error.value.line, error.value.message[:20]) == (10, "'20,50' is no number")
    assert "expected one such as 20.50" in error.value.message


def test_a_part_at_the_origin_does_not_hang_off_a_given_sheet() -> None:
    nest = read("78-dxf-part-at-the-origin.dxf", {}, sheet_mm=(1000.0, 500.0))
    assert nest.sheet.bounds == (-10, -10, 990, 490)
