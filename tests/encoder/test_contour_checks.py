"""Contours by themselves: rings that are none, holes that reach out, lines drawn twice, the metal of a part."""

import math

import pytest

from kerfwise import InputError
from kerfwise.encoder.contour_checks import (
    coincident,
    contour_problems,
    drop_duplicates,
    enclosed,
    flat,
    hole_problems,
    mark_notes,
    metal_of,
    sheet_ring_problems,
)
from kerfwise.encoder.errors import REPAIR
from kerfwise.rule_kit import Curve, Part, Sheet, circle, part, rect


def dropped(*parts: Part) -> tuple[list[str], list[str]]:
    left, notes = drop_duplicates(parts)
    return [c.id for p in left for c in p], [n.text for n in notes]


@pytest.mark.parametrize(
    ("other", "same"),
    [
        ([(9, 9), (0, 9), (0, 0), (9, 0)], True),  # starts elsewhere
        ([(0, 9), (9, 9), (9, 0), (0, 0)], True),  # the other way round
        ([(0, 0), (5, 0), (9, 0), (9, 9), (0, 9)], True),  # one vertex more
        ([(0, 0), (9, 0.01), (9, 9), (0, 9)], True),  # within rounding
        ([(0, 0), (9, 0.05), (9, 9), (0, 9)], False),
        ([(0, 0), (9, 0), (9, 9), (4, 4), (0, 9)], False),  # the same box, another shape
        ([(0, 0), (9, 0, 0.1), (9, 9), (0, 9)], False),
    ],
)
def test_which_rings_are_one_line(other: list[tuple[float, ...]], same: bool) -> None:
    pairs = coincident([Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)]), Curve.of(other)])
    assert pairs == ([(0, 1)] if same else [])


def test_a_circle_may_start_anywhere() -> None:
    turned = [(50, 80, 1), (50, 20, 1)]
    assert coincident([Curve.of(circle(50, 50, 30)), Curve.of(turned)]) == [(0, 1)]


def test_nothing_and_points_coincide_with_nothing() -> None:
    assert coincident([]) == []
    assert coincident([Curve.of([(1, 1)]), Curve.of([(1, 1)])]) == []


def test_without_repeats_nothing_is_dropped() -> None:
    given = part("A", rect(0, 0, 50, 50), [circle(25, 25, 10)])
    assert drop_duplicates([given]) == ((given,), [])


def test_a_hole_that_is_the_outline_of_a_part_in_another_hole() -> None:
    host = part("H", rect(0, 0, 100, 100), [rect(10, 10, 60, 60), rect(20, 20, 30, 30), circle(85, 85, 5)])
    ids, notes = dropped(host, part("G", rect(20, 20, 30, 30)))
    assert ids == ["H.hole1", "H.hole3", "H.outer", "G.outer"]
    assert notes == ["H.hole2 is the same line as G.outer; it is cut once, as G.outer"]


def test_the_same_in_the_other_order_of_the_file() -> None:
    host = part("H", rect(0, 0, 100, 100), [rect(20, 20, 30, 30), rect(10, 10, 60, 60)])
    ids, notes = dropped(part("G", rect(20, 20, 30, 30)), host)
    assert ids == ["G.outer", "H.hole2", "H.outer"]
    assert notes == ["H.hole1 is the same line as G.outer; it is cut once, as G.outer"]


def test_only_a_line_of_two_parts_is_a_common_one() -> None:
    host = part("H", rect(0, 0, 100, 100), [rect(10, 10, 80, 80), rect(20, 20, 30, 30)])
    again = part("A", rect(200, 0, 50, 50), [circle(225, 25, 10), circle(225, 25, 10)])
    _, notes = drop_duplicates([host, part("G", rect(20, 20, 30, 30)), again])
    assert [(note.contours, note.common) for note in notes] == [
        (("H.hole2", "G.outer"), True),
        (("A.hole2", "A.hole1"), False),
    ]


def test_a_part_that_fills_a_hole_keeps_both_lines() -> None:
    ids, notes = dropped(part("H", rect(0, 0, 100, 100), [rect(20, 20, 30, 30)]), part("G", rect(20, 20, 30, 30)))
    assert (ids, notes) == (["H.hole1", "H.outer", "G.outer"], [])


