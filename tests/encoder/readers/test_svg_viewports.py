"""Shares, fonts' sizes, nested viewports, paints and clones of SVG: what a viewer shows is what is cut."""

from __future__ import annotations

import gzip
import math
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Nest, Questions
from kerfwise.tests.encoder.readers.drawings import read_drawing

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="100mm" viewBox="0 0 300 100">'
PART = '<rect x="10" y="10" width="40" height="20"/>'


def read(folder: Path, body: str, **options: Any) -> Nest:
    path = folder / "drawing.svg"
    path.write_text(f'{HEAD}<g fill="none" stroke="black">{body}</g></svg>', encoding="utf-8")
    return read_drawing(path, **options)


def metal(nest: Nest) -> float:
    return float(sum(part.polygon.area for part in nest.parts))


SYMBOL = '<symbol id="s" viewBox="0 0 10 10" {}><rect x="1" y="6" width="8" height="3"/></symbol>'


@pytest.mark.parametrize(
    ("body", "area"),
    [
        ('<circle cx="50%" cy="50%" r="10%"/>', math.pi * (0.1 * math.sqrt((300**2 + 100**2) / 2)) ** 2),
        ('<rect x="10%" y="10%" width="50%" height="50%" rx="2%"/>', 150 * 50 - (4 - math.pi) * 36),
        ('<rect x="20" y="20" width="5em" height="2em" font-size="10"/>', 1000),
        ('<ellipse cx="80" cy="50" rx="30"/>', math.pi * 900),
        (
            '<svg x="50" width="100" height="60" viewBox="0 0 50 50"><rect x="10%" width="60%" height="20"/></svg>',
            36 * 24,
        ),
        (
            '<svg width="100" height="60" viewBox="0 0 50 50" preserveAspectRatio="xMinYMin slice">'
            '<rect x="5" y="2" width="30" height="20"/></svg>',
            2400,
        ),
        (SYMBOL.replace("{}", "") + '<use href="#s" x="9" width="60" height="60"/>', 48 * 18),
        (SYMBOL.replace("{}", "") + '<use href="#s" transform="scale(.5)"/>', 40 * 15),
        (SYMBOL.replace("{}", 'preserveAspectRatio="none"') + '<use href="#s" width="60" height="30"/>', 48 * 9),
        (
            SYMBOL.replace("{}", 'preserveAspectRatio="xMaxYMax slice"') + '<use href="#s" width="120" height="60"/>',
            96 * 36,
        ),
        (
            SYMBOL.replace("{}", "") + '<use href="#s" style="transform:rotate(9deg)" x="90" width="60" height="60"/>',
            864,
        ),
        ('<g rx="9" width="7"><rect width="50" height="40" x="9" y="9" rx="auto"/></g>', 2000),
        ('<rect width="50" height="40" x="9" y="9" rx="auto" ry="10"/>', 2000 - (4 - math.pi) * 100),
        (
            '<linearGradient id="g"><stop/></linearGradient><rect width="9" height="9" fill="url(#g)" stroke="none"/>',
            81,
        ),
        ("""<path style="d:path('M20 20h50v40h-50z')"/>""", 2000),
        ('<path d="M20 20h50v40h-50" fill="black" stroke="none"/>', 2000),
        ('<rect width="50" height="40" x="9" y="9" rx="-3" ry="10"/>', 2000 - (4 - math.pi) * 100),
        ('<svg width="0" height="10" viewBox="0 0 9 9"><rect width="9" height="9"/></svg>' + PART, 800),
    ],
)
def test_what_a_viewer_shows_is_read(tmp_path: Path, body: str, area: float) -> None:
    assert metal(read(tmp_path, body)) == pytest.approx(area, rel=2e-3)


