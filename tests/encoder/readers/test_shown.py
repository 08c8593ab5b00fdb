"""What a drawing does not show is not cut: style sheets, clips, masks, clones of SVG; clips and layers of DXF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ezdxf
import pytest
from ezdxf.math import OCS, Vec3
from ezdxf.xclip import XClip

from kerfwise import InputError, Nest, Questions
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_drawing, save_dxf, square, texts

SEEN = 'fill="none" stroke="black"'
PART = f'<rect x="10" y="10" width="40" height="40" {SEEN}/>'
HOLE = f'<rect class="a" id="h" x="20" y="20" width="10" height="10" {SEEN}/>'
BOTH, ALONE = {"P1.outer": 1600.0, "P1.hole1": 100.0}, {"P1.outer": 1600.0}


GRADIENT = '<linearGradient id="g" href="#s"/><linearGradient id="s"><stop {}/></linearGradient>'
ZEROS = ["0", "0%", "-1", "calc(0)", "calc(1 - 1)", "calc(2 * (3 - 6 / 2))", "var(--x, calc(0))", "clamp(0, -1, 1)"]
"""Ways to write that nothing is seen."""


def read(folder: Path, body: str, **options: Any) -> Nest:
    path = folder / "drawing.svg"
    head = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    path.write_text(f'{head} width="200mm" height="100mm" viewBox="0 0 200 100">{body}</svg>', encoding="utf-8")
    return read_drawing(path, frame="part", **options)


@pytest.mark.parametrize(
    ("style", "hidden"),
    [
        (".a{display:none}", True),
        ("g .a{display:none}", True),
        ("g > rect.a{display:none}", True),
        ("svg > rect.a{display:none}", False),
        ("#h{visibility:hidden}", True),
        ("rect[class=a]{opacity:0}", True),
        ("rect + rect{display:none}", True),
        ("rect ~ rect{opacity:0%}", True),
        ("g rect:nth-child(2){display:none}", True),
        ("g rect:last-of-type{display:none}", True),
        ("g rect:not(.b){stroke:none}", True),
        ("circle, .a{stroke-opacity:0}", True),
        (".a{display:none} rect.a{display:inline}", False),
        (".a{display:inline !important} rect.a{display:none}", False),
        (".a:hover{display:none}", False),
        ("@media print{.a{display:none}}", False),
        ("@media screen{.a{display:none}}", True),
        ("/* .a{display:none} */", False),
        ("rect:is(.c, .a){display:none}", True),
        ("#h{display:inline} rect:where(#h){display:none}", False),
        ("rect:not(.b, .c){display:none}", True),
        ("@supports (display:grid){@media screen{.a{display:none}}}", True),
        ("@supports not (display:grid){.a{display:none}}", False),
        ("@keyframes k{from{display:none}}", False),
        (".a{visibility:Hidden}", True),
        (".a{stroke:initial}", True),
        (".a{stroke:unset}", True),  # what stands round it says none
        *[(f".a{{opacity:{zero}}}", True) for zero in ZEROS],
        *[(f".a{{opacity:{more}}}", False) for more in ("calc(1 - .5)", "var(--not-set)", "var(--x, 1)", "min(1, 2)")],
        (":root{--Shown:none; --shown:inline} .a{display:var(--Shown)}", True),
        (":root{--shown:none} g{--shown:inline} .a{display:var(--shown)}", False),
        (".a{visibility:COLLAPSE}", True),
        (".a{display:None !important}", True),
        (".a{fill:red; fill-opacity:calc(0); stroke-opacity:0%}", True),
        (".a{stroke:rgb(0 0 0 / calc(1 - 1))}", True),
        (".a{stroke:rgb(0 0 0 / calc(1 - .5))}", False),
        (".a{stroke:var(--stroke-0, black)}", False),
        (".a{stroke-width:calc(2px - 2px)}", True),
        (".a{stroke-width:calc(1mm - 2px)}", False),
        (".a{stroke-dasharray:0 4}", True),
        (".a{stroke-dasharray:0}", False),
        (".a{stroke:context-stroke}", True),
        (".a{filter:opacity(0%)}", True),
        (".a{filter:blur(1px)}", False),
        ("@media not print{.a{display:none}}", True),
        ("@media not screen{.a{display:none}}", False),
        ("@media only screen and (color), print{.a{display:none}}", True),
        ("@media (prefers-color-scheme: dark){.a{display:none}}", False),
    ],
)
def test_style_sheets_say_what_is_shown(tmp_path: Path, style: str, hidden: bool) -> None:
    part = PART.replace("<rect", '<rect class="b"')
    nest = read(tmp_path, f"<style>{style}</style><g>{part}{HOLE}</g>")
    assert "P1.hole1" not in areas(nest) if hidden else areas(nest) == BOTH


def test_a_selector_that_is_not_known_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the style sheet's selector 'rect:has\\(x\\)' is not known"):
        read(tmp_path, f"<style>rect:has(x){{display:none}}</style>{PART}")
    with pytest.raises(InputError, match=r"the style sheet's rule 'g \{rect\{' is not known"):
        read(tmp_path, f"<style>g {{rect{{display:none}}}}</style>{PART}")
    with pytest.raises(InputError, match="the style sheet's block '@layer x' is not known"):
        read(tmp_path, f"<style>@layer x{{rect{{display:none}}}}</style>{PART}")


def test_names_with_brackets_are_names(tmp_path: Path) -> None:
    hole = HOLE.replace('id="h"', 'id="var(--h)"')
    nest = read(tmp_path, f'<g id="max(2, 3)">{PART}{hole}</g>')
    assert nest.parts[0].outer.source.layer == "max(2, 3)"


@pytest.mark.parametrize("given", ['media="print"', 'type="text/less"'])
def test_a_style_sheet_for_something_else_hides_nothing(tmp_path: Path, given: str) -> None:
    assert areas(read(tmp_path, f"<style {given}>.a{{display:none}}</style>{PART}{HOLE}")) == BOTH


@pytest.mark.parametrize(
    "hole",
    [
        HOLE.replace("<rect", '<rect opacity="0"'),
        HOLE.replace("<rect", '<rect opacity="calc(0)"'),
        HOLE.replace("<rect", '<rect style="/* stroke:red; */ opacity: max(0, -1)"'),
        f'<g style="--o:0; opacity:var(--o)">{HOLE}</g>',
        HOLE.replace("<rect", '<rect visibility="collapse"'),
        HOLE.replace('stroke="black"', 'stroke="none"'),
        HOLE.replace("<rect", '<rect stroke-width="0"'),
        f'<g opacity="0">{HOLE}</g>',
        f'<g style="display:none">{HOLE}</g>',
        f"<blob>{HOLE}</blob>",
        HOLE.replace('stroke="black"', 'stroke="url(#g)"') + GRADIENT.format('stop-opacity="0"'),
        HOLE.replace('stroke="black"', 'stroke="url(#g)"') + GRADIENT.format('stop-color="transparent"'),
        f"<defs>{HOLE}</defs>",
        f'<symbol id="s">{HOLE}</symbol>',
    ],
)
def test_what_is_not_shown_is_not_cut(tmp_path: Path, hole: str) -> None:
    nest = read(tmp_path, PART + hole)
    assert areas(nest) == ALONE
    if "defs" not in hole and "symbol" not in hole:
        assert "not shown: 1 (" in " ".join(texts(nest.notes))


def test_a_child_may_be_visible_in_a_hidden_group(tmp_path: Path) -> None:
    visible = HOLE.replace("<rect", '<rect visibility="visible"')
    assert areas(read(tmp_path, f'{PART}<g visibility="hidden">{visible}</g>')) == BOTH


def test_symbols_are_drawn_where_they_are_used(tmp_path: Path) -> None:
    symbol = f'<symbol id="s" viewBox="0 0 10 10"><rect width="10" height="10" {SEEN}/></symbol>'
    assert areas(read(tmp_path, f'{symbol}{PART}<use href="#s" x="20" y="20" width="10" height="10"/>')) == BOTH
    twice = read(tmp_path, f'{symbol}{PART}<use xlink:href="#s" x="15" y="15" width="20" height="20"/>')
    assert areas(twice) == {"P1.outer": 1600.0, "P1.hole1": 400.0}


@pytest.mark.parametrize(
    ("turned", "x0"),
    [
        ('transform="rotate(90)" transform-origin="60 20"', 50.0),
        ('style="transform: rotate(90deg); transform-origin: 60px 20px"', 50.0),
        ('style="transform: translate(10px, 0)"', 60.0),
        ('style="transform: scale(2); transform-origin: 25% 20%"', 50.0),
    ],
)
def test_transforms_about_their_origin(tmp_path: Path, turned: str, x0: float) -> None:
    nest = read(tmp_path, f'<rect x="50" y="20" width="20" height="10" {SEEN} {turned}/>')
    box = nest.parts[0].polygon.bounds
    assert box[0] == pytest.approx({50.0: box[0], 60.0: 60.0}[x0])
    if "rotate" in turned:
        assert box == pytest.approx((50, 70, 60, 90))
    if "scale" in turned:
        assert box == pytest.approx((50, 60, 90, 80))


@pytest.mark.parametrize("moved", ["translate: 5px", "rotate: 45deg", "scale: .5", "zoom: 2", "offset-path: none 1"])
def test_what_a_style_moves_by_other_means_is_refused(tmp_path: Path, moved: str) -> None:
    with pytest.raises(InputError, match="the <rect> is moved by its style"):
        read(tmp_path, PART.replace("<rect", f'<rect style="{moved}"'))
    assert areas(read(tmp_path, PART.replace("<rect", f'<rect style="{moved.split(":")[0]}: none"'))) == ALONE


CLIP = '<clipPath id="c"><rect x="0" y="0" width="{}" height="100"/></clipPath>'


@pytest.mark.parametrize(("width", "found"), [(100, BOTH), (15, None), (5, {})])
def test_a_clipping_path_hides_what_is_outside(tmp_path: Path, width: int, found: dict[str, float] | None) -> None:
    body = (
        f'{CLIP.format(width)}<g clip-path="url(#c)">{PART}{HOLE}</g><rect x="150" y="10" width="5" height="5" {SEEN}/>'
    )
    if found is None:
        with pytest.raises(Questions) as error:
            read(tmp_path, body)
        assert [question.id for question in error.value.questions] == ["clip"]
        clipped = read(tmp_path, body, answers=(("clip", "clipped"),))
        assert areas(clipped) == {"P1.outer": 200.0, "P2.outer": 25.0}
    else:
        assert areas(read(tmp_path, body)) == found | {f"P{2 if found else 1}.outer": 25.0}


def test_a_clipping_path_moves_with_what_it_clips(tmp_path: Path) -> None:
    body = f'{CLIP.format(60)}<g transform="translate(100 0)" clip-path="url(#c)">{PART}</g>'
    assert areas(read(tmp_path, body)) == ALONE


@pytest.mark.parametrize(
    "path",
    [
        '<clipPath id="c"><path clip-rule="evenodd" d="M0 0h90v90h-90zM15 15h20v20h-20z"/></clipPath>',
        '<clipPath id="c" style="clip-rule: evenodd"><path d="M0 0h90v90h-90zM15 15h20v20h-20z"/></clipPath>',
        '<clipPath id="c"><path d="M0 0h90v90h-90zM15 15v20h20v-20z"/></clipPath>',
        '<clipPath id="d"><rect width="9" height="9"/></clipPath>'
        '<clipPath id="c" clip-path="url(#d)"><rect width="90" height="90"/></clipPath>',
    ],
)
def test_a_clipping_path_has_a_hole_or_is_clipped_itself(tmp_path: Path, path: str) -> None:
    assert areas(read(tmp_path, path + PART + HOLE.replace("<rect", '<rect clip-path="url(#c)"'))) == ALONE


def test_what_lies_beside_the_page_is_asked_about(tmp_path: Path) -> None:
    beside = HOLE.replace('x="20"', 'x="-20"')
    with pytest.raises(Questions) as asked:
        read(tmp_path, PART + beside)
    assert [(q.id, [c.value for c in q.choices]) for q in asked.value.questions] == [("off-page", ["ignore", "cut"])]
    with pytest.raises(Questions) as asked:
        read(tmp_path, f'<g id="layer">{PART}{beside}</g>')  # the page is too small, most likely
    assert [c.value for c in asked.value.questions[0].choices] == ["cut", "ignore"]
    left = read(tmp_path, PART + beside, answers=(("off-page", "ignore"),))
    assert areas(left) == ALONE
    assert "left out, as it lies beside the page: 1 on 'h'" in texts(left.notes)
    both = read(tmp_path, PART + beside, answers=(("off-page", "cut"),))
    assert areas(both) == ALONE | {"P2.outer": 100.0}


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (
            '<marker id="m"><path d="M0 0h5"/></marker><path marker-end="url(#m)" fill="none"/>',
            "markers of lines, such as arrow heads (1)",
        ),
        ('<pattern id="p"><circle r="1"/></pattern><g fill="url(#p)"/>', "patterns that shapes are filled with (1)"),
        (f"<foreignObject>{HOLE}</foreignObject>", "what stands in a <foreignObject> (1)"),
        ('<set attributeName="display" to="none"/>', "animations, so that all is read as it stands without them (1)"),
    ],
)
def test_what_is_drawn_by_other_means_is_said(tmp_path: Path, more: str, told: str) -> None:
    nest = read(tmp_path, PART + more)
    assert areas(nest) == ALONE
    assert f"left out: {told}" in texts(nest.notes)


def test_what_a_mask_hides_is_asked_about(tmp_path: Path) -> None:
    body = f'<mask id="m"><rect width="9" height="9"/></mask>{PART}<g mask="url(#m)">{HOLE}</g>'
    with pytest.raises(Questions) as error:
        read(tmp_path, body)
    assert [question.id for question in error.value.questions] == ["mask"]
    assert areas(read(tmp_path, body, answers=(("mask", "ignore"),))) == ALONE
    assert areas(read(tmp_path, body, answers=(("mask", "whole"),))) == BOTH


def test_a_length_with_a_comma_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "comma.svg"
    path.write_text('<?xml version="1.0"?>\n<!-- a -->\n<svg xmlns="http://www.w3.org/2000/svg"\n width="300,5mm"/>')
    with pytest.raises(InputError, match="width is '300,5mm', expected a length") as error:
        read_drawing(path)
    assert error.value.line == 3


def dxf(folder: Path, draw: Any) -> Nest:
    document = ezdxf.new("R2010", units=4)
    document.blocks.new("B")
    block = document.blocks.get("B")
    draw(document, document.modelspace(), block)
    path = folder / "drawing.dxf"
    document.saveas(path)
    return read_drawing(path, frame="part")


def test_a_clipped_block_shows_what_is_in_its_clip(tmp_path: Path) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        block.add_lwpolyline(square(0, 0, 10), close=True)
        block.add_lwpolyline(square(100, 0, 20), close=True)
        insert = space.add_blockref("B", (0, 0))
        XClip(insert).set_block_clipping_path([(-5, -5), (50, -5), (50, 50), (-5, 50)])

    nest = dxf(tmp_path, draw)
    assert areas(nest) == {"P1.outer": 100.0}
    assert "a clipping path hides them: 1 on '0'" in " ".join(texts(nest.notes))


def test_layers_off_and_frozen_of_blocks_and_paper_space(tmp_path: Path) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        for name in ("OFF", "FROZEN"):
            document.layers.add(name)
        document.layers.get("OFF").off()
        document.layers.get("FROZEN").freeze()
        block.add_lwpolyline(square(0, 0, 10), close=True, dxfattribs={"layer": "CUT"})
        block.add_lwpolyline(square(20, 0, 10), close=True)  # lies on the layer of its insertion
        space.add_blockref("B", (0, 0), dxfattribs={"layer": "OFF"})
        space.add_blockref("B", (100, 0), dxfattribs={"layer": "FROZEN"})
        lines(document.layout("Layout1"), square(0, 0, 5))

    nest = dxf(tmp_path, draw)
    assert areas(nest) == {"P1.outer": 100.0}
    said = " ".join(texts(nest.notes))
    assert "left out: 4 entities are in paper space" in said
    assert "1 on 'FROZEN', 1 on 'OFF'" in said


def test_tilted_planes_and_layers_without_print_are_said(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 100))
        centre = OCS((0, -1, 1)).from_wcs(Vec3(50, 50, 0))
        space.add_circle(centre, 10, dxfattribs={"extrusion": (0, -1, 1), "layer": "3D"})
        for add in (space.add_text, space.add_mtext):
            add("A1", dxfattribs={"insert": (30, 30), "extrusion": (0, -1, 1), "layer": "3D"})
        space.doc.layers.add("Holes").dxf.plot = 0
        space.add_circle((20, 20), 5, dxfattribs={"layer": "Holes"})

    notes = texts(read_drawing(save_dxf(tmp_path, draw), frame="part").notes)
    assert "drawn on a tilted plane, and read as it is seen from above: 3 on '3D'" in notes
    assert "on layers that are never printed, and read like all others: 1 on 'Holes'" in notes


@pytest.mark.parametrize("wrong", ["120,75", "12#0.75", "1.207D+02", "1_0", "nan", ""])
def test_numbers_that_are_none(tmp_path: Path, wrong: str) -> None:
    path = tmp_path / "numbers.dxf"
    path.write_text(f"0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\nK\n10\n{wrong}\n20\n1.0\n40\n2.0\n0\nENDSEC\n0\nEOF\n")
    with pytest.raises(InputError) as error:
        read_drawing(path)
    assert (error.value.line, "on layer 'K'" in error.value.message) == (10, True)


@pytest.mark.parametrize("gap", [0.04, 0.3, 1.2])
def test_a_line_drawn_beside_itself(tmp_path: Path, gap: float) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        lines(space, [(0, 0), (100, 0), (100, 60), (40, 60), (0, 30)])
        inner = [(gap, gap), (100 - gap, gap), (100 - gap, 60 - gap), (40 + gap / 3, 60 - gap), (gap, 30 - gap / 3)]
        space.add_lwpolyline(inner, close=True)

    dxf_file = tmp_path / "drawing.dxf"
    kerf = {"kerf_mm": 1.5}
    if gap <= 0.1:
        assert list(areas(dxf(tmp_path, draw))) == ["P1.outer"]
        return
    with pytest.raises(Questions):
        dxf(tmp_path, draw) if gap < 0.2 else read_drawing(_saved(tmp_path, draw), **kerf)
    outer = read_drawing(dxf_file, answers=(("doubled", "outer"),), **kerf)
    assert areas(outer) == {"P1.outer": 5400.0}
    assert len(areas(read_drawing(dxf_file, answers=(("doubled", "inner"),), **kerf))) == 1


def _saved(folder: Path, draw: Any) -> Path:
    document = ezdxf.new("R2010", units=4)
    draw(document, document.modelspace(), None)
    path = folder / "drawing.dxf"
    document.saveas(path)
    return path


def test_metal_that_is_all_kerf_is_no_part(tmp_path: Path) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        space.add_lwpolyline([(0, 0), (300, 0), (300, 40), (0, 60)], close=True)
        space.add_lwpolyline([(0, 100), (80, 100), (80, 100.02), (0, 100.02)], close=True)

    path = _saved(tmp_path, draw)
    with pytest.raises(Questions) as error:
        read_drawing(path, kerf_mm=1.5)
    [question] = error.value.questions
    assert (question.id, [choice.value for choice in question.choices]) == ("thin", ["ignore", "mark", "cut"])
    kept = read_drawing(path, kerf_mm=1.5, answers=(("thin", "ignore"),))
    assert [part.id for part in kept.parts] == ["P1"]


def test_line_types_are_asked_about(tmp_path: Path) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        document.linetypes.add("CENTER", [2.0, 1.25, -0.25, 0.25, -0.25])
        space.add_lwpolyline([(0, 0), (300, 0), (300, 40), (0, 60)], close=True)
        space.add_circle((50, 25), 10, dxfattribs={"linetype": "CENTER"})

    path = _saved(tmp_path, draw)
    with pytest.raises(Questions) as error:
        read_drawing(path)
    [question] = error.value.questions
    assert (question.id, question.choices[0].value) == ("linetype:CENTER", "ignore")
    assert list(areas(read_drawing(path, layers={"linetype": {"center": "cut"}}))) == ["P1.hole1", "P1.outer"]


def test_names_in_utf8_of_an_old_file(tmp_path: Path) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        space.add_lwpolyline([(0, 0), (300, 0), (300, 40), (0, 60)], close=True)
        space.add_circle((50, 25), 10, dxfattribs={"layer": "Gravxxr"})

    path = _saved(tmp_path, draw)
    document = ezdxf.readfile(path)
    document.dxfversion = "R2000"
    document.saveas(path)
    path.write_bytes(path.read_bytes().replace(b"Gravxxr", "Gravír".encode()))
    nest = read_drawing(path)
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.outer"]
    assert nest.reading is not None
    assert {row.layer for row in nest.reading.taken} == {"0", "Gravír"}


def test_a_colour_with_open_lines_is_engraved_most_likely(tmp_path: Path) -> None:
    def draw(document: Any, space: Any, block: Any) -> None:
        space.add_lwpolyline([(0, 0), (300, 0), (300, 40), (0, 60)], close=True)
        space.add_circle((50, 25), 10, dxfattribs={"color": 1})
        space.add_line((100, 20), (150, 20), dxfattribs={"color": 1})

    path = _saved(tmp_path, draw)
    with pytest.raises(Questions) as error:
        read_drawing(path)
    assert [(q.id, q.choices[0].value) for q in error.value.questions] == [("colour:red", "mark")]
    nest = read_drawing(path, answers=(("colour:red", "mark"),))
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.mark2", "P1.outer"]
