from kerfwise.encoder.contour_checks import hole_problems, mark_notes
from kerfwise.encoder.nest import Part
from kerfwise.rules.case import circle, part, rect


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
