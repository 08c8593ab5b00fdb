import pytest

from kerfwise.encoder.contour_checks import coincident, drop_duplicates
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Part
from kerfwise.rules.case import circle, part, rect


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
