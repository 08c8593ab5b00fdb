"""Cases of rule shared-metal."""

from dataclasses import replace

from kerfwise.encoder.nest import Nest, Note
from kerfwise.rules.case import Case, CaseKind, circle, in_order, nest, part, rect
from kerfwise.rules.catalogue.shared_metal import SharedMetalOptions
from kerfwise.rules.judging.violation import Violation


def side_by_side(gap_mm: float) -> Nest:
    return nest(300, 120, part("A", rect(10, 10, 80, 80)), part("B", rect(90 + gap_mm, 10, 80, 80)))


def guest(gap_mm: float) -> Nest:
    host = part("H", rect(10, 10, 100, 100), [rect(20, 20, 80, 80)])
    return nest(120, 120, host, part("G", rect(20 + gap_mm, 40, 30, 30)))


THIN_WEBS = nest(
    200, 120, part("A", rect(10, 10, 100, 80), [rect(10.4, 20, 30, 30), rect(40.8, 20, 30, 30)], [[(10, 15), (40, 15)]])
)
ACROSS_A_WEB = nest(
    140, 140, part("H", rect(10, 10, 100, 100), [rect(10.3, 20, 80, 80)]), part("G", rect(12, 40, 30, 30))
)  # fmt: skip
WITHIN = nest(
    140, 140, part("H", rect(10, 10, 100, 100), [rect(20, 20, 80, 80)]), part("G", rect(40, 40, 30, 30))
)  # fmt: skip
ONE_LINE = replace(WITHIN, notes=(Note("warning", "cut once", ("H.hole2", "G.outer"), common=True),))
ROUND = nest(300, 120, part("A", circle(50, 50, 30)), part("B", circle(111, 50, 30)))


def case(name: str, kind: CaseKind, where: Nest, order: str, *violations: Violation) -> Case:
    return Case(name, kind, where, in_order(where, order), violations, SharedMetalOptions(kerf_mm=1.5))


def burnt(at: tuple[int, ...], one: str, other: str, text: str) -> Violation:
    return Violation("shared-metal", (one, other), f"{one} and {other} {text} mm into the other part", at)


CASES: tuple[Case, ...] = (
    case("a kerf apart and more", "passes", side_by_side(2.0), "A.outer B.outer"),
    case("webs of one part are thinner than the kerf", "passes", THIN_WEBS, "A.mark1 A.hole1 A.hole2 A.outer"),
    case("a guest a kerf from its hole", "passes", guest(1.5), "G.outer H.hole1 H.outer"),
    case(
        "two parts touch",
        "fails",
        side_by_side(0.0),
        "A.outer B.outer",
        burnt((1, 2), "A.outer", "B.outer", "touch at (90.0, 10.0): the kerf of 1.5 mm reaches 1.500"),
    ),
    case(
        "nearer than the kerf, whichever is cut first",
        "fails",
        side_by_side(1.0),
        "B.outer A.outer",
        burnt((1, 2), "A.outer", "B.outer", "are 1.000 mm apart at (90.5, 10.0): the kerf of 1.5 mm reaches 0.500"),
    ),
    case(
        "two discs, near in one point",
        "fails",
        ROUND,
        "A.outer B.outer",
        burnt((1, 2), "A.outer", "B.outer", "are 1.000 mm apart at (80.5, 50.0): the kerf of 1.5 mm reaches 0.500"),
    ),
    case(
        "a guest nearer than the kerf to its hole",
        "fails",
        guest(0.5),
        "G.outer H.hole1 H.outer",
        burnt((1, 2), "H.hole1", "G.outer", "are 0.500 mm apart at (20.2, 40.0): the kerf of 1.5 mm reaches 1.000"),
    ),
    case(
        "one of the two is cut already, and is no part of the sequence",
        "fails",
        side_by_side(1.0),
        "B.outer",
        burnt((1,), "A.outer", "B.outer", "are 1.000 mm apart at (90.5, 10.0): the kerf of 1.5 mm reaches 0.500"),
    ),
    case(
        "one line given to two parts",
        "fails",
        ONE_LINE,
        "G.outer H.hole1 H.outer",
        Violation(
            "shared-metal",
            ("G.outer",),
            "G.outer and H.hole2 are one line at (40.0, 40.0), given to two parts: on either side of it the kerf of "
            "1.5 mm is metal of one of them; it can only be cut once, as G.outer",
            (1,),
        ),
    ),
    case("a guest behind a thin web burns nothing through it", "boundary", ACROSS_A_WEB, "G.outer H.hole1 H.outer"),
    case("exactly a kerf apart", "boundary", side_by_side(1.5), "A.outer B.outer"),
    case("0.04 mm of metal are within the tolerance", "boundary", side_by_side(1.46), "A.outer B.outer"),
    case(
        "0.06 mm of metal are not",
        "boundary",
        side_by_side(1.44),
        "A.outer B.outer",
        burnt((1, 2), "A.outer", "B.outer", "are 1.440 mm apart at (90.7, 10.0): the kerf of 1.5 mm reaches 0.060"),
    ),
)
