"""Cases of rule nested-before-host-holes."""

from kerfwise.rules.case import Case, circle, in_order, nest, part, rect
from kerfwise.rules.judging.violation import Violation

HOST = part("H", rect(10, 10, 200, 100), [rect(20, 20, 80, 80), circle(150, 60, 20)])
ONE = nest(300, 200, HOST, part("G", rect(30, 30, 40, 40)))
DEEP = nest(300, 200, HOST, part("G", rect(25, 25, 70, 70), [rect(35, 35, 50, 50)]), part("D", rect(40, 40, 20, 20)))

CASES = (
    Case("guest before both holes of its host", "passes", ONE, in_order(ONE, "G.outer H.hole2 H.hole1 H.outer")),
    Case(
        "guest after a hole that it does not lie in",
        "fails",
        ONE,
        in_order(ONE, "H.hole2 G.outer H.hole1 H.outer"),
        (
            Violation(
                "nested-before-host-holes",
                ("G.outer", "H.hole2"),
                "G.outer (cut 2) must be cut before H.hole2 (cut 1): it is nested in H, and all parts in there are cut "
                "before the first hole of H",
                (1, 2),
            ),
        ),
    ),
    Case(
        "of two levels of nesting each host counts for its own guests only",
        "boundary",
        DEEP,
        in_order(DEEP, "D.outer G.hole1 G.outer H.hole1 H.hole2 H.outer"),
    ),
    Case(
        "the deepest part is no guest of the outermost host: only its own host's hole waits for it",
        "boundary",
        DEEP,
        in_order(DEEP, "G.hole1 D.outer H.hole2 G.outer H.hole1 H.outer"),
        (
            Violation(
                "nested-before-host-holes",
                ("G.outer", "H.hole2"),
                "G.outer (cut 4) must be cut before H.hole2 (cut 3): it is nested in H, and all parts in there are cut "
                "before the first hole of H",
                (3, 4),
            ),
            Violation(
                "nested-before-host-holes",
                ("D.outer", "G.hole1"),
                "D.outer (cut 2) must be cut before G.hole1 (cut 1): it is nested in G, and all parts in there are cut "
                "before the first hole of G",
                (1, 2),
            ),
        ),
    ),
)
