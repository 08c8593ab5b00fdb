"""Cases of rule pierce."""

from kerfwise.encoder.cut import Cut, CutSequence, Span
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.slits import with_slits
from kerfwise.rules.case import Case, CaseKind, circle, nest, part, rect
from kerfwise.rules.catalogue.pierce import PierceOptions
from kerfwise.rules.judging.violation import Violation

PLATE = nest(
    400, 300, part("A", rect(50, 50, 100, 100), [circle(100, 100, 20)]), part("B", rect(160, 50, 100, 100))
)  # fmt: skip
HOST = nest(400, 300, part("H", rect(50, 50, 200, 200), [rect(70, 70, 160, 160)]), part("G", rect(100, 100, 40, 40)))
EDGE = nest(400, 300, part("A", rect(50, 1, 100, 100)))
MARKED = nest(400, 300, part("A", rect(50, 50, 100, 100), marks=[[(60, 60), (90, 60)]]))

# Joining points lie half a kerf of 1.5 mm off the contour, in the waste.
A_FROM_BELOW = ("A.outer", (100, 50), (100, 44), (100, 49.25))
A_HOLE = ("A.hole1", (120, 100), (112, 100), (119.25, 100))
B_FROM_BELOW = ("B.outer", (210, 50), (210, 44), (210, 49.25))
H_HOLE = ("H.hole1", (100, 70), (100, 75), (100, 70.75))
H_OUTER = ("H.outer", (100, 50), (100, 44), (100, 49.25))
G_OUTER = ("G.outer", (120, 100), (120, 94), (120, 99.25))
B_FROM_THE_LEFT = ("B.outer", (160, 100), (155, 100), (159.25, 100))
A_ACROSS = ("A.outer", (150, 92), (157, 102.2), (150.75, 92))
CORNERS = nest(
    200,
    200,
    *(part(name, rect(x, y, 80, 80)) for name, x, y in (("A", 10, 10), ("B", 94, 10), ("C", 10, 94), ("D", 94, 94))),
)
IN_THE_MIDDLE = (("A.outer", (90, 90), (92, 92), (90.53, 90.53)), ("D.outer", (94, 94), (92, 92), (93.47, 93.47)))


SLOT = [(50, 50), (150, 50), (150, 150), (100.5, 150), (100.5, 120), (99.5, 120), (99.5, 150), (50, 150)]
SLOTTED = with_slits(nest(400, 300, part("A", SLOT)), 1.5)
A_SLIT = Cut(
    "A.slit1",
    (100, 150.559),
    "ccw",
    (100, 156),
    Curve.of([(100, 156), (100, 150.559)], closed=False),
    Curve.of([(100, 120.75)], closed=False),
)


TOUCHING = nest(300, 200, part("A", rect(40, 50, 100, 80)), part("B", rect(141.5, 50, 100, 80)))
A_FIRST = ("A.outer", (90, 50), (90, 44), (90, 49.25))
B_AFTER_A = Cut(
    "B.outer",
    (141.5, 130),
    "cw",
    (140.75, 130),
    None,
    Curve.of([(140.75, 50)], closed=False),
    span=Span((140.75, 130), (140.75, 50)),
)
"""A common edge, a kerf of 1.5 mm wide: B is cut along what A has left of it."""


def from_the_right(pierce_x: float) -> tuple[str, Point, Point, Point]:
    """A's outline, entered from the street between A and B."""
    return ("A.outer", (150, 100), (pierce_x, 100), (150.75, 100))


def sequence(*cuts: tuple[str, Point, Point, Point] | Cut) -> CutSequence:
    """Cuts of (contour, entry, pierce, joining point), with a straight lead-in."""
    cuts_so_far = []
    for next_cut in cuts:
        if isinstance(next_cut, Cut):
            cuts_so_far.append(next_cut)
        else:
            contour, entry, pierce, joined = next_cut
            cuts_so_far.append(Cut(contour, entry, "cw", pierce, Curve.of([pierce, joined], closed=False)))
    return CutSequence(tuple(cuts_so_far))


def broken(at: tuple[int, ...], contours: tuple[str, ...], text: str) -> Violation:
    return Violation("pierce", contours, text, at)


def case(name: str, kind: CaseKind, where: Nest, cuts: CutSequence, *violations: Violation) -> Case:
    return Case(name, kind, where, cuts, violations, PierceOptions(clearance_mm=1.5))


def linked(*points: Point) -> Cut:
    """B.outer from the end of A.outer, entered from below at (100, 50), along the path given."""
    return Cut("B.outer", (210, 50), "cw", points[0], Curve.of(points, closed=False), linked=True)