def test_a_hole_and_a_mark_drawn_twice() -> None:
    line = [(60, 60), (70, 60)]
    twice = part("A", rect(0, 0, 100, 100), [circle(25, 25, 10), circle(25, 25, 10)], [line, line[::-1]])
    ids, notes = dropped(twice)
    assert ids == ["A.mark1", "A.hole1", "A.outer"]
    assert notes == [
        "A.hole2 is the same line as A.hole1; it is cut once, as A.hole1",
        "A.mark2 is the same line as A.mark1; it is cut once, as A.mark1",
    ]


def test_a_whole_part_drawn_twice() -> None:
    first = part("A", rect(0, 0, 50, 50), [circle(25, 25, 10)])
    again = part("B", rect(0, 0, 50, 50), [circle(25, 25, 10)])
    ids, notes = dropped(first, again)
    assert ids == ["A.hole1", "A.outer"]
    assert notes == ["part B is the same as part A, in the same place; it is cut once, as A"]


def test_different_parts_in_one_place_are_left_to_the_checks() -> None:
    ids, _ = dropped(part("A", rect(0, 0, 50, 50)), part("B", rect(0, 0, 50, 50), [circle(25, 25, 10)]))
    assert ids == ["A.outer", "B.hole1", "B.outer"]


def test_too_many_lines_in_one_place_are_refused_before_they_are_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    square = Curve.of([(10, 20), (19, 20), (19, 29), (10, 29)])
    monkeypatch.setattr("kerfwise.encoder.contour_checks.MOST_ALIKE", 3)
    assert len(coincident([square] * 3 + [square.moved(5, 0)] * 3)) == 6
    with pytest.raises(InputError, match=r"4 lines lie on each other at \(10\.000, 20\.000\), and at most 3 are"):
        coincident([square] * 4)


def found(given: Part) -> tuple[list[str], list[str]]:
    problems, notes = hole_problems([given])
    return problems, [n.text for n in notes]


PLATE = rect(0, 0, 100, 100)


def test_holes_in_their_part_and_apart() -> None:
    assert found(part("A", PLATE, [circle(25, 25, 10), circle(60, 25, 10)])) == ([], [])
    assert hole_problems([]) == ([], [])


def test_a_hole_outside_and_one_half_out() -> None:
    problems, _ = found(part("A", PLATE, [rect(110, 0, 10, 10), rect(90, 50, 20, 10)]))
    assert problems == [
        "A.hole1 reaches out of A.outer at (115.000, 5.000): correct the part in CAD",
        "A.hole2 reaches out of A.outer at (105.000, 55.000): correct the part in CAD",
    ]


def test_holes_that_overlap_or_lie_in_each_other() -> None:
    problems, _ = found(part("A", PLATE, [rect(10, 10, 40, 40), rect(20, 20, 10, 10), rect(45, 20, 10, 10)]))
    assert [p.split(" at ")[0] for p in problems] == ["A.hole1 overlaps A.hole2", "A.hole1 overlaps A.hole3"]


def test_touching_is_only_noted() -> None:
    assert found(part("A", PLATE, [rect(0, 10, 40, 40), rect(40, 20, 10, 10)])) == (
        [],
        ["A.hole1 touches A.outer", "A.hole1 touches A.hole2"],
    )


def test_holes_of_different_parts_are_none_of_each_others_business() -> None:
    problems, notes = hole_problems([part("A", PLATE, [circle(25, 25, 10)]), part("B", PLATE, [circle(25, 25, 10)])])
    assert (problems, notes) == ([], [])


def test_marks_that_run_off_the_metal() -> None:
    inside, over_the_edge, over_a_hole = [(5, 5), (9, 9)], [(90, 90), (101, 90)], [(15, 50), (60, 50)]
    given = part("A", PLATE, [circle(50, 50, 10)], [inside, over_the_edge, over_a_hole])
    assert [n.text for n in mark_notes([given])] == ["A.mark2 runs off its part", "A.mark3 runs off its part"]
    assert mark_notes([part("A", PLATE)]) == []
    [note] = mark_notes([part("A", PLATE, [circle(50, 50, 10)], [over_the_edge] * 5)])
    assert note.text == "5 marks run off their parts: A.mark1, A.mark2, A.mark3, …"
    assert len(note.contours) == 5


def test_a_hole_that_reaches_out_adds_no_metal() -> None:
    sound = part("A", rect(0, 0, 50, 50), [rect(10, 10, 10, 10)])
    reaching = part("B", rect(0, 0, 50, 50), [rect(45, 10, 20, 10)])
    nested = part("C", rect(0, 0, 50, 50), [rect(10, 10, 20, 20), rect(15, 15, 5, 5)])
    flat = part("D", [(0, 0), (50, 0)])
    flat_hole = part("E", rect(0, 0, 50, 50), [[(5, 5), (9, 9)]])
    assert [round(m.area, 6) for m in metal_of([sound, reaching, nested, flat, flat_hole])] == [
        2400,
        2450,
        2100,
        0,
        2500,
    ]


