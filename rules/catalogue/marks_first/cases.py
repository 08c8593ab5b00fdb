"""Cases of rule marks-first."""

from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.catalogue.marks_first import MarksFirstOptions
from kerfwise.rules.judging.violation import Violation

TWO = nest(
    300,
    100,
    part("A", rect(10, 10, 80, 80), [rect(60, 60, 20, 20)], marks=[[(20, 20), (40, 20)]]),
    part("B", rect(110, 10, 80, 80), marks=[[(120, 20), (140, 20)]]),
)
PART_BY_PART = in_order(TWO, "A.mark1 A.hole1 A.outer B.mark1 B.outer")


def late(mark: str, cut: str, at: int, earlier: int) -> Violation:
    text = f"{mark} (cut {at}) must be made before {cut} (cut {earlier}): "
    return Violation(
        "marks-first", (mark, cut), text + "marks made after metal is cut through are out of place", (earlier, at)
    )


CASES = (
    Case("all marks first", "passes", TWO, in_order(TWO, "B.mark1 A.mark1 A.hole1 A.outer B.outer")),
    Case("part by part, on the sheet", "fails", TWO, PART_BY_PART, (late("B.mark1", "A.hole1", 4, 2),)),
    Case("part by part, by part", "passes", TWO, PART_BY_PART, options=MarksFirstOptions(scope="part")),
    Case(
        "between its own hole and outline, by part",
        "fails",
        TWO,
        in_order(TWO, "B.mark1 B.outer A.hole1 A.mark1 A.outer"),
        (late("A.mark1", "A.hole1", 4, 3),),
        options=MarksFirstOptions(scope="part"),
    ),
    Case("the last mark right before the first cut", "boundary", TWO, in_order(TWO, "A.mark1 B.mark1 B.outer A.hole1")),
    Case(
        "the last mark right after the first cut",
        "boundary",
        TWO,
        in_order(TWO, "A.mark1 B.outer B.mark1 A.hole1 A.outer"),
        (late("B.mark1", "B.outer", 3, 2),),
    ),
)
