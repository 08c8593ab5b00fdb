"""Open lines that a person would close: over gaps, past corners, along other lines, along the edges of parts."""

from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Nest, Questions
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_dxf, sheet, square, texts

Ends = tuple[tuple[float, float], tuple[float, float]]


def drawn(*ends: Ends) -> Any:
    """A sheet, a part of 50 × 50 mm at (10, 10), and these lines."""

    def draw(space: Any) -> None:
        sheet(space)
        lines(space, square(10, 10, 50))
        for one, other in ends:
            space.add_line(one, other)

    return draw


def asked(folder: Path, draw: Any, **options: Any) -> dict[str, list[str]]:
    with pytest.raises(Questions) as error:
        read_dxf(folder, draw, **options)
    return {question.id: [choice.value for choice in question.choices] for question in error.value.questions}


def answered(folder: Path, draw: Any, answer: str, **options: Any) -> Nest:
    return read_dxf(folder, draw, answers=(("layer:0", answer),), **options)


OVERRUN: tuple[Ends, ...] = (
    ((100, 100), (200.3, 100)),
    ((200, 99.8), (200, 160)),
    ((200.4, 160), (100, 160)),
    ((100, 160.2), (100, 99.5)),
)


def test_corners_that_overrun_are_cut_back(tmp_path: Path) -> None:
    draw = drawn(*OVERRUN)
    assert asked(tmp_path, draw)["layer:0"][0] == "open:close"
    for nest in (answered(tmp_path, draw, "open:close"), read_dxf(tmp_path, draw, repair=True)):
        assert areas(nest) == {"P1.outer": 2500, "P2.outer": 6000}
        assert nest.contour("P2.outer").curve.as_rows()[0] == [100, 100]
        assert [text for text in texts(nest.notes, "repaired") if "0.500 mm past their corner at (100.000, 100" in text]


def test_an_overrun_that_is_no_longer_than_the_tolerance_needs_no_word(tmp_path: Path) -> None:
    nest = read_dxf(tmp_path, drawn(*OVERRUN), join_tolerance="0.6 mm")
    assert areas(nest) == {"P1.outer": 2500, "P2.outer": 6000}
    assert texts(nest.notes) == []


