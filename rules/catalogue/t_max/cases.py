"""Cases of rule t-max."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence, HotSpot
from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.catalogue.t_max import TMaxOptions
from kerfwise.rules.judging.violation import Violation

# Two parts 10 mm apart; A is cut from 1 s on, B from 31 s on.
PAIR = nest(400, 200, part("A", rect(50, 50, 100, 100)), part("B", rect(160, 50, 100, 100)))


def measured(*spots: HotSpot) -> CutSequence:
    order = in_order(PAIR, "A.outer B.outer")
    cuts = tuple(replace(c, start_s=s, end_s=s + 20) for c, s in zip(order, (1.0, 31.0), strict=True))
    return replace(order, cuts=cuts, hot_spots=spots)


COOL = HotSpot(80.0, (155.2, 100.0), 1.0)
WEB = HotSpot(131.24, (155.2, 100.0), 31.0)
ON_A = HotSpot(120.0, (62.4, 99.6), 31.0, "A")
TOO_HOT = "B.outer (cut 2) makes the metal at (155, 100), between parts, 131.2 °C hot, not 115 °C at the most"
ON_PART = "B.outer (cut 2) makes the metal at (62, 100), on part A, 120.0 °C hot, not 119 °C at the most"

CASES = (
    Case("all cool", "passes", PAIR, measured(COOL, replace(WEB, peak_c=90.0))),
    Case("the web between two parts", "fails", PAIR, measured(COOL, WEB),
         (Violation("t-max", ("B.outer",), TOO_HOT, (2,)),)),
    Case("just as hot as it may be", "boundary", PAIR, measured(COOL, replace(WEB, peak_c=115.0))),
    Case("the limit is that of the section heat", "boundary", PAIR, measured(COOL, ON_A),
         (Violation("t-max", ("B.outer",),
                    ON_PART, (2,)),),
         TMaxOptions(heat_limit_c=119.0)),
    Case("a limit of its own", "boundary", PAIR, measured(COOL, ON_A), (), TMaxOptions(120.0, heat_limit_c=100.0)),
)  # fmt: skip
