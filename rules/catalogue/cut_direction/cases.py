"""Cases of rule cut-direction."""

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.case import Case, circle, cut, nest, part, rect
from kerfwise.rules.catalogue.cut_direction import CutDirectionOptions
from kerfwise.rules.judging.violation import Violation

PLATE = nest(200, 200, part("P1", rect(10, 10, 100, 100), [circle(40, 60, 10)], [[(60, 60), (90, 60)]]))
PLASMA = CutDirectionOptions(outer="cw", hole="ccw")


def cuts(outer: str, hole: str, mark: str) -> CutSequence:
    ways = {"P1.mark1": mark, "P1.hole1": hole, "P1.outer": outer}
    return CutSequence(tuple(cut(PLATE, name, direction=way) for name, way in ways.items()))


CASES = (
    Case("square side on the part", "passes", PLATE, cuts("cw", "ccw", "cw"), options=PLASMA),
    Case(
        "both the wrong way round",
        "fails",
        PLATE,
        cuts("ccw", "cw", "ccw"),
        (
            Violation(
                "cut-direction",
                ("P1.hole1",),
                "P1.hole1 (cut 2) is cut clockwise; the direction of every hole is counter-clockwise",
                (2,),
            ),
            Violation(
                "cut-direction",
                ("P1.outer",),
                "P1.outer (cut 3) is cut counter-clockwise; the direction of every outer is clockwise",
                (3,),
            ),
        ),
        options=PLASMA,
    ),
    Case("free means either way", "boundary", PLATE, cuts("ccw", "cw", "cw")),
)
