"""Cases of rule start-side."""

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.rules.case import Case, circle, in_order, nest, part, rect
from kerfwise.rules.catalogue.start_side import StartSideOptions
from kerfwise.rules.judging.violation import Violation

# Long strips (80 x 20) near the right side, though the offcut on the left would ask for the left's opposite as well.
LONG = nest(400, 200, part("A", rect(280, 10, 100, 20)), part("B", rect(30, 60, 60, 60)))
OFFCUT_RIGHT = nest(400, 200, part("A", rect(10, 10, 60, 60)), part("B", rect(80, 10, 60, 60)))
HEAT_RIGHT = nest(400, 200, part("A", rect(10, 10, 60, 60)), part("B", rect(300, 10, 90, 90)))
TALL = nest(200, 400, part("A", rect(10, 10, 60, 60)))
EVEN = nest(400, 200, part("A", rect(10, 10, 60, 60)), part("B", rect(330, 10, 60, 60)))
# The empty strip on the right is 60 mm, exactly 0.15 of 400: not over it. More is cut on the left all the same.
JUST_SMALL = nest(400, 200, part("A", rect(30, 10, 60, 60)), part("B", rect(240, 10, 100, 100)))
JUST_LARGE = nest(400, 200, part("A", rect(30, 10, 60, 60)), part("B", rect(240, 10, 99, 100)))
# A strip 100 x 25 is exactly 4 : 1, so long; 25 mm from the right side is just at it.
JUST_LONG = nest(400, 200, part("A", rect(275, 10, 100, 25)), part("B", rect(30, 60, 100, 100)))
JUST_SHORT = nest(400, 200, part("A", rect(275, 10, 100, 25.1)), part("B", rect(30, 60, 100, 100)))
# A disc in the middle of a round sheet: both halves are alike but for rounding, so that the order of the sides decides.
ROUND = Nest(Sheet(Curve.of(circle(200, 200, 200)), ()), (part("A", circle(200, 200, 80)),))
# An edge of each part lies on the line between the halves and counts half for each.
ON_THE_MIDDLE = nest(400, 300, part("A", rect(100.1, 40, 99.9, 60)), part("B", rect(200, 200, 99.9, 60)))


def wrong(text: str, expected: str, because: str) -> Violation:
    return Violation("start-side", (), f"cutting starts from the {text}, not from the {expected}: {because}")


CASES = (
    Case("a tie goes left", "boundary", ROUND, in_order(ROUND, "A.outer", "left")),
    Case(
        "a tie does not go right",
        "boundary",
        ROUND,
        in_order(ROUND, "A.outer", "right"),
        (wrong("right", "left", "nothing tells the sides apart"),),
    ),
    Case("an edge on the middle", "boundary", ON_THE_MIDDLE, in_order(ON_THE_MIDDLE, "A.outer B.outer", "left")),
    Case("from the long part", "passes", LONG, in_order(LONG, "A.outer B.outer", "right")),
    Case(
        "away from the long part",
        "fails",
        LONG,
        in_order(LONG, "A.outer B.outer", "left"),
        (wrong("left", "right", "more long parts lie at the right side"),),
    ),
    Case(
        "from the offcut",
        "fails",
        OFFCUT_RIGHT,
        in_order(OFFCUT_RIGHT, "A.outer B.outer", "right"),
        (wrong("right", "left", "there is a large offcut on the right"),),
    ),
    Case("from the side with more to cut", "passes", HEAT_RIGHT, in_order(HEAT_RIGHT, "A.outer B.outer", "right")),
    Case(
        "from the side with less to cut",
        "fails",
        HEAT_RIGHT,
        in_order(HEAT_RIGHT, "A.outer B.outer", "left"),
        (wrong("left", "right", "more is cut in its half of the sheet"),),
    ),
    Case(
        "from a broad side",
        "fails",
        TALL,
        in_order(TALL, "A.outer", "left"),
        (wrong("left", "bottom", "there is a large offcut on the top"),),
    ),
    Case(
        "the profile fixes the side",
        "passes",
        OFFCUT_RIGHT,
        in_order(OFFCUT_RIGHT, "A.outer B.outer", "top"),
        options=StartSideOptions(side="top"),
    ),
    Case(
        "nothing tells the sides apart: left",
        "boundary",
        EVEN,
        in_order(EVEN, "A.outer B.outer", "right"),
        (wrong("right", "left", "nothing tells the sides apart"),),
    ),
    Case(
        "a strip as deep as the share is not over it: heat decides",
        "boundary",
        JUST_SMALL,
        in_order(JUST_SMALL, "A.outer B.outer", "right"),
    ),
    Case(
        "a millimetre more and it is a large offcut",
        "boundary",
        JUST_LARGE,
        in_order(JUST_LARGE, "A.outer B.outer", "right"),
        (wrong("right", "left", "there is a large offcut on the right"),),
    ),
    Case(
        "exactly 4 : 1 is long, exactly 25 mm is near", "boundary", JUST_LONG, in_order(JUST_LONG, "A.outer", "right")
    ),
    Case(
        "less than 4 : 1 is not: heat decides",
        "boundary",
        JUST_SHORT,
        in_order(JUST_SHORT, "A.outer", "right"),
        (wrong("right", "left", "more is cut in its half of the sheet"),),
    ),
)
