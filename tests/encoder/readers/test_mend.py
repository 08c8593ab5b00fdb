import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Asking
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.readers.repairs import repaired
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.encoder.readers.drawings import texts

DENT = [(0, 0), (100, 0), (100, 100), (50, 100), (51, 101), (49, 101), (50, 100), (0, 100)]


def repair_contours(drawn: Nest, repair: bool = True, **answers: str) -> Nest:
    return repaired(drawn, ReadOptions(repair=repair), Asking(answers))


def asked(drawn: Nest, repair: bool = False) -> list[str]:
    """The choices of the question that the nest raises; none where it raises no question."""
    asking = Asking()
    repaired(drawn, ReadOptions(repair=repair), asking)
    return [choice.value for question in asking.raised.values() for choice in question.choices]


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
    assert note.text.startswith("A.outer crossed itself at (")


def test_a_loop_that_no_kerf_would_show_is_cut_off_in_any_case() -> None:
    dent = [(0, 0), (100, 0), (100, 100), (50, 100), (50.05, 100.3), (49.95, 100.3), (50, 100), (0, 100)]
    after = repair_contours(nest(200, 200, part("A", dent)), repair=False)
    assert after.contour("A.outer").polygon.area == pytest.approx(10_000, abs=0.1)
    [note] = after.notes
    assert note.severity == "repaired"
    spike = [(0, 0), (100, 0), (100, 100), (50, 100), (50, 100.8), (50, 100), (0, 100)]
    after = repair_contours(nest(200, 200, part("A", spike)), repair=False)
    assert sorted(after.contour("A.outer").curve.as_rows()) == [[0, 0], [0, 100], [100, 0], [100, 100]]


@pytest.mark.parametrize(
    ("ring", "choices", "areas"),
    [
        (DENT, ["largest", "outline", "loops"], {"largest": [10_000], "loops": [10_000, 1]}),
        (
            [(0, 0), (100, 60), (100, 0), (0, 60)],
            ["corners", "loops", "largest"],
            {"corners": [6000], "loops": [1500, 1500], "largest": [1500]},
        ),
        (
            [(0, 0), (60, 0), (60, 60), (40, 60), (40, 20), (100, 20), (100, 40), (0, 40)],
            ["outline", "loops", "largest"],
            {"outline": [3600]},
        ),
    ],
)
def test_larger_loops_are_asked_about(
    ring: list[tuple[float, float]], choices: list[str], areas: dict[str, list[float]]
) -> None:
    drawn = nest(200, 200, part("A", ring))
    assert asked(drawn) == choices
    for answer, expected in areas.items():
        after = repair_contours(drawn, repair=False, crossing=answer)
        found = sorted((p.outer.polygon.area for p in after.parts), reverse=True)
        assert found == pytest.approx(expected, abs=0.1)
        assert len({c.id for c in after.contours}) == len(expected)
        assert all(c.polygon.is_valid for c in after.contours)


def test_holes_that_cross_themselves_are_mended_too() -> None:
    bow = [(20, 20), (40, 40), (40, 20), (20, 40)]
    drawn = nest(200, 200, part("A", rect(0, 0, 100, 100), [bow, circle(80, 80, 5)]))
    after = repair_contours(drawn, repair=False, crossing="loops")
    assert [c.id for c in after.contours] == ["A.hole1", "A.hole1-2", "A.hole2", "A.outer"]


def test_repair_asks_about_a_bow_tie() -> None:
    assert asked(nest(200, 200, part("A", [(0, 0), (100, 100), (100, 0), (0, 100)])), repair=True)[0] == "corners"


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
