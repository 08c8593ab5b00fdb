"""Cases of rule zone-order."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.catalogue.zone_order import ZoneOrderOptions
from kerfwise.rules.judging.violation import Violation

ROW = nest(
    400,
    100,
    part("A", rect(10, 10, 60, 80), marks=[[(20, 20), (40, 20)]]),
    part("B", rect(80, 10, 60, 80)),
    part("C", rect(150, 10, 60, 80)),
)
HOST = nest(400, 200, part("H", rect(10, 10, 150, 150), [rect(30, 30, 110, 110)]), part("G", rect(50, 50, 40, 40)))
BUDGET = ZoneOrderOptions(zone_heat_kj=40.0, absorbed_power_w=1000.0)


def timed(nest: Nest, order: str, each_s: float, zones: dict[str, int]) -> CutSequence:
    """In order, every cut so many seconds long."""
    cuts = in_order(nest, order, zones=zones)
    spans = (replace(cut, start_s=100.0 * k, end_s=100.0 * k + each_s) for k, cut in enumerate(cuts))
    return replace(cuts, cuts=tuple(spans))


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
    Case(
        "a zone that keeps to its budget",
        "boundary",
        ROW,
        timed(ROW, "A.mark1 A.outer B.outer C.outer", 20.0, {"A": 1, "B": 1, "C": 2}),
        options=BUDGET,
    ),
    Case(
        "a zone that takes up more heat than its budget",
        "fails",
        ROW,
        timed(ROW, "A.mark1 A.outer B.outer C.outer", 20.1, {"A": 1, "B": 1, "C": 2}),
        (Violation("zone-order", ("A.outer", "B.outer"), "zone 1 takes up 40.2 kJ, not 40 kJ at the most", (2, 3)),),
        BUDGET,
    ),
    Case(
        "a host that passes the budget with its guest",
        "fails",
        HOST,
        timed(HOST, "G.outer H.hole1 H.outer", 20.0, {"G": 1, "H": 1}),
        (Violation("zone-order", ("H.outer",), "zone 1 takes up 60.0 kJ, not 40 kJ at the most", (1, 2, 3)),),
        BUDGET,
    ),
    Case("no zones are stated at all", "boundary", ROW, in_order(ROW, "C.outer A.outer B.outer")),
)
