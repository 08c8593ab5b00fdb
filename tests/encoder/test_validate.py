"""A nest as a whole: parts that overlap or reach off the sheet, lines that cut up scrap."""

import time

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise import InputError, Nest
from kerfwise.encoder.nest import Note
from kerfwise.encoder.readers.drawing import DrawnCurve
from kerfwise.encoder.readers.nest_from_drawing import assemble
from kerfwise.encoder.validate import MOST_NOTES, overlap_problems, problems_error, sheet_problems, validated
from kerfwise.rule_kit import Curve, Part, Sheet, circle, nest, part, rect
from kerfwise.rules.case import Rows
from kerfwise.tests.commands.test_broken_nests import THREE, tens
from kerfwise.tests.tools.amount import examples


def test_a_sound_nest_passes_unchanged() -> None:
    given = nest(200, 100, part("A", rect(5, 5, 50, 50), [circle(30, 30, 10)], [[(8, 8), (12, 8)]]))
    after = validated(given)
    assert after.notes == ()
    assert [c.curve for c in after.contours] == [c.curve for c in given.contours]


def test_all_that_is_wrong_is_one_error() -> None:
    bow_tie = [(150, 5), (190, 45), (190, 5), (150, 45)]
    given = nest(
        200,
        100,
        part("A", rect(5, 5, 50, 50), [rect(50, 10, 20, 5)]),
        part("B", rect(40, 5, 50, 50)),
        part("C", bow_tie),
        part("D", rect(150, 60, 60, 20)),
    )
    with pytest.raises(InputError) as error:
        validated(given)
    assert error.value.message == "the nest cannot be cut as it is drawn: 4 problems"
    assert [d.split(":")[0] for d in error.value.details] == [
        "C.outer crosses itself at (170.000, 25.000)",
        "A.hole1 reaches out of A.outer at (62.500, 12.500)",
        "A.outer and B.outer overlap by 725.000 mm² at (47.500, 35.000)",
        "D.outer reaches 10.000 mm off the sheet at (205.000, 70.000)",
    ]


def test_doubts_are_noted_after_what_the_reader_said() -> None:
    given = nest(200, 100, part("A", rect(5, 5, 50, 50), [], [[(8, 8), (80, 8)]]), part("B", rect(55, 5, 50, 50)))
    said = Note("warning", "said by the reader")
    after = validated(type(given)(given.sheet, given.parts, notes=(said,)))
    assert after.notes[0] == said
    assert [n.text.split(":")[0] for n in after.notes[1:]] == ["A.outer and B.outer touch", "A.mark1 runs off its part"]


def test_a_broken_sheet_is_no_reason_to_call_every_part_off_it() -> None:
    given = nest(200, 100, part("A", rect(5, 5, 50, 50)))
    broken = type(given)(type(given.sheet)(given.sheet.outline.between(0, 200)), given.parts)
    with pytest.raises(InputError) as error:
        validated(broken)
    assert len(error.value.details) == 1
    assert error.value.details[0].startswith("the sheet's outline encloses no area")


def test_a_long_list_is_cut_short() -> None:
    error = problems_error("bad", [f"problem {k}" for k in range(1000)])
    assert error.message == "bad: 1000 problems"
    assert len(error.details) == 201
    assert error.details[-1] == "… and 800 more"


