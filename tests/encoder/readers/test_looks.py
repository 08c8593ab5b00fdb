"""Colours, line types and widths of DXF as blocks hand them on, names of layers that leave it open what is cut, rare
units, and files that hold nothing to cut."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from ezdxf.filemanagement import new

from kerfwise import InputError, Questions
from kerfwise.tests.encoder.readers.drawings import areas, read_drawing, save_dxf, square, texts


def closed(space: Any, x: float, y: float, side: float, **look: Any) -> Any:
    return space.add_lwpolyline(square(x, y, side), close=True, dxfattribs=look)


def asked(path: Path, **options: Any) -> dict[str, list[str]]:
    with pytest.raises(Questions) as raised:
        read_drawing(path, **options)
    return {q.id: [c.value for c in q.choices] for q in raised.value.questions}


@pytest.mark.parametrize(
    ("own", "insertion", "question"),
    [
        ({"color": 0}, {"color": 1}, "colour:red"),
        ({"layer": "0"}, {"layer": "X1"}, "colour:magenta"),
        ({"linetype": "BYBLOCK"}, {"linetype": "DASHED"}, "linetype:DASHED"),
        ({"color": 1}, {"color": 7}, "colour:red"),
    ],
)
def test_a_block_hands_its_look_on(tmp_path: Path, own: Any, insertion: Any, question: str) -> None:
    document = new("R2010", setup=True)
    document.units = 4
    document.layers.add("X1", color=6)
    space = document.modelspace()
    for name in ("inner", "outer"):
        document.blocks.new(name)
    closed(document.blocks.get("inner"), 0, 0, 10, **own)
    document.blocks.get("outer").add_blockref("inner", (0, 0), dxfattribs={"color": 0, "linetype": "BYBLOCK"} | own)
    closed(space, 0, 0, 90, layer=insertion.get("layer", "0"), color=7)
    space.add_blockref("outer", (30, 30), dxfattribs=insertion)
    document.saveas(path := tmp_path / "drawing.dxf")
    assert question in asked(path)


def test_a_line_drawn_as_a_band_is_said(tmp_path: Path) -> None:
    def bands(space: Any) -> None:
        closed(space, 0, 0, 90, const_width=6)
        space.add_lwpolyline([(30, 40, 5, 5, 1), (50, 40, 5, 5, 1)], format="xyseb", close=True)

    nest = read_drawing(save_dxf(tmp_path, bands), frame="part")
    assert "drawn up to 6 mm wide, and cut along the middle: 2 on '0'" in texts(nest.notes)


@pytest.mark.parametrize(
    ("layer", "likeliest"),
    [
        ("Score", "mark"), ("kiss cut", "mark"), ("LOGO", "mark"), ("DRILL_CENTER", "mark"), ("Punch", "mark"),
        ("FOLD", "ignore"), ("Gewinde M6", "ignore"), ("COSMETIC THREAD", "ignore"), ("Ansenkung", "ignore"),
        ("IV_FEATURE_PROFILES_DOWN", "ignore"), ("REF", "ignore"), ("Hintergrund", "ignore"), ("фон", "ignore"),
        ("Guías", "ignore"), ("Passermarken", "ignore"), ("old", "ignore"),
    ],
)  # fmt: skip
def test_names_that_leave_it_open_what_is_cut_are_asked_about(tmp_path: Path, layer: str, likeliest: str) -> None:
    def drawn(space: Any) -> None:
        closed(space, 0, 0, 90, layer="CUT")
        closed(space, 30, 30, 9, layer=layer)

    path = save_dxf(tmp_path, drawn, version="R2010")
    assert asked(path, frame="part")[f"layer:{layer}"][0] == likeliest
    assert "P1.hole1" in areas(read_drawing(path, frame="part", answers=((f"layer:{layer}", "cut"),)))
    assert "P1.hole1" not in areas(read_drawing(path, answers=((f"layer:{layer}", "ignore"),)))


def test_a_layer_that_holds_all_that_is_cut_is_cut_whatever_its_name(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, lambda space: closed(space, 0, 0, 90, layer="Temp"))
    assert list(areas(read_drawing(path))) == ["P1.outer"]


@pytest.mark.parametrize(
    "layer", ["DO NOT CUT", "no-cut", "NoCut", "uncut", "nicht schneiden", "ne pas couper", "не резать", "nie ciąć"]
)
def test_what_a_name_forbids_to_cut_is_left_out(tmp_path: Path, layer: str) -> None:
    def drawn(space: Any) -> None:
        closed(space, 0, 0, 90, layer="CUT")
        closed(space, 30, 30, 9, layer=layer)

    nest = read_drawing(save_dxf(tmp_path, drawn, version="R2010"))
    assert list(areas(nest)) == ["P1.outer"]
    assert any("drawing.layers.ignore matches" in text for text in texts(nest.notes))


@pytest.mark.parametrize(
    ("code", "side", "mm"), [(9, 4000, 101.6), (10, 0.1, 91.44), (13, 90000, 90), (14, 2, 200), (21, 1, 304.8006)]
)
def test_rare_units_of_a_header(tmp_path: Path, code: int, side: float, mm: float) -> None:
    nest = read_drawing(save_dxf(tmp_path, lambda space: closed(space, 0, 0, side), units=code))
    assert areas(nest)["P1.outer"] == pytest.approx(mm * mm, rel=1e-6)


def test_a_header_that_names_no_unit_of_a_nest_is_asked_about(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, lambda space: closed(space, 0, 0, 900), units=3)  # miles, and $MEASUREMENT says metric
    assert asked(path)["units"] == ["mm", "in"]


def test_lines_in_paper_space_alone_are_asked_about(tmp_path: Path) -> None:
    document = new("R2010")
    document.units = 4
    closed(document.layout("Layout1"), 0, 0, 50)
    document.saveas(path := tmp_path / "drawing.dxf")
    assert asked(path)["paper"] == ["read", "ignore"]
    assert areas(read_drawing(path, answers=(("paper", "read"),))) == {"P1.outer": 2500}
    with pytest.raises(InputError, match="nothing to cut"):
        read_drawing(path, answers=(("paper", "ignore"),))


def test_a_file_without_lines_says_what_it_holds(tmp_path: Path) -> None:
    document = new("R2010")
    document.units = 4
    document.modelspace().add_3dface([(0, 0), (9, 0), (9, 9), (0, 9)])
    closed(document.blocks.new("Bracket"), 0, 0, 50)
    for name in ("Layout1", "Layout2"):
        closed(document.layouts.get(name) if name in document.layouts else document.layouts.new(name), 0, 0, 50)
    document.saveas(path := tmp_path / "drawing.dxf")
    with pytest.raises(InputError) as raised:
        read_drawing(path)
    told = "\n".join(raised.value.details)
    for said in ("1 3DFACE", "2 entities are in paper space", "inserts nowhere: 'Bracket'"):
        assert said in told
