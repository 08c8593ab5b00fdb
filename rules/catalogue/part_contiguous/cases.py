"""Cases of rule part-contiguous."""

from kerfwise.rules.case import Case, circle, in_order, nest, part, rect
from kerfwise.rules.catalogue.part_contiguous import PartContiguousOptions
from kerfwise.rules.judging.violation import Violation

PLATE = part("P1", rect(10, 10, 100, 60), [circle(35, 40, 10), circle(80, 40, 10)], [[(50, 20), (70, 20)]])
NEST = nest(300, 100, PLATE, part("P2", rect(120, 10, 50, 60)))

CASES = (
    Case("in one go", "passes", NEST, in_order(NEST, "P1.mark1 P2.outer P1.hole2 P1.hole1 P1.outer")),
    Case(
        "another part between hole and outline",
        "fails",
        NEST,
        in_order(NEST, "P1.mark1 P1.hole1 P1.hole2 P2.outer P1.outer"),
        (
            Violation(
                "part-contiguous",
                ("P1.hole2", "P2.outer", "P1.outer"),
                "P1 is not cut in one go: P2.outer (cut 4) comes between P1.hole2 (cut 3) and P1.outer (cut 5)",
                (3, 4, 5),
            ),
        ),
    ),
    Case(
        "the outline is not the last",
        "fails",
        NEST,
        in_order(NEST, "P1.mark1 P1.hole1 P1.outer P1.hole2 P2.outer"),
        (
            Violation(
                "part-contiguous",
                ("P1.outer", "P1.hole2"),
                "P1.outer (cut 3) is not the last of P1: P1.hole2 (cut 4) follows",
                (3, 4),
            ),
        ),
    ),
    Case(
        "a mark of its own apart from the run is no matter",
        "boundary",
        NEST,
        in_order(NEST, "P1.mark1 P2.outer P1.hole1 P1.hole2 P1.outer"),
        options=PartContiguousOptions(marks="apart"),
    ),
    Case(
        "a mark of its own belongs to the run when marks stay with their part",
        "boundary",
        NEST,
        in_order(NEST, "P1.mark1 P2.outer P1.hole1 P1.hole2 P1.outer"),
        (
            Violation(
                "part-contiguous",
                ("P1.mark1", "P2.outer", "P1.hole1"),
                "P1 is not cut in one go: P2.outer (cut 2) comes between P1.mark1 (cut 1) and P1.hole1 (cut 3)",
                (1, 2, 3),
            ),
        ),
        options=PartContiguousOptions(marks="together"),
    ),
)
