import pytest

from kerfwise.encoder.readers.read import repair_contours
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.encoder.readers.drawings import texts

DENT = [(0, 0), (100, 0), (100, 100), (50, 100), (51, 101), (49, 101), (50, 100), (0, 100)]


def test_a_sound_nest_is_left_alone() -> None:
    given = nest(200, 200, part("A", rect(0, 0, 50, 50), [circle(25, 25, 10)], [[(5, 5), (9, 9)]]))
    after = repair_contours(given)
    assert after.notes == ()
    assert [c.curve for c in after.contours] == [c.curve for c in given.contours]


def test_a_small_loop_is_cut_off() -> None:
    after = repair_contours(nest(200, 200, part("A", DENT)))
    assert after.contour("A.outer").polygon.is_valid
    assert after.contour("A.outer").polygon.area == pytest.approx(10_000, abs=2)
    [note] = after.notes
    assert (note.severity, note.contours) == ("repaired", ("A.outer",))
    assert note.text.startswith("A.outer crossed itself (")


def test_a_bow_tie_is_left_to_the_checks() -> None:
    after = repair_contours(nest(200, 200, part("A", [(0, 0), (100, 100), (100, 0), (0, 100)])))
    assert not after.contour("A.outer").polygon.is_valid
    assert after.notes == ()


def test_the_arcs_of_a_mended_ring_stay_few() -> None:
    slot = [(0, 0), (50, 0), (51, -1), (49, -1), (50, 0), (100, 0, 1), (100, 40), (0, 40, 1)]
    ring = repair_contours(nest(300, 300, part("A", slot))).contour("A.outer").curve
    assert ring.polygon().is_valid
    assert len(ring.segments) < 20


def test_what_encloses_nothing_is_left_out() -> None:
    line, dot = [(5, 5), (9, 9)], [(7, 7), (7, 7)]
    after = repair_contours(
        nest(200, 200, part("A", rect(0, 0, 50, 50), [line, rect(20, 20, 5, 5)], [dot]), part("B", line))
    )
    assert [c.id for c in after.contours] == ["A.hole2", "A.outer"]
    assert texts(after.notes) == [
        "A.mark1 encloses nothing, at (7.000, 7.000): left out",
        "A.hole1 encloses nothing, at (5.000, 5.000): left out",
        "B.outer encloses nothing, at (5.000, 5.000): left out",
    ]


def test_a_flat_part_that_holds_something_is_left_to_the_checks() -> None:
    after = repair_contours(nest(200, 200, part("A", [(0, 0), (50, 0)], [rect(20, 20, 5, 5)])))
    assert [c.id for c in after.contours] == ["A.hole1", "A.outer"]
