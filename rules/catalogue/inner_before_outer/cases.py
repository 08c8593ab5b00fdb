"""Cases of rule inner-before-outer."""

from kerfwise.encoder.slits import with_slits
from kerfwise.rules.case import Case, circle, in_order, nest, part, rect
from kerfwise.rules.judging.violation import Violation

PLATE = nest(300, 200, part("P1", rect(10, 10, 100, 100), [circle(40, 60, 10)], [[(60, 60), (90, 60)]]))
RING = part("H", rect(10, 10, 150, 150), [rect(30, 30, 110, 110)])
HOSTED = nest(300, 200, RING, part("G", rect(50, 50, 40, 40)))
TOUCHING = nest(300, 200, RING, part("G", rect(30, 30, 110, 50)))
BESIDE = nest(300, 200, RING, part("G", rect(160, 10, 40, 40)))

SLOT = [(10, 10), (110, 10), (110, 60), (60.5, 60), (60.5, 30), (59.5, 30), (59.5, 60), (10, 60)]
SLOTTED = with_slits(nest(300, 200, part("P1", SLOT)), 1.5)

CASES = (
    Case("a slit before the contour that its slot is of", "passes", SLOTTED, in_order(SLOTTED, "P1.slit1 P1.outer")),
    Case(
        "a slit after the contour that its slot is of",
        "fails",
        SLOTTED,
        in_order(SLOTTED, "P1.outer P1.slit1"),
        (
            Violation(
                "inner-before-outer",
                ("P1.slit1", "P1.outer"),
                "P1.slit1 (cut 2) must be cut before P1.outer (cut 1): it opens a slot beside metal that cutting "
                "P1.outer frees",
                (1, 2),
            ),
        ),
    ),
    Case("hole and mark before the outline", "passes", PLATE, in_order(PLATE, "P1.hole1 P1.mark1 P1.outer")),
    Case("guest before the hole it lies in", "passes", HOSTED, in_order(HOSTED, "G.outer H.hole1 H.outer")),
    Case(
        "hole after the outline",
        "fails",
        PLATE,
        in_order(PLATE, "P1.mark1 P1.outer P1.hole1"),
        (
            Violation(
                "inner-before-outer",
                ("P1.hole1", "P1.outer"),
                "P1.hole1 (cut 3) must be cut before P1.outer (cut 2): it lies inside it, and cutting P1.outer frees "
                "the metal it is in",
                (2, 3),
            ),
        ),
    ),
    Case(
        "guest after the hole it lies in",
        "fails",
        HOSTED,
        in_order(HOSTED, "H.hole1 G.outer H.outer"),
        (
            Violation(
                "inner-before-outer",
                ("G.outer", "H.hole1"),
                "G.outer (cut 2) must be cut before H.hole1 (cut 1): it lies inside it, and cutting H.hole1 frees the "
                "metal it is in",
                (1, 2),
            ),
        ),
    ),
    Case(
        "a guest that fills the hole's width and touches three of its sides lies in it",
        "boundary",
        TOUCHING,
        in_order(TOUCHING, "H.hole1 H.outer G.outer"),
        (
            Violation(
                "inner-before-outer",
                ("G.outer", "H.hole1"),
                "G.outer (cut 3) must be cut before H.hole1 (cut 1): it lies inside it, and cutting H.hole1 frees the "
                "metal it is in",
                (1, 3),
            ),
        ),
    ),
    Case("a part that touches from outside is free", "boundary", BESIDE, in_order(BESIDE, "H.hole1 H.outer G.outer")),
)
