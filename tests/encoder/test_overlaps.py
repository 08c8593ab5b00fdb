import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Part, Sheet
from kerfwise.encoder.validate import MOST_NOTES, overlap_problems, sheet_problems
from kerfwise.rules.case import circle, part, rect

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
