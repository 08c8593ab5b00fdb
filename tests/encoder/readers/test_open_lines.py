"""Open lines on layers that are cut: never lost without a word, and nothing beside them is cut through on a guess."""

from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Questions
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_dxf, sheet, square, texts

NAMED = {"cut": "^(0|G2)$"}


def engraved(space: Any) -> None:
    """A part on layer 0, and on layer G2 a line and a circle that a planner means to mark."""
    sheet(space)
    lines(space, square(10, 10, 50))
    space.add_line((20, 20), (30, 20), dxfattribs={"layer": "G2"})
    space.add_circle((45, 45), 3, dxfattribs={"layer": "G2"})


def test_a_circle_beside_an_open_line_is_not_cut_through(tmp_path: Path) -> None:
    with pytest.raises(Questions) as error:
        read_dxf(tmp_path, engraved)
    [question] = error.value.questions
    assert question.id == "layer:G2"
    assert question.text.startswith("layer 'G2' holds 1 open line beside 1 closed one, 1 of them in the metal of parts")
    assert [(choice.value, choice.gives) for choice in question.choices] == [
        ("mark", "1 part, 2 marks (50 × 50 mm), sheet 400 × 300 mm"),
        ("open:mark", "1 part, 1 hole, 1 mark (50 × 50 mm), sheet 400 × 300 mm"),
        ("open:ignore", "1 part, 1 hole (50 × 50 mm), sheet 400 × 300 mm"),
        ("ignore", "1 part (50 × 50 mm), sheet 400 × 300 mm"),
    ]


@pytest.mark.parametrize(
    ("answer", "contours"),
    [
        ("mark", ["P1.mark1", "P1.mark2", "P1.outer"]),
        ("open:mark", ["P1.mark1", "P1.hole1", "P1.outer"]),
        ("open:ignore", ["P1.hole1", "P1.outer"]),
        ("ignore", ["P1.outer"]),
    ],
)
def test_each_answer_does_what_it_says(tmp_path: Path, answer: str, contours: list[str]) -> None:
    nest = read_dxf(tmp_path, engraved, answers=(("layer:G2", answer),))
    assert [c.id for c in nest.contours] == contours


def test_with_repair_a_circle_beside_an_open_line_is_asked_about(tmp_path: Path) -> None:
    with pytest.raises(Questions) as asked:
        read_dxf(tmp_path, engraved, repair=True)
    assert [question.id for question in asked.value.questions] == ["layer:G2"]
    with pytest.raises(InputError, match="1 line does not close to contours") as error:
        read_dxf(tmp_path, engraved, repair=True, open_lines="refuse")
    assert error.value.details[0] == (
        "layer 'G2' holds 1 open line beside 1 closed one, which would be cut through. Say in the profile what it is: "
        "drawing: {layers: {mark: '^G2$'}} marks all of it; with ignore in place of mark it is left out; "
        "drawing: {layers: {cut: '^(0|G2)$'}} cuts what is closed, and marks what is open in a part"
    )


def test_what_the_message_advises_does_it(tmp_path: Path) -> None:
    marked = read_dxf(tmp_path, engraved, layers={"mark": "^G2$"})
    assert [c.id for c in marked.contours] == ["P1.mark1", "P1.mark2", "P1.outer"]
    left_out = read_dxf(tmp_path, engraved, layers={"ignore": "^G2$"})
    assert [c.id for c in left_out.contours] == ["P1.outer"]
    assert texts(left_out.notes) == ["left out, as drawing.layers.ignore matches their layers: 2 on 'G2'"]
    both = read_dxf(tmp_path, engraved, layers=NAMED)
    assert [c.id for c in both.contours] == ["P1.mark1", "P1.hole1", "P1.outer"]
    assert texts(both.notes) == [
        "open on layer 'G2', though the layer is cut, and therefore marked, not cut (drawing.open_lines): 1 line, the "
        "first of 10.000 mm from (20.000, 20.000) to (30.000, 20.000) on layer 'G2'"
    ]


def open_line(space: Any, a: tuple[float, float], b: tuple[float, float]) -> None:
    sheet(space)
    lines(space, square(10, 10, 50))
    space.add_line(a, b)


def test_a_line_in_waste_marks_nothing(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, lambda space: open_line(space, (100, 100), (120, 100)), layers=NAMED)
    assert [c.id for c in nest.contours] == ["P1.outer"]
    assert "left out, for it lies in no part" in texts(nest.notes)[0]


@pytest.mark.parametrize(
    "points",
    [
        [(5, 30), (20, 30)],  # runs over the outline
        [(20, 20), (40, 20), (40, 40), (20, 40), (20, 21)],  # a hole that does not close
    ],
)
def test_what_cannot_be_a_mark_is_refused_on_a_named_layer_too(tmp_path: Path, points: Any) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        lines(space, points, closed=False)

    with pytest.raises(InputError) as error:
        read_dxf(tmp_path, draw, layers=NAMED)
    assert error.value.details[0].startswith("layer '0' holds 1 open line that cannot be marked")