def test_an_arc_that_overruns_is_cut_back_where_it_crosses(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        sheet(space)
        space.add_arc((100, 100), 30, -0.5, 180.5)
        space.add_line((69.9, 100), (130.2, 100))

    assert areas(read_dxf(tmp_path, draw, repair=True))["P1.outer"] == pytest.approx(1413.717, abs=0.01)


@pytest.mark.parametrize(("gap", "closed"), [(0.5, True), (4.0, True), (30.0, False)])
def test_a_gap_is_asked_about_up_to_a_tenth_of_the_line(tmp_path: Path, gap: float, closed: bool) -> None:
    draw = drawn(*zip([(100, 100), (200, 100), (200, 160)], [(200, 100), (200, 160), (100 + gap, 160)], strict=True))

    def side(space: Any) -> None:
        draw(space)
        space.add_line((100, 160), (100, 100))

    if closed:
        assert asked(tmp_path, side)["layer:0"][0] == "open:close"
        assert areas(answered(tmp_path, side, "open:close")) == {"P1.outer": 2500, "P2.outer": 6000}
    else:
        with pytest.raises(InputError, match="1 line does not close to contours"):
            read_dxf(tmp_path, side)


def test_a_line_that_lies_on_an_outline_is_drawn_twice_and_what_sticks_out_is_asked_about(tmp_path: Path) -> None:
    draw = drawn(((20, 60), (90, 60)))
    with pytest.raises(Questions, match=r"of 30\.000 mm from \(60\.000, 60\.000\) to \(90\.000, 60\.000\)"):
        read_dxf(tmp_path, draw)
    assert areas(answered(tmp_path, draw, "open:ignore")) == {"P1.outer": 2500}
    inside = drawn(((20, 60), (60, 60)), ((60, 20), (60, 30)))
    assert areas(read_dxf(tmp_path, inside)) == {"P1.outer": 2500}


BESIDE: tuple[Ends, ...] = (((60, 20), (100, 20)), ((100, 20), (100, 50)), ((100, 50), (60, 50)))
"""Three sides of a part that shares the fourth with the part of 50 × 50 mm."""


def test_a_part_that_shares_an_edge_is_closed_along_it(tmp_path: Path) -> None:
    draw = drawn(*BESIDE)
    with pytest.raises(Questions, match=r"\(T-junctions\), as where two parts share an edge") as error:
        read_dxf(tmp_path, draw)
    assert [choice.value for choice in error.value.questions[0].choices][:2] == ["open:shared", "open:ignore"]
    nest = answered(tmp_path, draw, "open:shared")
    assert areas(nest) == {"P1.outer": 2500, "P2.outer": 1200}
    assert "1 part that shares an edge with another, the first line from" in texts(nest.notes, "repaired")[0]


def test_a_line_across_a_part_may_divide_it(tmp_path: Path) -> None:
    draw = drawn(((30, 10), (30, 60)))
    assert asked(tmp_path, draw)["layer:0"][0] == "open:mark"
    assert areas(answered(tmp_path, draw, "open:shared")) == {"P1.outer": 1500, "P2.outer": 1000}


def test_three_parts_in_a_row_that_share_two_edges(tmp_path: Path) -> None:
    more: tuple[Ends, ...] = (((100, 30), (130, 30)), ((130, 30), (130, 40)), ((130, 40), (100, 40)))
    nest = answered(tmp_path, drawn(*BESIDE, *more), "open:shared")
    assert sorted(areas(nest).values()) == [300, 1200, 2500]


@pytest.mark.parametrize(
    "ends", [OVERRUN, BESIDE, (((100, 100), (140, 100)), ((140, 100), (140, 140)), ((140, 140), (100, 103)))]
)
def test_repair_never_advises_itself(tmp_path: Path, ends: tuple[Ends, ...]) -> None:
    for options in ({"open_lines": "refuse"}, {}):
        try:
            read_dxf(tmp_path, drawn(*ends), repair=True, **options)
            said = ""
        except InputError as error:
            said = str(error)
        assert "--repair" not in said


def test_leaders_on_a_layer_of_their_own_are_left_out(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        drawn()(space)
        for x, y in ((20, 20), (50, 50)):
            space.add_circle((x, y), 3)
            lines(space, [(x, y), (x + 80, y + 60), (x + 70, y + 20)], "holes and threads", closed=False)

    assert asked(tmp_path, draw)["layer:holes and threads"][0] == "ignore"


def test_a_drawing_far_from_the_origin_is_moved(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for at in (0, 100):
            lines(space, square(4_500_000 + at, 5_900_000, 50))

    nest = read_dxf(tmp_path, draw)
    assert nest.parts[1].polygon.bounds == (100, 0, 150, 50)
    assert texts(nest.notes, "repaired") == ["the drawing begins at (4.5e+06, 5.9e+06) mm: moved to (0, 0)"]

    def stray(space: Any) -> None:
        draw(space)
        lines(space, square(0, 0, 5), "STRAY")

    with pytest.raises(InputError, match=r"farthest from the others lies at \(0\.000, 0\.000\) on layer 'STRAY'"):
        read_dxf(tmp_path, stray)


def test_other_open_lines_stay_what_they_are(tmp_path: Path) -> None:
    """A square with a gap beside a line in waste and one in the metal of a part: none is lost without a word."""
    gap = ((100, 100), (200, 100)), ((200, 100), (200, 160)), ((200, 160), (100, 160)), ((100, 160), (100, 100.4))
    draw = drawn(*gap, ((20, 20), (40, 40)), ((300, 20), (340, 40)))
    with pytest.raises(Questions, match="closed; 2 other open lines marked in metal, left out in waste: 2 parts"):
        read_dxf(tmp_path, draw)
    nest = answered(tmp_path, draw, "open:close")
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.outer", "P2.outer"]
    assert [text for text in texts(nest.notes) if "left out, for it lies in no part: 1 line" in text]
