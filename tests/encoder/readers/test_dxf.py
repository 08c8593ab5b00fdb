"""DXF files as a whole: units, layers, damage."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Questions
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_drawing, read_dxf, save_dxf, sheet, square, texts


def one_part(space: Any) -> None:
    sheet(space)
    lines(space, square(10, 10, 50))


@pytest.mark.parametrize(("code", "side"), [(4, 400), (5, 4000), (1, 400 * 25.4), (0, 400)])
def test_units_come_from_the_header(tmp_path: Path, code: int, side: float) -> None:
    nest = read_dxf(tmp_path, one_part, units=code)
    assert nest.sheet.bounds[2] == pytest.approx(side)
    assert nest.notes == ()


def test_units_can_be_overridden(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, one_part, units=1)
    assert read_drawing(path, units="cm").sheet.bounds[2] == 4000


def units_asked(path: Path) -> list[str]:
    with pytest.raises(Questions) as error:
        read_drawing(path, frame="part")
    [question] = error.value.questions
    assert question.id == "units"
    return [choice.value for choice in question.choices]


def test_an_implausible_size_is_asked_about(tmp_path: Path) -> None:
    assert units_asked(save_dxf(tmp_path, one_part, units=6)) == ["mm", "in", "cm", "m"]


def test_an_unknown_unit_is_asked_about_where_it_may_be_inches(tmp_path: Path) -> None:
    def small(space: Any) -> None:
        lines(space, square(0, 0, 48))

    path = save_dxf(tmp_path, small, units=3)
    assert units_asked(without(path, "$MEASUREMENT")) == ["mm", "in"]
    assert read_drawing(path, units="mm").parts[0].polygon.bounds[2] == 48


def without(path: Path, name: str) -> Path:
    """The file without a variable of its header."""
    text = path.read_text()
    at = text.index(f"  9\n{name}\n")
    path.write_text(text[:at] + text[text.index("  9\n", at + 4) :])
    return path


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ({"$INSUNITS": 0, "$MEASUREMENT": 0}, ["in", "mm"]),
        ({"$INSUNITS": 0, "$MEASUREMENT": 1, "$LUNITS": 4}, None),
        ({"$INSUNITS": 0, "$MEASUREMENT": 0, "$LUNITS": 4}, ["in", "mm"]),
        ({"$INSUNITS": 4, "$LUNITS": 4}, ["mm", "in"]),
        ({"$INSUNITS": 4, "$MEASUREMENT": 0}, None),
        ({"$INSUNITS": 1, "$MEASUREMENT": 1}, None),
    ],
)
def test_what_the_header_says_and_what_it_contradicts(
    tmp_path: Path, header: dict[str, int], expected: list[str] | None
) -> None:
    import ezdxf

    document = ezdxf.new("R2010")
    lines(document.modelspace(), square(0, 0, 48))
    for name, value in header.items():
        document.header[name] = value
    path = tmp_path / "drawing.dxf"
    document.saveas(path)
    if expected is None:
        assert read_drawing(path).parts
    else:
        assert units_asked(path) == expected


def test_a_file_without_header_is_in_mm(tmp_path: Path) -> None:
    path = tmp_path / "bare.dxf"
    body = ["0", "SECTION", "2", "ENTITIES"]
    for (x0, y0), (x1, y1) in zip(square(0, 0, 30), square(0, 0, 30)[1:] + square(0, 0, 30)[:1], strict=True):
        body += ["0", "LINE", "8", "0", "10", str(x0), "20", str(y0), "11", str(x1), "21", str(y1)]
    path.write_text("\n".join([*body, "0", "ENDSEC", "0", "EOF", ""]))
    assert units_asked(path) == ["mm", "in"]
    assert areas(read_drawing(path, units="mm")) == {"P1.outer": 900}


@pytest.mark.parametrize("version", ["R12", "R2000", "R2007", "R2018"])
def test_every_version_of_the_format(tmp_path: Path, version: str) -> None:
    def draw(space: Any) -> None:
        lines(space, square(10, 10, 50))
        space.add_circle((35, 35), 10)

    nest = read_drawing(save_dxf(tmp_path, draw, version=version), frame="part", units="mm")
    assert [c.id for c in nest.contours] == ["P1.hole1", "P1.outer"]


def test_binary_dxf(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, one_part)
    import ezdxf

    ezdxf.readfile(path).saveas(path, fmt="bin")
    assert path.read_bytes().startswith(b"AutoCAD Binary DXF")
    assert areas(read_drawing(path)) == {"P1.outer": 2500}


def test_sheet_and_marks_by_layer(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        space.add_line((20, 20), (40, 20), dxfattribs={"layer": "Engraving"})
        space.add_circle((40, 40), 5, dxfattribs={"layer": "SCRIBE"})

    nest = read_dxf(tmp_path, draw)
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.mark2", "P1.outer"]
    assert [c.curve.closed for c in nest.parts[0].marks] == [True, False]
    assert nest.sheet.bounds == (0, 0, 400, 300)


def test_layers_by_the_plants_own_names(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 200), layer="BLECH")
        lines(space, square(10, 10, 50), layer="PLATES")
        space.add_line((20, 20), (40, 20), dxfattribs={"layer": "Körner"})

    nest = read_dxf(tmp_path, draw, layers={"sheet": "^blech$", "mark": "körner"})
    assert nest.sheet.bounds == (0, 0, 200, 200)
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.outer"]
    assert texts(nest.notes) == [
        "layer 'PLATES' is cut, though it sounds like the sheet: drawing.layers.sheet does not match it"
    ]


def test_a_layer_that_sounds_like_the_sheet_and_is_all_there_is_is_asked_about(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 200), layer="PLATE 8")

    with pytest.raises(Questions) as error:
        read_dxf(tmp_path, draw)
    [question] = error.value.questions
    assert (question.id, question.choices[0].value) == ("layer:PLATE 8", "cut")
    assert areas(read_dxf(tmp_path, draw, answers=(("layer:PLATE 8", "cut"),))) == {"P1.outer": 40_000}
    with pytest.raises(InputError, match="nothing to cut: every line is on a layer that is not cut"):
        read_dxf(tmp_path, draw, answers=(("layer:PLATE 8", "ignore"),))


def test_an_empty_drawing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to cut: the drawing holds no line"):
        read_dxf(tmp_path, lambda space: space.add_text("nothing"))


def test_open_lines_are_listed_in_one_error(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        lines(space, [(100, 100), (150, 100), (150, 150), (100, 100.4)], closed=False)
        lines(space, [(300, 100), (350, 100)], closed=False, layer="CUT")

    with pytest.raises(InputError, match="2 lines do not close to contours") as error:
        read_dxf(tmp_path, draw, open_lines="refuse")
    of_layer_0, of_layer_cut, first, _ = error.value.details
    assert of_layer_0.startswith("layer '0' holds 1 open line beside 1 closed one, which would be cut through. Say in ")
    assert of_layer_cut.startswith("layer 'CUT' holds 1 open line and nothing closed.")
    assert "raise drawing.join_tolerance over 0.400 mm" in first


def test_an_open_line_in_waste_is_asked_about(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        lines(space, [(300, 100), (350, 100)], closed=False, layer="CUT")

    with pytest.raises(Questions) as error:
        read_dxf(tmp_path, draw)
    [question] = error.value.questions
    assert [choice.value for choice in question.choices] == ["ignore", "mark", "scrap"]
    assert "layer 'CUT' holds 1 open line and nothing closed, none of them in the metal of a part" in question.text
    assert areas(read_dxf(tmp_path, draw, answers=(("layer:CUT", "ignore"),))) == {"P1.outer": 2500}


def test_repair_closes_and_drops_and_says_each(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        lines(space, [(100, 100), (150, 100), (150, 150), (100, 100.4)], closed=False)
        lines(space, [(300, 100), (350, 100)], closed=False, layer="CUT")
        space.add_line((5, 5), (5, 5))
        space.add_line((10, 10), (60, 10))

    nest = read_dxf(tmp_path, draw, repair=True)
    assert [c.id for c in nest.contours] == ["P1.outer", "P2.outer"]
    assert texts(nest.notes, "repaired") == [
        "a gap of 0.400 mm at (100.000, 100.200) is closed",
        "the line of 50.000 mm from (10.000, 10.000) to (60.000, 10.000) on layer '0' is drawn twice; it is cut once",
        "the line at (5.000, 5.000) on layer '0' has no length: left out",
        "the open line of 50.000 mm from (300.000, 100.000) to (350.000, 100.000) on layer 'CUT' is left out: "
        "it does not close",
    ]


def test_a_line_drawn_twice_is_cut_once_and_said(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        space.add_line((20, 10), (40, 10))

    nest = read_dxf(tmp_path, draw)
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes, "warning") == [
        "the line of 20.000 mm from (20.000, 10.000) to (40.000, 10.000) on layer '0' is drawn twice; it is cut once"
    ]


def test_parts_that_touch_are_named(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        lines(space, square(60, 10, 50))

    [note] = read_dxf(tmp_path, draw).notes
    assert note.contours == ("P1.outer", "P2.outer")
    assert note.text == "P1.outer and P2.outer touch: parts P1 and P2 leave no room for the kerf between them"


def test_a_file_that_breaks_off(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, one_part)
    data = path.read_bytes()
    path.write_bytes(data[: data.rindex(b"LINE")])
    with pytest.raises(InputError, match="the DXF file breaks off: its end mark EOF is missing"):
        read_drawing(path)


def test_repair_reads_a_broken_file_as_far_as_it_goes(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, one_part)
    data = path.read_bytes()
    path.write_bytes(data[: data.rindex(b"EOF")])
    notes = read_drawing(path, repair=True).notes
    assert texts(notes, "repaired") == ["the DXF file breaks off before its end mark EOF: read as far as it goes"]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"AC1032\0\0\0\0\0", "this is a DWG file under another name"),
        (bytes(range(256)) * 40, "its end mark EOF is missing"),
        (b"\x89PNG" + bytes(range(256)) * 40 + b"EOF", "not a DXF file that can be read"),
        (b"hello\nEOF\n", "not a DXF file that can be read"),
        (b"0\nEOF\n", "nothing to cut"),
    ],
)
def test_what_is_no_dxf(tmp_path: Path, data: bytes, said: str) -> None:
    path = tmp_path / "broken.dxf"
    path.write_bytes(data)
    with pytest.raises(InputError, match=said) as error:
        read_drawing(path)
    assert error.value.file == path


def test_a_sheet_too_small_for_its_part(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="1 problem") as error:
        read_dxf(tmp_path, lambda s: lines(s, square(0, 0, 70)), sheet_mm=(50, 100))
    assert error.value.details[0].startswith("P1.outer reaches 20.000 mm off the sheet at ")


@pytest.mark.slow
def test_remarks_of_the_dxf_library_stay_off_the_terminal(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, lambda s: lines(s, square(10, 10, 50)), version="R12")
    path.write_text(path.read_text().replace("LINE\n", "LINE\n  5\nno handle\n"))
    script = "import sys, kerfwise\nprint(len(kerfwise.read_nest(sys.argv[1], units='mm').parts))"
    run = subprocess.run([sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True)
    assert (run.stdout, run.stderr) == ("1\n", "")