@pytest.mark.parametrize(
    ("body", "bounds"),
    [
        ('<svg x="50" y="10" width="100" height="80"><rect width="50" height="50"/></svg>', (50, 40, 100, 90)),
        ('<svg x="50" width="100" height="80"><svg width="60" height="60"><rect width="9" height="9"/></svg></svg>',
         (50, 91, 59, 100)),
        ('<defs><svg id="n" x="10" y="10" width="90" height="60"><rect x="1" y="1" width="9" height="9"/></svg></defs>'
         '<use href="#n" x="100" y="10" width="40" height="20"/>', (111, 70, 120, 79)),
        ('<defs><svg id="n" x="10" y="10" width="9" height="9" viewBox="0 0 9 9"><rect width="9" height="9"/></svg>'
         '</defs><use href="#n" width="18" height="18"/>', (10, 72, 28, 90)),
        ('<g cx="90" cy="50" x1="7"><circle r="10" cx="20" transform="translate(0 50)"/></g>', (10, 40, 30, 60)),
    ],
)  # fmt: skip
def test_a_place_that_is_not_given_is_0(tmp_path: Path, body: str, bounds: tuple[float, ...]) -> None:
    """And not what an element around says of itself, which svgelements hands on."""
    assert read(tmp_path, body).parts[0].outer.polygon.bounds == pytest.approx(bounds, abs=0.03)


@pytest.mark.parametrize("root", ['display="none"', 'style="display: none"', 'fill="none"', 'opacity="0"'])
def test_what_the_root_hides_is_not_cut(tmp_path: Path, root: str) -> None:
    (path := tmp_path / "drawing.svg").write_text(HEAD.replace("<svg", f"<svg {root}") + PART + "</svg>")
    with pytest.raises(InputError, match="nothing to cut: shape is not shown: 1 "):
        read_drawing(path)