def test_two_halves_of_a_slot_are_no_marks(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        lines(space, [(20, 20), (40, 20), (40, 24)], closed=False)
        lines(space, [(40, 24.5), (20, 24.5), (20, 20.5)], closed=False)

    with pytest.raises(InputError, match="2 lines do not close"):
        read_dxf(tmp_path, draw, layers=NAMED)


def test_open_lines_as_the_profile_says(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        open_line(space, (20, 20), (30, 20))

    ignored = read_dxf(tmp_path, draw, layers=NAMED, open_lines="ignore")
    assert [c.id for c in ignored.contours] == ["P1.outer"]
    assert "and therefore left out (drawing.open_lines): 1 line" in texts(ignored.notes)[0]
    with pytest.raises(InputError) as error:
        read_dxf(tmp_path, draw, layers=NAMED, open_lines="refuse")
    assert error.value.details[0].startswith("layer '0' holds 1 open line, and drawing.open_lines is refuse")


def test_repair_leaves_out_a_stub_but_no_contour_that_is_broken(tmp_path: Path) -> None:
    def stub(space: Any) -> None:
        open_line(space, (60, 60), (60.5, 60.5))

    nest = read_dxf(tmp_path, stub, repair=True)
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes, "repaired")[0].startswith("the open line of 0.707 mm from (60.500, 60.500) to (60.000")

    def tick(space: Any) -> None:  # the circle beside it may be a mark too
        open_line(space, (20, 20), (20.5, 20.5))
        space.add_circle((30, 20), 3)

    with pytest.raises(Questions, match="layer '0' holds 1 open line beside 2 closed ones"):
        read_dxf(tmp_path, tick, repair=True)

    def alone(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        space.add_line((20, 20), (30, 20), dxfattribs={"layer": "G3"})

    assert [c.id for c in read_dxf(tmp_path, alone, repair=True).contours] == ["P1.outer"]
    both = {"cut": "^(0|G3)$"}
    assert [c.id for c in read_dxf(tmp_path, alone, repair=True, layers=both).contours] == ["P1.mark1", "P1.outer"]

    def broken(space: Any) -> None:  # its hole would become a part
        sheet(space)
        lines(space, [(10, 10), (60, 10), (60, 60), (10, 60), (10, 15)], "OUTER", closed=False)
        space.add_circle((35, 35), 5, dxfattribs={"layer": "HOLES"})

    with pytest.raises(Questions, match=r"OUTER=open:close +repaired: 1 gap of up to 5\.000 mm closed: 1 part, 1 hole"):
        read_dxf(tmp_path, broken, repair=True)


def test_a_crumb_is_left_out_and_said(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, lambda space: open_line(space, (80, 60), (80.03, 60.03)))
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes) == [
        "open on layer '0', shorter than drawing.join_tolerance, and therefore left out: 1 line, the first of 0.042 mm "
        "from (80.000, 60.000) to (80.030, 60.030) on layer '0'"
    ]


def test_open_lines_on_the_sheets_layer_burn_nothing(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        space.add_line((0, 290), (400, 290), dxfattribs={"layer": "Plate H300 W400"})

    nest = read_dxf(tmp_path, draw)
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes)[0].startswith("1 open line on the sheet's layer left out, the first of 400.000 mm")


def test_an_outline_of_the_sheet_that_is_open_is_no_sheet(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 200)[:3], "Sheet", closed=False)
        lines(space, square(10, 10, 50))

    with pytest.raises(InputError, match="the sheet does not close, on layer 'Sheet'"):
        read_dxf(tmp_path, draw)


def with_scrap_lines(space: Any) -> None:
    sheet(space)
    lines(space, square(10, 10, 50))
    space.add_line((200, 0), (200, 150), dxfattribs={"layer": "Scrap cuts"})
    space.add_line((200, 150), (200, 300), dxfattribs={"layer": "Scrap cuts"})
    lines(space, square(210, 10, 80), "OFFCUT")


def test_scrap_lines_are_named_and_not_cut(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, with_scrap_lines)
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes) == [
        "left out, as lines that cut up scrap: 4 on 'OFFCUT', 2 on 'Scrap cuts'; drawing: {scrap_lines: cut} has them "
        "cut"
    ]


def test_scrap_lines_are_cut_where_a_profile_says_so(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, with_scrap_lines, scrap_lines="cut")
    assert [(c.id, c.part, c.kind, c.curve.as_rows()) for c in nest.scrap] == [
        ("scrap1", "", "scrap", [[200, 0], [200, 150], [200, 300]])
    ]
    assert [c.id for c in nest.contours] == ["P1.outer", "scrap1"]
    assert texts(nest.notes) == ["left out, as a line that cuts up scrap has two ends, and these close: 1 on 'OFFCUT'"]


def test_a_layer_that_a_profile_says_nothing_of_is_asked_about(tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        read_dxf(tmp_path, engraved, layers={"cut": "^0$"})
    assert error.value.message == (
        "drawing.layers says nothing of some lines: 2 on 'G2'; let cut, mark, ignore, sheet, scrap, bridge or tab "
        "match their layers"
    )