@pytest.mark.parametrize(
    ("rows", "is_flat"),
    [
        ([(0, 0), (10, 0)], True),
        ([(3, 3)], True),
        ([(0, 0), (10, 0), (20, 0)], True),
        ([(0, 0), (10, 0), (10, 0.005)], True),
        ([(0, 0), (10, 0), (10, 0.05)], False),
        ([(0, 0, 0.5), (10, 0, -0.5)], True),  # there and back along the same arc
        ([(0, 0, 1), (10, 0, 1)], False),
        ([(0, 0), (10, 10), (10, 0), (0, 10)], False),  # a bow tie crosses itself, but encloses metal
    ],
)
def test_what_encloses_nothing(rows: list[tuple[float, ...]], is_flat: bool) -> None:
    assert flat(Curve.of(rows)) is is_flat


def test_the_area_enclosed() -> None:
    assert enclosed(Curve.of([(0, 0), (10, 0)])).is_empty
    assert enclosed(Curve.of([(0, 0), (10, 10), (10, 0), (0, 10)])).area == 50
    assert enclosed(Curve.of(circle(0, 0, 10))).area == pytest.approx(math.pi * 100, rel=2e-3)


def test_sound_contours_have_no_problems() -> None:
    assert contour_problems(list(part("A", rect(0, 0, 9, 9), [circle(5, 5, 2)], [[(1, 1), (2, 2)]]))) == {}


def test_each_fault_is_placed_and_says_what_to_do() -> None:
    bow_tie, touching = [(0, 0), (10, 10), (10, 0), (0, 10)], [(0, 0), (9, 0), (9, 9), (4, 0), (0, 9)]
    faulty = part("A", bow_tie, [touching, [(1, 1), (2, 2)]], [[(7, 7), (7, 7)]])
    assert contour_problems(list(faulty)) == {
        "A.mark1": f"A.mark1 has no length, at (7.000, 7.000): remove it, or try {REPAIR}, which removes it",
        "A.hole1": "A.hole1 touches itself at (4.000, 0.000): correct it in CAD",
        "A.hole2": f"A.hole2 encloses no area, at (1.000, 1.000): remove it, or try {REPAIR}, which removes it",
        "A.outer": "A.outer crosses itself at (5.000, 5.000): correct it in CAD",
    }


def test_arcs_that_cross_are_seen() -> None:
    shallow, deep = [(0, 0), (10, 0), (10, 6, -1), (0, 6)], [(0, 0), (10, 0), (10, 2, -1), (0, 2)]
    assert contour_problems(list(part("A", shallow))) == {}
    assert list(contour_problems(list(part("A", deep)))) == ["A.outer"]


def test_the_sheet_itself() -> None:
    outline = Curve.of(rect(0, 0, 100, 50))
    assert sheet_ring_problems(Sheet(outline, (Curve.of(rect(5, 5, 9, 9)),))) == []
    assert sheet_ring_problems(Sheet(Curve.of([(0, 0), (9, 0)]), (Curve.of([(0, 0), (9, 9), (9, 0), (0, 9)]),))) == [
        "the sheet's outline encloses no area, at (0.000, 0.000): draw the sheet again",
        "the sheet's hole 1 crosses itself at (4.500, 4.500): draw the sheet again",
    ]
    [said] = sheet_ring_problems(Sheet(outline, (Curve.of(rect(90, 5, 20, 9)),)))
    assert said.startswith("the sheet's holes overlap or reach out of it")


def test_a_ring_that_crosses_itself_too_often_is_refused_before_it_is_mended(monkeypatch: pytest.MonkeyPatch) -> None:
    star = Curve.of([(100 * math.cos(math.tau * k * 5 / 11), 100 * math.sin(math.tau * k * 5 / 11)) for k in range(11)])
    monkeypatch.setattr("kerfwise.encoder.contour_checks.MOST_MEETINGS", 44)
    assert enclosed(star).area > 0
    monkeypatch.setattr("kerfwise.encoder.contour_checks.MOST_MEETINGS", 43)
    with pytest.raises(InputError, match=r"the ring that starts at \(100\.000, 0\.000\) crosses .* more than 43 times"):
        enclosed(star)
