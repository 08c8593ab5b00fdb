import math

import pytest

from kerfwise.encoder.contour_checks import contour_problems, enclosed, flat, sheet_ring_problems
from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Sheet
from kerfwise.rules.case import circle, part, rect


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
