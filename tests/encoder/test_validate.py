import time

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Note
from kerfwise.encoder.validate import problems_error, validated
from kerfwise.rules.case import circle, nest, part, rect


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
