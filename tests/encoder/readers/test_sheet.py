"""Which sheet a drawing has, and what lies in what."""

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.sheet import choose_sheet, surrounding
from kerfwise.tests.encoder.readers.drawings import square, texts
from kerfwise.tests.encoder.readers.pieces import pieces

PARTS = pieces(square(50, 60, 20), square(80, 60, 20), closed=True)


def test_a_drawn_sheet_with_a_hole() -> None:
    drawn = pieces(square(0, 0, 200), square(150, 150, 20), closed=True)
    sheet, _, notes = choose_sheet(drawn, PARTS, None, ReadOptions())
    assert sheet.bounds == (0, 0, 200, 200)
    assert sheet.polygon.area == 40_000 - 400
    assert notes == []


def test_a_sheet_drawn_twice_is_one() -> None:
    drawn = pieces(square(0, 0, 200), square(0, 0, 200)[::-1], closed=True)
    assert choose_sheet(drawn, PARTS, None, ReadOptions())[0].bounds == (0, 0, 200, 200)


def test_two_sheets_are_refused() -> None:
    drawn = pieces(square(0, 0, 200), square(300, 0, 200), closed=True)
    with pytest.raises(InputError, match="2 sheets are drawn") as error:
        choose_sheet(drawn, PARTS, None, ReadOptions())
    assert error.value.details == ("at (0.000, 0.000) on layer '0'", "at (300.000, 0.000) on layer '0'")


def test_a_given_size_takes_the_place_of_a_drawn_sheet_and_that_is_said() -> None:
    drawn = pieces(square(5, 0, 200), closed=True)
    sheet, why, notes = choose_sheet(drawn, PARTS, None, ReadOptions(sheet_size_mm=(500, 300)))
    assert (sheet.bounds, sheet.stated, why) == ((5, 0, 505, 300), True, "as given (--sheet, in Python sheet_mm=)")
    assert texts(notes) == [
        "--sheet (in Python: sheet_mm) takes the place of the file's sheet of 200 × 200 mm: 500 × 300 mm from (5, 0)"
    ]


def test_a_part_at_the_edge_of_a_given_sheet_gets_room_to_be_cut() -> None:
    at_zero = pieces(square(0, 0, 50), closed=True)
    sheet, _, notes = choose_sheet([], at_zero, None, ReadOptions(sheet_size_mm=(500, 300)))
    assert (sheet.bounds, sheet.stated) == ((-10, -10, 490, 290), False)
    assert texts(notes) == [
        "the parts touch the edge of (0, 0)…(500, 300): the sheet is laid around them, from (-10, -10)"
    ]
    tight = choose_sheet([], at_zero, None, ReadOptions(sheet_size_mm=(50, 50)))[0]
    assert tight.bounds == (0, 0, 50, 50)


def test_a_page_that_was_fitted_to_the_drawing_is_no_sheet() -> None:
    fitted = Sheet.rectangle(50, 50)
    sheet, why, _ = choose_sheet([], pieces(square(0, 0, 50), closed=True), fitted, ReadOptions())
    assert (sheet.bounds, why) == ((-10, -10, 60, 60), "the parts' bounding box and 10 mm around it")


def test_a_given_size_lies_at_the_origin_where_the_parts_are() -> None:
    sheet, _, notes = choose_sheet([], PARTS, None, ReadOptions(sheet_size_mm=(100, 80)))
    assert (sheet.bounds, sheet.stated, notes) == ((0, 0, 100, 80), True, [])


def test_a_given_size_is_laid_around_parts_that_lie_elsewhere() -> None:
    sheet, _, notes = choose_sheet([], PARTS, None, ReadOptions(sheet_size_mm=(90, 24)))
    assert sheet.bounds == (40, 58, 130, 82)
    assert not sheet.stated
    assert texts(notes) == ["the parts do not lie in (0, 0)…(90, 24): the sheet is laid around them, from (40, 58)"]


def test_a_size_too_small_for_the_parts_stays_at_the_origin() -> None:
    assert choose_sheet([], PARTS, None, ReadOptions(sheet_size_mm=(40, 24)))[0].bounds == (0, 0, 40, 24)


def test_the_page_is_the_sheet_if_it_holds_the_parts() -> None:
    sheet, _, [note] = choose_sheet([], PARTS, Sheet.rectangle(210, 297), ReadOptions())
    assert sheet.bounds == (0, 0, 210, 297)
    assert not sheet.stated
    assert "the page, 210 × 297 mm, is taken for it" in note.text
    assert choose_sheet([], PARTS, Sheet.rectangle(90, 297), ReadOptions())[0].bounds == (40, 50, 110, 90)


def test_the_bounding_box_is_the_last_resort() -> None:
    sheet, _, [note] = choose_sheet([], PARTS, None, ReadOptions(margin_mm=5))
    assert sheet.bounds == (45, 55, 105, 85)
    assert not sheet.stated
    assert "bounding box and 5 mm around it, 60 × 30 mm" in note.text


def test_a_given_size_that_is_that_of_the_drawn_sheet_needs_no_word() -> None:
    drawn = pieces(square(0, 0, 200), closed=True)
    assert choose_sheet(drawn, PARTS, None, ReadOptions(sheet_size_mm=(200, 200.4)))[2] == []


def test_depth_and_the_ring_around() -> None:
    areas = [
        shapely.box(20, 20, 30, 30),
        shapely.box(0, 0, 100, 100),
        shapely.box(10, 10, 40, 40),
        shapely.box(60, 60, 70, 70),
    ]
    depth, parent = surrounding(areas)
    assert depth.tolist() == [2, 0, 1, 1]
    assert parent.tolist() == [2, -1, 1, 1]


def test_areas_that_touch_lie_beside_each_other() -> None:
    depth, _ = surrounding([shapely.box(0, 0, 10, 10), shapely.box(10, 0, 20, 10)])
    assert depth.tolist() == [0, 0]


def test_a_hole_that_touches_its_outline_lies_in_it() -> None:
    depth, _ = surrounding([shapely.box(0, 0, 10, 10), shapely.box(0, 0, 5, 5)])
    assert depth.tolist() == [0, 1]


def test_an_empty_area_lies_nowhere() -> None:
    depth, parent = surrounding([shapely.box(0, 0, 10, 10), shapely.Polygon()])
    assert (depth.tolist(), parent.tolist()) == ([0, 0], [-1, -1])


@given(st.permutations(range(6)))
def test_rings_in_rings_in_any_order(order: list[int]) -> None:
    depth, parent = surrounding([shapely.box(k, k, 20 - k, 20 - k) for k in order])
    assert depth.tolist() == order
    assert [order[p] if p >= 0 else -1 for p in parent.tolist()] == [k - 1 for k in order]