@pytest.mark.slow
def test_thousands_of_contours_take_seconds() -> None:
    parts = [
        part(f"P{k}", rect(12 * (k % 50), 12 * (k // 50), 10, 10), [circle(12 * (k % 50) + 5, 12 * (k // 50) + 5, 3)])
        for k in range(1500)
    ]
    start = time.process_time()
    assert validated(nest(700, 700, *parts)).notes == ()
    assert time.process_time() - start < 6


def crossing(one: Curve, other: Curve) -> bool:
    a, b = one.polygon(), other.polygon()
    return min(a.intersection(b).area, a.difference(b).area, b.difference(a).area) > 1


@pytest.mark.slow
@given(st.lists(st.tuples(tens, tens, tens, tens), min_size=2, max_size=6, unique=True))
@example(THREE)
@examples(150)
def test_rectangles_that_overlap_are_refused_in_words(given: list[tuple[int, int, int, int]]) -> None:
    """No two share an edge: a hole along an edge of its part leaves metal that another ring may miss."""
    corners = [(x + k, y + k, x + w + k, y + h + k) for k, (x, y, w, h) in enumerate(given)]
    rings = [Curve.of([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]) for x0, y0, x1, y1 in corners]
    parts, _ = assemble([DrawnCurve(ring, "cut", k) for k, ring in enumerate(rings)])
    nest = Nest(Sheet.rectangle(400, 400), parts)
    if any(crossing(a, b) for k, a in enumerate(rings) for b in rings[:k]):
        with pytest.raises(InputError, match=r"overlap|reaches out of"):
            validated(nest)


HOST = part("H", rect(0, 0, 100, 100), [rect(10, 10, 60, 60)])


def found(*parts: Part) -> tuple[list[str], list[str]]:
    problems, notes = overlap_problems(parts)
    return problems, [n.text for n in notes]


@pytest.mark.parametrize(
    ("x", "overlap", "touch"),
    [
        (51, False, False),
        (50.011, False, False),
        (50.009, False, True),
        (50, False, True),
        (49.985, False, True),
        (49.975, True, False),
        (40, True, False),
    ],
)
def test_apart_touching_and_overlapping(x: float, overlap: bool, touch: bool) -> None:
    problems, notes = found(part("A", rect(0, 0, 50, 50)), part("B", rect(x, 0, 50, 50)))
    assert (len(problems) == 1, len(notes) == 1) == (overlap, touch)


def test_what_is_said() -> None:
    assert found(part("A", rect(0, 0, 50, 50)), part("B", rect(40, 0, 50, 50)))[0] == [
        "A.outer and B.outer overlap by 500.000 mm² at (45.000, 25.000): move one of the parts"
    ]
    assert found(part("A", rect(0, 0, 50, 50)), part("B", rect(50, 0, 50, 50)))[1] == [
        "A.outer and B.outer touch: parts A and B leave no room for the kerf between them"
    ]


def test_a_part_in_a_hole_lies_free() -> None:
    assert found(HOST, part("G", rect(20, 20, 30, 30))) == ([], [])


def test_a_part_that_touches_the_hole_it_lies_in() -> None:
    assert found(HOST, part("G", rect(10, 20, 30, 30)))[1] == [
        "H.hole1 and G.outer touch: parts H and G leave no room for the kerf between them"
    ]


def test_a_part_on_solid_metal_overlaps() -> None:
    assert len(found(HOST, part("G", circle(85, 85, 5)))[0]) == 1


def test_very_many_touches_are_counted() -> None:
    row = [part(f"P{k}", rect(10 * k, 0, 10, 10)) for k in range(MOST_NOTES + 3)]
    notes = found(*row)[1]
    assert len(notes) == MOST_NOTES + 1
    assert notes[-1] == "2 more pairs of parts touch"


def test_parts_off_the_sheet() -> None:
    sheet = Sheet(Curve.of(rect(0, 0, 200, 100)), (Curve.of(rect(150, 40, 20, 20)),))
    fits = part("A", rect(0, 0, 50, 100))  # along the edge is on it
    hangs, away, over = part("B", rect(180, 0, 30, 10)), part("C", circle(0, 500, 9)), part("D", rect(140, 30, 40, 40))
    ring = part("E", rect(140, 30, 40, 40), [rect(150, 40, 20, 20)])
    assert sheet_problems([fits, hangs, over, ring], sheet) == [
        "B.outer reaches 10.000 mm off the sheet at (205.000, 5.000): move the part or give a larger sheet",
        "D.outer lies over a hole of the sheet at (160.000, 50.000): move the part or give a larger sheet",
    ]
    assert sheet_problems([away], sheet)[0].startswith("C.outer reaches 409.000 mm off the sheet")


PLATE = part("A", rect(50, 20, 50, 50), [rect(60, 30, 30, 30)])


def plate(*scrap: Rows) -> Nest:
    return nest(200, 100, PLATE, scrap=scrap)


REFUSED = {
    "through a part": ([[(0, 40), (70, 40)]], "scrap1 runs through part A at (60.0, 40.0): end it before the part"),
    "in a hole of a part": (
        [[(70, 40), (80, 40)]],
        "scrap1 runs through part A at (75.0, 40.0): end it before the part",
    ),
    "off the sheet": ([[(150, 0), (150, 101)]], "scrap1 runs 1.000 mm off the sheet at (150.0, 100.5)"),
    "all beside the sheet": ([[(300, 0), (300, 9)]], "scrap1 runs 9.000 mm off the sheet at (300.0, 4.5)"),
    "of no length": ([[(150, 10), (150, 10)]], "scrap1 has no length, at (150.000, 10.000): remove it"),
    "closed": ([[(150, 10), (160, 10), (160, 20), (150, 10)]], "scrap1 is closed, at (150.000, 10.000)"),
    "over itself": ([[(120, 10), (160, 50), (160, 10), (120, 50)]], "scrap1 crosses itself, at (120.000, 10.000)"),
    "across each other": (
        [[(120, 0), (120, 100)], [(100, 50), (200, 50)]],
        "scrap1 and scrap2 cross at (120.0, 50.0): let one of them end at the other",
    ),
    "on each other": (
        [[(120, 0), (120, 60)], [(120, 40), (120, 100)]],
        "scrap1 and scrap2 run on each other at (120.0, 50.0): draw the line once",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused(case: str) -> None:
    lines, told = REFUSED[case]
    with pytest.raises(InputError, match="the nest cannot be cut as it is drawn: 1 problem") as error:
        validated(plate(*lines))
    assert error.value.details[0].startswith(told)


SOUND = {
    "edge to edge": [[(120, 0), (120, 100)]],
    "edge to part": [[(0, 40), (48.5, 40)]],
    "a branch": [[(120, 0), (120, 100)], [(120, 50), (200, 50)]],
    "a branch that goes on a little": [[(120, 0), (120, 100)], [(119.1, 50), (200, 50)]],
    "round a part": [[(0, 80), (110, 80), (110, 0)]],
}


@pytest.mark.parametrize("case", SOUND)
def test_it_is_sound(case: str) -> None:
    assert len(validated(plate(*SOUND[case])).scrap) == len(SOUND[case])