CASES = (
    Case(
        "a part begun in the kerf of its neighbour",
        "passes",
        TOUCHING,
        sequence(A_FIRST, B_AFTER_A),
        (),
        PierceOptions(clearance_mm=1.5, common_cuts=True),
    ),
    Case(
        "a part begun where its neighbour is not out yet",
        "fails",
        TOUCHING,
        sequence(B_AFTER_A, A_FIRST),
        (
            broken((1,), ("B.outer",), "B.outer (cut 1) is pierced 0.75 mm from B.outer, less than 1.5 mm"),
            broken((1,), ("B.outer", "A.outer"), "B.outer (cut 1) is pierced 0.75 mm from A.outer, less than 1.5 mm"),
        ),
        PierceOptions(clearance_mm=1.5, common_cuts=True),
    ),
    case(
        "a kerf is no place to begin without common cuts",
        "fails",
        TOUCHING,
        sequence(A_FIRST, B_AFTER_A),
        broken(
            (1, 2),
            ("B.outer", "A.outer"),
            "B.outer (cut 2) is pierced in the kerf of A.outer (cut 1), where there is no metal, at (140.75, 130.00)",
        ),
        broken((2,), ("B.outer",), "B.outer (cut 2) is pierced 0.75 mm from B.outer, less than 1.5 mm"),
        broken((2,), ("B.outer", "A.outer"), "B.outer (cut 2) is pierced 0.75 mm from A.outer, less than 1.5 mm"),
    ),
    case(
        "a link is not pierced: it begins in the kerf of the part that it leaves",
        "passes",
        PLATE,
        sequence(A_FROM_BELOW, linked((100, 49.25), (104, 44), (206, 44), (210, 49.25))),
    ),
    case(
        "a link across a part",
        "fails",
        PLATE,
        sequence(A_FROM_BELOW, linked((100, 49.25), (104, 44), (156, 44), (170, 60), (210, 49.25))),
        broken((2,), ("B.outer",), "the link of B.outer (cut 2) crosses its own contour"),
    ),
    case("a slit before its mouth, its contour elsewhere", "passes", SLOTTED, sequence(A_SLIT, A_FROM_BELOW)),
    case(
        "a contour in the kerf of the lead of its slit",
        "fails",
        SLOTTED,
        sequence(A_SLIT, ("A.outer", (102, 150), (100, 156), (102, 150.75))),
        broken(
            (1, 2),
            ("A.outer", "A.slit1"),
            "A.outer (cut 2) is pierced in the kerf of the lead-in of A.slit1 (cut 1), where there is no metal, at "
            "(100.00, 156.00)",
        ),
        broken(
            (1, 2),
            ("A.outer", "A.slit1"),
            "the lead-in of A.outer (cut 2) crosses the kerf of the lead-in of A.slit1 (cut 1)",
        ),
    ),
    case(
        "a slit pierced in its slot",
        "fails",
        SLOTTED,
        sequence(
            Cut("A.slit1", (100, 150.559), "ccw", (100, 130), Curve.of([(100, 130), (100, 150.559)], closed=False))
        ),
        broken((1,), ("A.slit1", "A.outer"), "A.slit1 (cut 1) is pierced 0.50 mm from A.outer, less than 1.5 mm"),
    ),
    case("in waste and clear", "passes", PLATE, sequence(A_HOLE, A_FROM_BELOW, B_FROM_BELOW)),
    case("a guest before the hole it is pierced in", "passes", HOST, sequence(G_OUTER, H_HOLE, H_OUTER)),
    case(
        "a guest after the hole it is pierced in",
        "fails",
        HOST,
        sequence(H_HOLE, G_OUTER, H_OUTER),
        broken(
            (1, 2),
            ("G.outer", "H.hole1"),
            "G.outer (cut 2) is pierced in the waste of H.hole1, which has fallen out since cut 1",
        ),
    ),
    case(
        "pierced on the part itself",
        "fails",
        PLATE,
        sequence(("A.outer", (100, 50), (100, 60), (100, 50.75))),
        broken((1,), ("A.outer",), "A.outer (cut 1) is pierced inside itself, at (100.00, 60.00)"),
    ),
    case(
        "pierced on another part, and the lead crosses its outline",
        "fails",
        PLATE,
        sequence(("A.outer", (150, 100), (165, 100), (150.75, 100))),
        broken((1,), ("A.outer", "B.outer"), "A.outer (cut 1) is pierced on part B, at (165.00, 100.00)"),
        broken((1,), ("A.outer", "B.outer"), "the lead-in of A.outer (cut 1) crosses B.outer"),
    ),
    case(
        "a hole pierced in the part around it",
        "fails",
        PLATE,
        sequence(("A.hole1", (120, 100), (130, 100), (119.25, 100))),
        broken((1,), ("A.hole1",), "A.hole1 (cut 1) is pierced outside itself, at (130.00, 100.00)"),
        broken((1,), ("A.hole1",), "the lead-in of A.hole1 (cut 1) crosses its own contour"),
    ),
    case(
        "a lead across a corner of its own part",
        "fails",
        PLATE,
        sequence(("A.outer", (100, 50), (40, 60), (100, 49.25))),
        broken((1,), ("A.outer",), "the lead-in of A.outer (cut 1) crosses its own contour"),
    ),
    case(
        "a lead-out into the neighbour",
        "fails",
        PLATE,
        sequence(
            Cut(
                "A.outer",
                (150, 100),
                "cw",
                (155, 100),
                Curve.of([(155, 100), (150.75, 100)], closed=False),
                Curve.of([(150.75, 100), (161, 110)], closed=False),
            )
        ),
        broken((1,), ("A.outer", "B.outer"), "the lead-out of A.outer (cut 1) crosses B.outer"),
    ),
    case("as near as the clearance", "boundary", PLATE, sequence(("A.outer", (100, 50), (100, 48.5), (100, 49.25)))),
    case(
        "nearer than the clearance",
        "boundary",
        PLATE,
        sequence(("A.outer", (100, 50), (100, 48.6), (100, 49.25))),
        broken((1,), ("A.outer",), "A.outer (cut 1) is pierced 1.40 mm from A.outer, less than 1.5 mm"),
    ),
    case(
        "the clearance holds towards the neighbour too",
        "boundary",
        PLATE,
        sequence(("A.outer", (150, 100), (159, 100), (150.75, 100))),
        broken((1,), ("A.outer", "B.outer"), "A.outer (cut 1) is pierced 1.00 mm from B.outer, less than 1.5 mm"),
    ),
    case(
        "off the edge of the sheet nothing is pierced",
        "boundary",
        EDGE,
        sequence(("A.outer", (100, 1), (100, -0.3), (100, 0.25))),
    ),
    case(
        "overcut along the own contour, without kerf",
        "boundary",
        PLATE,
        sequence(
            Cut(
                "A.hole1",
                (120, 100),
                "ccw",
                (110, 100),
                Curve.of([(110, 100), (120, 100)], closed=False),
                PLATE.contour("A.hole1").curve.towards("ccw").between(20 * 3.14159265358979, 5),
            )
        ),
    ),
    case("a mark is not pierced", "boundary", MARKED, sequence(Cut("A.mark1", (60, 60), "ccw", (60, 60)))),
    case("off the kerf of the neighbour", "passes", PLATE, sequence(B_FROM_BELOW, from_the_right(156))),
    case(
        "in the kerf of the neighbour",
        "fails",
        PLATE,
        sequence(B_FROM_BELOW, A_HOLE, from_the_right(158.55)),
        broken(
            (1, 3),
            ("A.outer", "B.outer"),
            "A.outer (cut 3) is pierced in the kerf of B.outer (cut 1), where there is no metal, at (158.55, 100.00)",
        ),
        broken((1, 3), ("A.outer", "B.outer"), "the lead-in of A.outer (cut 3) crosses the kerf of B.outer (cut 1)"),
        broken((3,), ("A.outer", "B.outer"), "A.outer (cut 3) is pierced 1.45 mm from B.outer, less than 1.5 mm"),
    ),
    case("while the neighbour is in, its kerf is metal", "passes", PLATE, sequence(from_the_right(158), B_FROM_BELOW)),
    case(
        "half a kerf and the splash from an older kerf",
        "boundary",
        PLATE,
        sequence(B_FROM_BELOW, from_the_right(157.25)),
    ),
    case(
        "nearer to an older kerf",
        "boundary",
        PLATE,
        sequence(B_FROM_BELOW, from_the_right(157.3)),
        broken(
            (1, 2),
            ("A.outer", "B.outer"),
            "A.outer (cut 2) is pierced 1.20 mm from the kerf of B.outer (cut 1), less than 1.25 mm, at "
            "(157.30, 100.00)",
        ),
    ),
    case(
        "a lead over an older lead",
        "fails",
        PLATE,
        sequence(B_FROM_THE_LEFT, A_ACROSS),
        broken(
            (1, 2),
            ("A.outer", "B.outer"),
            "the lead-in of A.outer (cut 2) crosses the kerf of the lead-in of B.outer (cut 1)",
        ),
    ),
    case(
        "two parts pierced in the same place, where streets cross",
        "fails",
        CORNERS,
        sequence(*IN_THE_MIDDLE),
        broken(
            (1, 2),
            ("D.outer", "A.outer"),
            "D.outer (cut 2) is pierced in the kerf of the lead-in of A.outer (cut 1), where there is no metal, at "
            "(92.00, 92.00)",
        ),
        broken(
            (1, 2),
            ("D.outer", "A.outer"),
            "the lead-in of D.outer (cut 2) crosses the kerf of the lead-in of A.outer (cut 1)",
        ),
    ),
)
