"""What a drawing writes, and its points, on layers for marks and on others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Nest
from kerfwise.tests.encoder.readers.drawings import (
    box,
    lines,
    near,
    read_drawing,
    read_dxf,
    reading,
    save_dxf,
    sheet,
    square,
    texts,
)

H_NEXT = 19 / 21
"""How far the letter after an H is, for a height of 1; the strokes of the H reach from 3.5 to 15.5 of 21."""
MARK = {"layer": "Gravur"}


def plate(space: Any) -> None:
    sheet(space)
    lines(space, square(10, 10, 280))


def written(folder: Path, text: str, **attributes: Any) -> Nest:
    def draw(space: Any) -> None:
        plate(space)
        space.add_text(text, dxfattribs=MARK | attributes)

    return read_dxf(folder, draw)


def test_a_text_is_engraved_at_its_height(tmp_path: Path) -> None:
    nest = written(tmp_path, "HH", height=21, insert=(100, 100))
    assert box(nest) == near(103.5, 100, 100 + 19 + 15.5, 121)
    assert [mark.id for mark in nest.parts[0].marks] == [f"P1.mark{k}" for k in range(1, 7)]
    assert nest.notes == ()


@pytest.mark.parametrize(
    ("attributes", "sides"),
    [
        ({"width": 0.5}, (101.75, 100, 107.75, 121)),
        ({"rotation": 90}, (79, 103.5, 100, 115.5)),
        ({"oblique": 45}, (103.5, 100, 100 + 15.5 + 21, 121)),
        ({"text_generation_flag": 2}, (84.5, 100, 96.5, 121)),
        ({"text_generation_flag": 4}, (103.5, 79, 115.5, 100)),
        ({"halign": 1, "align_point": (100, 100)}, (94, 100, 106, 121)),
        ({"halign": 2, "valign": 3, "align_point": (100, 100)}, (84.5, 79, 96.5, 100)),
        ({"halign": 0, "valign": 2, "align_point": (100, 100)}, (103.5, 89.5, 115.5, 110.5)),
        ({"halign": 0, "valign": 1, "align_point": (100, 100)}, (103.5, 107, 115.5, 128)),
        ({"halign": 5, "align_point": (138, 100)}, (107, 100, 131, 121)),
        ({"halign": 3, "align_point": (138, 100)}, (107, 100, 131, 142)),
        ({"extrusion": (0, 0, -1), "insert": (-100, 100)}, (84.5, 100, 96.5, 121)),
    ],
)
def test_a_text_lies_as_its_entity_says(tmp_path: Path, attributes: dict[str, Any], sides: tuple[float, ...]) -> None:
    nest = written(tmp_path, "H", **{"height": 21, "insert": (100, 100), **attributes})
    assert box(nest) == near(*sides)


@pytest.mark.parametrize(
    ("scales", "sides"),
    [
        ({}, (103.5, 100, 115.5, 121)),
        ({"xscale": -1}, (84.5, 100, 96.5, 121)),
        ({"xscale": 2, "yscale": 2}, (107, 100, 131, 142)),
        ({"xscale": 2}, (107, 100, 131, 121)),
        ({"rotation": 180}, (84.5, 79, 96.5, 100)),
        ({"yscale": -1, "rotation": 90}, (100, 103.5, 121, 115.5)),
    ],
)
@pytest.mark.parametrize("kind", ["TEXT", "MTEXT"])
def test_writing_in_a_block_goes_with_the_block(
    tmp_path: Path, kind: str, scales: dict[str, float], sides: tuple[float, ...]
) -> None:
    def draw(space: Any) -> None:
        plate(space)
        block = space.doc.blocks.new("tag")
        if kind == "TEXT":
            block.add_text("H", dxfattribs=MARK | {"height": 21})
        else:
            block.add_mtext("H", dxfattribs=MARK | {"char_height": 21, "attachment_point": 7})
        space.add_blockref("tag", (100, 100), dxfattribs=scales)

    if kind == "MTEXT" and scales == {"xscale": 2}:
        sides = (103.5, 100, 115.5, 121)  # MTEXT has no width of its own
    assert box(read_dxf(tmp_path, draw)) == near(*sides)


@pytest.mark.parametrize(
    ("point", "sides"),
    [
        (1, (103.5, 79, 115.5, 100)),
        (5, (94, 89.5, 106, 110.5)),
        (9, (84.5, 100, 96.5, 121)),
    ],
)
def test_paragraphs_are_attached_where_they_say(tmp_path: Path, point: int, sides: tuple[float, ...]) -> None:
    def draw(space: Any) -> None:
        plate(space)
        placed = {"char_height": 21, "attachment_point": point, "insert": (100, 100)}
        space.add_mtext("{\\fArial|b1;H}", dxfattribs=MARK | placed)

    assert box(read_dxf(tmp_path, draw)) == near(*sides)


def test_paragraphs_have_lines_fractions_and_lines_under_words(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        content = "H\\PH {\\L\\H0.5x;H} \\S1/2;"
        space.add_mtext(content, dxfattribs=MARK | {"char_height": 21, "attachment_point": 1, "insert": (100, 200)})

    nest = read_dxf(tmp_path, draw)
    assert [writing.text for writing in reading(nest).writings] == ["H\nH H 1/2"]
    assert box(nest)[3] == pytest.approx(200, abs=2e-3)
    assert box(nest)[1] < 200 - 21 - 21 - 3  # the second line, and the line under a word of it


def test_attributes_are_engraved_and_hidden_ones_are_not(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        block = space.doc.blocks.new("tag")
        block.add_attdef("NO", (0, 0), "never", dxfattribs=MARK)
        block.add_attdef("MADE", (0, 9), "HH", dxfattribs=MARK | {"flags": 2})
        insert = space.add_blockref("tag", (100, 100), dxfattribs={"column_count": 2, "column_spacing": 50})
        insert.add_attrib("NO", "4711", (100, 100), dxfattribs=MARK | {"halign": 1, "align_point": (100, 100)})
        insert.add_attrib("SECRET", "secret", (100, 120), dxfattribs=MARK | {"flags": 1})

    nest = read_dxf(tmp_path, draw)
    found = sorted((w.text, w.at) for w in reading(nest).writings)
    assert found == [("4711", (100, 100)), ("4711", (150, 100)), ("HH", (100, 109)), ("HH", (150, 109))]


def test_signs_are_those_that_the_text_means(tmp_path: Path) -> None:
    nest = written(tmp_path, "%%c12 %%p0.1 45%%d %%065 %%uH\\U+0151", height=5, insert=(50, 50))
    assert [w.text for w in reading(nest).writings] == ["Ø12 ±0.1 45° A Hő"]


def test_letters_that_are_not_in_the_font_are_told(tmp_path: Path) -> None:
    [said] = texts(written(tmp_path, "No 漢字", height=5, insert=(50, 50)).notes)
    assert said == (
        "left out, as the font has no letters '漢', '字' (turn it into lines in CAD): the text 'No 漢字' at (50.000, "
        "50.000) on layer 'Gravur'"
    )


def test_letters_that_nobody_can_read_are_left_out(tmp_path: Path) -> None:
    nest = written(tmp_path, "i. see", height=0.02, insert=(50, 50))
    [said] = texts(nest.notes)
    assert said.startswith("left out, as its capitals are 0.02 mm tall, less than 0.5 mm: the text 'i. see'")
    assert "texts" not in reading(nest).short()
    assert len(written(tmp_path, "i. see", height=0.5, insert=(50, 50)).parts[0].marks) > 5


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("{\\A", "its formatting cannot be read"),
        ("H\\U+D800", ""),
        ("}\\S;", ""),
    ],
)
def test_damaged_writing_is_left_out_alone(tmp_path: Path, content: str, why: str) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_mtext(content, dxfattribs=MARK | {"insert": (50, 50)})
        space.add_text("H", dxfattribs=MARK | {"insert": (90, 90)})

    nest = read_dxf(tmp_path, draw)
    assert len(nest.parts[0].marks) >= 3
    assert not why or why in texts(nest.notes)[0]


@pytest.mark.parametrize("at", [1e11, 1e300])
def test_writing_nowhere_near_hides_no_part(tmp_path: Path, at: float) -> None:
    nest = written(tmp_path, "H", insert=(at, 5))
    assert [part.id for part in nest.parts] == ["P1"]
    [said] = texts(nest.notes)
    assert said.startswith("left out, as ")


def test_a_font_of_symbols_is_not_read_as_letters(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.doc.styles.add("sym", font="amgdt.shx")
        space.add_text("n", dxfattribs=MARK | {"style": "sym", "insert": (50, 50)})
        space.add_mtext("{\\Famgdt|c0;n}12", dxfattribs=MARK | {"insert": (90, 50)})

    nest = read_dxf(tmp_path, draw)
    assert nest.parts[0].marks == ()
    assert all("shows signs in the place of letters" in text for text in texts(nest.notes))
    assert len(nest.notes) == 2


def test_writing_on_other_layers_is_said_with_what_engraves_it(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_text("1932", dxfattribs={"insert": (50, 50), "height": 5})
        space.add_text("note", dxfattribs={"layer": "DIM", "insert": (50, 50)})
        space.add_point((60, 60))

    path = save_dxf(tmp_path, draw)
    assert texts(read_drawing(path).notes) == [
        "left out, as layer '0' is not for marks: 1 text ('1932'); --answer text:0=mark engraves it",
        "left out, as layer '0' is not for marks: 1 point; --answer point:0=mark marks it",
    ]
    told = read_drawing(path, answers=(("text:0", "mark"), ("point:0", "mark")))
    assert told.notes == ()
    assert len(told.parts[0].marks) == 5 + 1  # strokes of the number, and the point
    assert reading(told).answers == {"text:0": "mark", "point:0": "mark"}


def test_writing_on_many_layers_is_said_and_answered_at_once(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        for k in range(5):
            space.add_text(f"H{k}", dxfattribs={"layer": f"part {k}", "insert": (50, 50 + 20 * k), "height": 5})

    path = save_dxf(tmp_path, draw)
    assert texts(read_drawing(path).notes) == [
        "left out, as the 5 layers 'part 0', 'part 1', 'part 2', … are not for marks: 5 texts ('H0', 'H1', 'H2', …); "
        "--answer text=mark engraves them"
    ]
    all_but_one = read_drawing(path, answers=(("text", "mark"), ("text:part 3", "ignore")))
    assert [writing.text for writing in reading(all_but_one).writings] == ["H0", "H1", "H2", "H4"]


def test_writing_on_a_layer_for_marks_can_be_left_out(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_text("H", dxfattribs=MARK | {"insert": (50, 50)})

    path = save_dxf(tmp_path, draw)
    assert read_drawing(path, answers=(("text:Gravur", "ignore"),)).parts[0].marks == ()
    with pytest.raises(InputError, match="text:Gravur=no is none of the choices: expected mark, ignore"):
        read_drawing(path, answers=(("text:Gravur", "no"),))


def test_a_profile_says_it_by_layer_or_by_colour(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_text("H", dxfattribs={"color": 5, "insert": (50, 50)})
        space.add_text("H", dxfattribs={"layer": "7", "insert": (90, 50)})

    path = save_dxf(tmp_path, draw)
    assert len(read_drawing(path, layers={"colour": {"blue": "mark"}}).parts[0].marks) == 3
    assert len(read_drawing(path, layers={"mark": "^7$"}).parts[0].marks) == 3


def test_a_point_is_a_cross_of_the_size_of_spots(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_point((60, 70), dxfattribs={"layer": "Körner"})

    nest = read_dxf(tmp_path, draw, spot_mm=3.0)
    assert box(nest) == near(58.5, 68.5, 61.5, 71.5)
    [mark] = nest.parts[0].marks
    assert not mark.curve.closed
    assert "layer 'Körner': marked, by its name (1 point)" in reading(nest).lines()


def test_what_lies_in_waste_is_left_out_and_said(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_text("HH", dxfattribs=MARK | {"height": 21, "insert": (260, 100)})
        space.add_text("far", dxfattribs=MARK | {"height": 5, "insert": (320, 100)})

    nest = read_dxf(tmp_path, draw)
    assert len(nest.parts[0].marks) == 5
    assert texts(nest.notes) == [
        "left out, as it is on no part: the text 'far' at (320.000, 100.000) on layer 'Gravur'",
        "left out, as it lies in waste: the text 'HH' at (260.000, 100.000) on layer 'Gravur': 1 of 6 strokes",
        "P1.mark5 runs off its part",
    ]


def test_writing_that_is_not_shown_is_not_engraved(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        plate(space)
        for layer, hide in (("Gravur off", "off"), ("Gravur frozen", "freeze")):
            getattr(space.doc.layers.add(layer), hide)()
            space.add_text("no", dxfattribs={"layer": layer, "insert": (50, 50), "height": 5})
            space.add_point((60, 60), dxfattribs={"layer": layer})
        space.add_text("no", dxfattribs=MARK | {"insert": (90, 50), "height": 5, "invisible": 1})
        space.doc.layout("Layout1").add_text("no", dxfattribs=MARK | {"insert": (90, 50)})
        space.add_text("   ", dxfattribs=MARK)

    assert read_dxf(tmp_path, draw).parts[0].marks == ()


@pytest.mark.parametrize(("units", "tall"), [(4, 5.0), (1, 127.0), (5, 50.0)])
def test_letters_are_as_tall_as_the_drawing_says_in_its_units(tmp_path: Path, units: int, tall: float) -> None:
    def draw(space: Any) -> None:
        plate(space)
        space.add_text("H", dxfattribs=MARK | {"insert": (50, 50), "height": 5})

    nest = read_dxf(tmp_path, draw, units=units)
    assert box(nest)[3] - box(nest)[1] == pytest.approx(tall)
    assert reading(nest).writings[0].height_mm == pytest.approx(tall)


def test_a_clipped_block_hides_its_writing(tmp_path: Path) -> None:
    from ezdxf.xclip import XClip

    def draw(space: Any) -> None:
        plate(space)
        block = space.doc.blocks.new("tag")
        block.add_text("in", dxfattribs=MARK | {"height": 5})
        block.add_text("out", dxfattribs=MARK | {"height": 5, "insert": (60, 0)})
        clip = XClip(space.add_blockref("tag", (100, 100)))
        clip.set_block_clipping_path([(-5, -5), (30, -5), (30, 30), (-5, 30)])

    nest = read_dxf(tmp_path, draw)
    assert [w.text for w in reading(nest).writings] == ["in"]
    [said] = texts(nest.notes)
    assert said.startswith(
        "left out, as a clipping path hides them, or some of them: 1 on 'Gravur', the first the text 'out'"
    )


def test_the_reading_lists_what_is_written(tmp_path: Path) -> None:
    nest = written(tmp_path, "M8", height=5, insert=(50, 50))
    [row] = json.loads(json.dumps(reading(nest).as_json()))["engraved"]
    names = [mark.id for mark in nest.parts[0].marks]
    assert row == {"text": "M8", "layer": "Gravur", "at": [50.0, 50.0], "height": 5.0, "marks": names}
    assert "layer 'Gravur': marked, by its name (1 text)" in reading(nest).lines()
    assert "marked texts: 'Gravur' (1)" in reading(nest).short()
