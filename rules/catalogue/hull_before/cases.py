"""Cases of rule hull-before."""

from kerfwise.rules.case import Case, circle, in_order, nest, part, rect
from kerfwise.rules.judging.violation import Violation

CHANNEL = part("C", [(10, 10), (210, 10), (210, 40), (40, 40), (40, 160), (210, 160), (210, 190), (10, 190)])
MOUTH = nest(400, 200, CHANNEL, part("D", circle(120, 100, 40)))
# The channel's mouth ends at x = 210: a disc whose centre lies there is in the hull, one beyond it is not.
RIM = nest(400, 200, CHANNEL, part("D", circle(210, 100, 40)))
BEYOND = nest(400, 200, CHANNEL, part("D", circle(211, 100, 40)))
CONVEX = nest(400, 200, part("C", rect(10, 10, 200, 180)), part("D", circle(300, 100, 40)))


def too_late() -> Violation:
    return Violation(
        "hull-before",
        ("D.outer", "C.outer"),
        "D.outer (cut 2) must be cut before C.outer (cut 1): it sits in the concavity of C.outer, and would be left on "
        "an island once C.outer is out",
        (1, 2),
    )


CASES = (
    Case("the disc in the mouth first", "passes", MOUTH, in_order(MOUTH, "D.outer C.outer")),
    Case("the disc in the mouth last", "fails", MOUTH, in_order(MOUTH, "C.outer D.outer"), (too_late(),)),
    Case("beside a convex part any order will do", "passes", CONVEX, in_order(CONVEX, "C.outer D.outer")),
    Case("a centroid on the hull is in it", "boundary", RIM, in_order(RIM, "C.outer D.outer"), (too_late(),)),
    Case("a centroid a millimetre beyond the hull is not", "boundary", BEYOND, in_order(BEYOND, "C.outer D.outer")),
)
