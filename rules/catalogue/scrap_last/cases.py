"""Cases of rule scrap-last."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence, Tab
from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.judging.violation import Violation

A = part("A", rect(550, 50, 100, 100), [rect(580, 80, 20, 20)])
STRIPS = nest(1000, 200, A, scrap=[[(100, 0), (100, 200)], [(200, 0), (200, 200)]])
BOTH_SIDES = nest(1000, 200, A, scrap=[[(100, 0), (100, 200)], [(900, 0), (900, 200)]])
BRANCH = nest(1000, 200, A, scrap=[[(0, 100), (200, 100)], [(200, 0), (200, 200)]])
TO_A_PART = nest(1000, 200, A, scrap=[[(600, 0), (600, 48.5)], [(600, 151.5), (600, 200)], [(800, 0), (800, 200)]])


def loose(line: str, at: int) -> Violation:
    text = f"{line} (cut {at}) is cut in a piece of the skeleton that is loose"
    return Violation("scrap-last", (line,), text, (at,))


def held(cuts: CutSequence) -> CutSequence:
    """The cuts, those of outer contours with a tab."""
    tabs = (Tab((550, 100), 1.0),)
    return CutSequence(tuple(replace(one, tabs=tabs) if one.contour == "A.outer" else one for one in cuts))


CASES = (
    Case(
        "a part that tabs hold is out",
        "passes",
        STRIPS,
        held(in_order(STRIPS, "A.hole1 A.outer scrap1 scrap2")),
    ),
    Case("the outer strip first", "passes", STRIPS, in_order(STRIPS, "A.hole1 A.outer scrap1 scrap2")),
    Case(
        "a line before a part",
        "fails",
        STRIPS,
        in_order(STRIPS, "A.hole1 scrap1 A.outer scrap2"),
        (
            Violation(
                "scrap-last",
                ("A.outer", "scrap1"),
                "A.outer (cut 3) must be cut before scrap1 (cut 2): cutting up the skeleton takes away what holds it",
                (2, 3),
            ),
        ),
    ),
    Case(
        "the outer strip after the inner one",
        "fails",
        STRIPS,
        in_order(STRIPS, "A.hole1 A.outer scrap2 scrap1"),
        (loose("scrap1", 4),),
    ),
    Case("both lines at the frame", "boundary", BOTH_SIDES, in_order(BOTH_SIDES, "A.hole1 A.outer scrap2 scrap1")),
    Case(
        "a branch before the line that it ends on",
        "boundary",
        BRANCH,
        in_order(BRANCH, "A.hole1 A.outer scrap1 scrap2"),
    ),
    Case(
        "a branch after the line that it ends on",
        "boundary",
        BRANCH,
        in_order(BRANCH, "A.hole1 A.outer scrap2 scrap1"),
        (loose("scrap1", 4),),
    ),
    Case(
        "two lines that end at the hole of a part cut off a piece together",
        "boundary",
        TO_A_PART,
        in_order(TO_A_PART, "A.hole1 A.outer scrap1 scrap2 scrap3"),
        (loose("scrap3", 5),),
    ),
)