@pytest.mark.parametrize(
    "hole",
    [
        '<rect x="20" y="15" width="5" height="5" stroke="#0000"/>',
        '<rect x="20" y="15" width="5" height="5" stroke="#ff000000"/>',
        '<rect x="20" y="15" width="5" height="5" stroke="rgb(0 0 0 / 0%)"/>',
        '<rect x="20" y="15" width="5" height="5" stroke="hsla(0, 0%, 0%, 0)"/>',
        '<g color="transparent"><rect x="20" y="15" width="5" height="5" stroke="currentColor"/></g>',
        '<rect x="20" y="15" width="5" height="5" stroke="url(#gone)"/>',
        '<rect x="25" y="20" width="-5" height="-5"/>',
        '<metadata><rect x="20" y="15" width="5" height="5"/></metadata>',
        '<desc><rect x="20" y="15" width="5" height="5"/></desc>',
        '<switch><g/><rect x="20" y="15" width="5" height="5"/></switch>',
        '<switch><rect systemLanguage="tlh" x="20" y="15" width="5" height="5"/><g/></switch>',
        '<rect systemLanguage="de, fr" x="20" y="15" width="5" height="5"/>',
        '<g requiredExtensions="urn:x"><rect x="20" y="15" width="5" height="5"/></g>',
        '<defs><rect id="u" systemLanguage="de" x="20" y="15" width="5" height="5"/></defs><use href="#u"/>',
        '<svg x="60" y="10" width="5" height="5"><rect x="-40" y="5" width="5" height="5"/></svg>',
    ],
)
def test_what_no_viewer_shows_is_not_cut(tmp_path: Path, hole: str) -> None:
    nest = read(tmp_path, PART + hole)
    assert [contour.id for contour in nest.contours] == ["P1.outer"]


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ('<rect style="clip-path: inset(0 50% 0 0)" width="50" height="40"/>', r"clipped by inset\(0 50% 0 0\)"),
        ('<clipPath id="k"><text>A</text></clipPath><rect clip-path="url(#k)" width="9"/>', "of letters"),
        ('<rect style="width: calc(50px - 1%)" height="40"/>', r"has width: calc\(50px - 1%\), which is not computed"),
        ('<g style="--a: var(--b); --b: var(--a); opacity: var(--a)"><rect width="9"/></g>', "not computed"),
        ("<style>@media (min-width: 9px) {rect {opacity: 0}}</style>", r"block '@media \(min-width: 9px\)'"),
        ('<rect width="50" height="40" transform="rotate(45deg)"/>', r"its transform is 'rotate\(45deg\)'"),
        ("""<path style="d:path('M 0 0 h')"/>""", "h is followed by ''"),
    ],
)  # fmt: skip
def test_what_cannot_be_told_is_refused(tmp_path: Path, body: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        read(tmp_path, body)


def test_what_a_nested_page_cuts_off_is_asked_about(tmp_path: Path) -> None:
    body = '<svg x="60" y="10" width="30" height="30"><rect x="10" y="10" width="40" height="10"/></svg>'
    with pytest.raises(Questions, match=r"clip: the line at .* is seen only in part"):
        read(tmp_path, body)
    assert metal(read(tmp_path, body, answers=(("clip", "clipped"),))) == pytest.approx(200)
    assert metal(read(tmp_path, body.replace("<svg", '<svg overflow="visible"'))) == pytest.approx(400)


def test_what_is_for_another_language_is_told(tmp_path: Path) -> None:
    body = '<switch><rect systemLanguage="de" x="20" y="15" width="5" height="5"/><g/><rect width="9"/></switch>'
    told = [note.text for note in read(tmp_path, f'{PART}{body}<g systemLanguage="tlh"><text>A</text></g>').notes]
    assert (
        "left out, as the shapes are not shown: 3 (of a <switch>, or for another viewer or language than English)"
        in told
    )


def test_what_lies_in_other_files_is_said(tmp_path: Path) -> None:
    body = f'<style>@import url("plant.css");</style>{PART}<use href="other.svg#a"/><use href="#gone"/>'
    told = "\n".join(note.text for note in read(tmp_path, body).notes)
    assert "a clone of 'other.svg#a' is left out: it is in another file" in told
    assert "a clone of '#gone' is left out: the file holds no such thing" in told
    assert "the style sheet 'plant.css' is in another file" in told


def test_a_ring_that_its_filling_hides_is_asked_about(tmp_path: Path) -> None:
    body = '<path fill="black" stroke="none" d="M20 20h50v40h-50z m5 5 v9h9v-9z m0 20 h9 v9 h-9z"/>'
    with pytest.raises(Questions, match="fill: a ring lies in a filled shape"):
        read(tmp_path, body)
    for answer, area in (("cut", 2000 - 162), ("ignore", 2000 - 81)):
        assert metal(read(tmp_path, body, answers=(("fill", answer),), frame="part")) == pytest.approx(area)
    assert metal(read(tmp_path, body.replace("<path", '<path fill-rule="evenodd"'), frame="part")) == 2000 - 162


@pytest.mark.parametrize("name", ["drawing.svgz", "packed.svg"])
def test_packed_files(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(gzip.compress(f"{HEAD}{PART}</svg>".encode()))
    assert metal(read_drawing(path)) == 800
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(InputError, match="the file is packed, and damaged"):
        read_drawing(path)


TILT = math.tan(math.radians(20))


@pytest.mark.parametrize(
    ("body", "bounds"),
    [
        (
            '<g transform="skewX(20)"><circle cx="60" cy="40" r="8"/></g>',
            (60 + 40 * TILT - 8 * math.hypot(1, TILT), 52, 60 + 40 * TILT + 8 * math.hypot(1, TILT), 68),
        ),
        (
            '<g transform="scale(2 1) rotate(45)"><path d="M40 10a10 5 0 0 1 -20 0a10 5 0 0 1 20 0z"/></g>',
            tuple(
                at + by * math.sqrt(62.5) * way
                for at, by, way in (
                    (40 / 2**0.5, 2, -1),
                    (100 - 40 / 2**0.5, 1, -1),
                    (40 / 2**0.5, 2, 1),
                    (100 - 40 / 2**0.5, 1, 1),
                )
            ),
        ),
        (
            '<svg x="50" y="10" width="100" height="60"><rect x="10" y="10" width="40" height="20"/></svg>',
            (60, 60, 100, 80),
        ),
        ('<svg x="50" y="10" overflow="visible"><rect x="10" y="10" width="40" height="20"/></svg>', (60, 60, 100, 80)),
        (PART + '<rect x="100" y="10" width="40"/>', (10, 70, 50, 90)),
    ],
)
def test_where_a_shape_lies(tmp_path: Path, body: str, bounds: tuple[float, ...]) -> None:
    nest = read(tmp_path, body, frame="part")
    [contour] = nest.contours
    assert contour.polygon.bounds == pytest.approx(bounds, abs=0.02)


def test_a_page_as_wide_as_the_window(tmp_path: Path) -> None:
    path = tmp_path / "drawing.svg"
    path.write_text(HEAD.replace("300mm", "auto").replace("100mm", "auto") + PART + "</svg>", encoding="utf-8")
    with pytest.raises(Questions, match="names no unit"):
        read_drawing(path)
