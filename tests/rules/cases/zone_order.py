from kerfwise.rules.rule import Violation
from kerfwise.tests.nests import nest, part, rect
from kerfwise.tests.rules.case import Case, in_order

ROW = nest(
    400,
    100,
    part("A", rect(10, 10, 60, 80), marks=[[(20, 20), (40, 20)]]),
    part("B", rect(80, 10, 60, 80)),
    part("C", rect(150, 10, 60, 80)),
)
HOST = nest(400, 200, part("H", rect(10, 10, 150, 150), [rect(30, 30, 110, 110)]), part("G", rect(50, 50, 40, 40)))

CASES = (
    Case(
        "zone after zone",
        "passes",
        ROW,
        in_order(ROW, "A.mark1 B.outer A.outer C.outer", zones={"A": 1, "B": 1, "C": 2}),
    ),
    Case(
        "back to an earlier zone",
        "fails",
        ROW,
        in_order(ROW, "A.outer C.outer B.outer A.mark1", zones={"A": 1, "B": 1, "C": 2}),
        (
            Violation(
                "zone-order",
                ("B.outer", "C.outer"),
                "B.outer of zone 1 (cut 3) is cut after C.outer of zone 2 (cut 2)",
                (2, 3),
            ),
        ),
    ),
    Case(
        "host and guest in different zones",
        "fails",
        HOST,
        in_order(HOST, "G.outer H.hole1 H.outer", zones={"G": 1, "H": 2}),
        (
            Violation(
                "zone-order",
                ("G.outer", "H.hole1"),
                "G.outer is in zone 1 (cut 1), but H.hole1 around it is in zone 2 (cut 2)",
                (1, 2),
            ),
        ),
    ),
    Case(
        "out of order and in different zones",
        "fails",
        HOST,
        in_order(HOST, "H.hole1 G.outer H.outer", zones={"G": 1, "H": 2}),
        (
            Violation(
                "zone-order",
                ("G.outer", "H.hole1"),
                "G.outer of zone 1 (cut 2) is cut after H.hole1 of zone 2 (cut 1)",
                (1, 2),
            ),
            Violation(
                "zone-order",
                ("G.outer", "H.hole1"),
                "G.outer is in zone 1 (cut 2), but H.hole1 around it is in zone 2 (cut 1)",
                (2, 1),
            ),
        ),
    ),
    Case(
        "a part without a zone among parts with one",
        "fails",
        ROW,
        in_order(ROW, "A.outer B.outer C.outer", zones={"A": 1, "C": 2}),
        (Violation("zone-order", ("B.outer",), "B.outer (cut 2) has no zone, while other cuts have", (2,)),),
    ),
    Case(
        "a mark has no zone order",
        "boundary",
        ROW,
        in_order(ROW, "B.outer C.outer A.mark1", zones={"A": 1, "B": 1, "C": 2}),
    ),
    Case("no zones are stated at all", "boundary", ROW, in_order(ROW, "C.outer A.outer B.outer")),
)
