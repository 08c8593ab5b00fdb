"""What an SVG drawing writes, on groups for marks and beside them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import shapely

from kerfwise import Nest
from kerfwise.tests.encoder.readers.drawings import box, near, read_drawing, reading, texts
from kerfwise.tests.tools.browser import launched

GROUP = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:label="Gravur"'
CAP = 0.716


def svg(folder: Path, body: str, **options: Any) -> Nest:
    path = folder / "drawing.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="200mm" viewBox="0 0 300 200">'
        '<rect id="cut" x="10" y="10" width="280" height="180" fill="none" stroke="black"/>'
        f"<g {GROUP}>{body}</g></svg>",
        encoding="utf-8",
    )
    return read_drawing(path, answers=(("frame", "part"),), **options)


SIZE = 21 / CAP
"""The size of a font whose capitals are 21 tall."""


@pytest.mark.parametrize(
    ("text", "sides"),
    [
        (f'<text x="100" y="100" font-size="{SIZE}">H</text>', (103.5, 100, 115.5, 121)),
        (f'<text x="100" y="100" style="font-size:{SIZE}px;text-anchor:middle">H</text>', (94, 100, 106, 121)),
        (f'<g style="font-size:{SIZE}"><text x="100" y="100" text-anchor="end">H</text></g>', (84.5, 100, 96.5, 121)),
        (f'<text font-size="{SIZE}" transform="translate(100 100) rotate(90)">H</text>', (100, 184.5 - 100, 121, 96.5)),
        (f'<text font-size="{SIZE}"><tspan x="100" y="100">H</tspan></text>', (103.5, 100, 115.5, 121)),
        (f'<text x="90" y="90" font-size="{SIZE}"><tspan dx="10" dy="10">H</tspan></text>', (103.5, 100, 115.5, 121)),
        (f'<text x="100" y="100" font-size="{SIZE}"> \n H <tspan> </tspan></text>', (103.5, 100, 115.5, 121)),
        (f'<text x="100" y="100" rotate="180" font-size="{SIZE}">H</text>', (84.5, 79, 96.5, 100)),
        (
            f'<text x="100" y="100" font-size="{SIZE}" textLength="76" lengthAdjust="spacingAndGlyphs">HH</text>',
            (107, 100, 169, 121),
        ),
        (f'<text x="100 150" y="100" font-size="{SIZE}">HH</text>', (103.5, 100, 165.5, 121)),
        (
            f'<text x="100" y="100" font-size="{2 * SIZE}"><tspan font-size="50%">H</tspan></text>',
            (103.5, 100, 115.5, 121),
        ),
        (f'<text x="100" y="100" font-size="{SIZE}" letter-spacing="10">HH</text>', (103.5, 100, 144.5, 121)),
    ],
)
def test_a_text_of_svg_lies_as_it_says(tmp_path: Path, text: str, sides: tuple[float, ...]) -> None:
    assert box(svg(tmp_path, text)) == near(*sides)


def test_a_style_sheet_sets_the_size(tmp_path: Path) -> None:
    body = f"<style>.big {{ font-size: {SIZE}px }} .gone {{ display: none }}</style>"
    body += '<text class="big" x="100" y="100">H</text>'
    body += '<text class="gone" x="100" y="150">no</text><text x="9" y="150" visibility="hidden">no</text>'
    nest = svg(tmp_path, body)
    assert box(nest) == near(103.5, 100, 115.5, 121)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ('<text x="20" y="50"><textPath href="#a">round</textPath></text>', "it runs along a path"),
        ('<text x="20" y="50" style="writing-mode:tb">down</text>', "it runs from top to bottom"),
        ('<text x="20" y="50" font-family="Wingdings">x</text>', "its font Wingdings shows signs"),
        ('<text x="20" y="50">漢</text>', "the font has no letter '漢'"),
    ],
)
def test_what_cannot_be_engraved_is_told(tmp_path: Path, text: str, why: str) -> None:
    nest = svg(tmp_path, text)
    assert nest.parts[0].marks == ()
    [said, _] = texts(nest.notes)
    assert why in said
    assert said.startswith("left out, as ")


def test_writing_beside_the_groups_of_svg(tmp_path: Path) -> None:
    nest = svg(tmp_path, "</g><g><text id='text12' x='50' y='50'>A-1</text>")
    assert texts(nest.notes)[:1] == [
        "left out, as what stands in no group is not for marks: 1 text ('A-1'); --answer text:=mark engraves it"
    ]
    path = tmp_path / "drawing.svg"
    told = read_drawing(path, answers=(("frame", "part"), ("text:", "mark")))
    assert len(told.parts[0].marks) == 5


def test_a_clone_writes_again(tmp_path: Path) -> None:
    body = f'<defs><text id="t" font-size="{SIZE}">H</text></defs>'
    body += '<use href="#t" x="100" y="100"/><use href="#t" x="150" y="100"/>'
    assert box(svg(tmp_path, body)) == near(103.5, 100, 165.5, 121)


@pytest.mark.parametrize("at", [1e11, 1e300])
def test_writing_nowhere_near_hides_no_part(tmp_path: Path, at: float) -> None:
    assert "left out, as " in texts(svg(tmp_path, f'<text x="{at:g}" y="5">H</text>').notes)[0]


SHOWN = (
    '<text x="20" y="30">Start</text>',
    '<text x="150" y="30" text-anchor="middle">Middle</text>',
    '<text x="290" y="60" style="text-anchor:end;font-size:9px">End at it</text>',
    '<g transform="translate(100 100) rotate(30) scale(1.5)"><text>Turned</text></g>',
    '<g transform="matrix(-1 0 0 1 120 0)" font-size="80%"><text x="20" y="150">Mirrored</text></g>',
    '<text x="20" y="170" font-size="2em"><tspan dx="5" dy="-3">Shifted</tspan></text>',
    '<text x="150" y="170" dominant-baseline="central">Central</text>',
    '<text x="200" y="170" dominant-baseline="hanging">Hanging</text>',
    '<svg x="200" y="100" width="50" height="25" viewBox="0 0 100 50"><text x="10" y="40">Inner</text></svg>',
    '<text transform="skewX(20)" x="20" y="120">Skewed</text>',
)


@pytest.mark.slow
@pytest.mark.browser
def test_texts_stand_where_a_browser_shows_them(tmp_path: Path) -> None:
    """By the middle of each text on its base line: letters of another font are of other widths."""
    body = f'<g font-size="12" font-family="Arial, Liberation Sans, sans-serif">{"".join(SHOWN)}</g>'
    nest = svg(tmp_path, body)
    strokes = {mark.id: mark.line for part in nest.parts for mark in part.marks}
    found = {
        writing.text: shapely.union_all([strokes[name] for name in writing.marks]) for writing in reading(nest).writings
    }
    script = """() => [...document.querySelectorAll("text")].map(one => {
      const box = one.getBBox(), middle = new DOMPoint(box.x + box.width / 2, box.y + box.height / 2);
      const matrix = document.querySelector("svg").getScreenCTM().inverse().multiply(one.getScreenCTM());
      const size = parseFloat(getComputedStyle(one.querySelector("tspan") ?? one).fontSize);
      const at = middle.matrixTransform(matrix), scale = Math.hypot(matrix.a, matrix.b);
      return [one.textContent, at.x, at.y, size * scale]; })"""
    with launched() as browser:
        page = browser.new_page(viewport={"width": 1200, "height": 800})
        page.set_content((tmp_path / "drawing.svg").read_text(encoding="utf-8"))
        shown = page.evaluate(script)
        page.close()
    assert len(shown) == len(SHOWN)
    for text, x, y, size in shown:
        middle = shapely.box(*found[text].bounds).centroid
        off = math.hypot(middle.x - x, 200 - middle.y - y)
        assert off < 0.4 * size, text
