"""Cases of rule heat-lag."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.case import Case, circle, in_order, nest, part, rect
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.judging.violation import Violation

ROW = nest(
    500,
    100,
    part("A", rect(10, 10, 60, 80), [circle(40, 50, 10)], [[(20, 20), (40, 20)]]),
    part("B", rect(80, 10, 60, 80)),
    part("C", rect(400, 10, 60, 80)),
)
APART = nest(500, 100, part("A", rect(10, 10, 60, 80)), part("B", rect(120, 10, 60, 80)))
NEAR = nest(500, 100, part("A", rect(10, 10, 60, 80)), part("B", rect(119, 10, 60, 80)))


def timed(cuts: CutSequence, *times_s: tuple[float, float]) -> CutSequence:
    timed_cuts = (replace(cut, start_s=start, end_s=end) for cut, (start, end) in zip(cuts, times_s, strict=True))
    return replace(cuts, cuts=tuple(timed_cuts))


def too_soon(first: str, second: str, at: tuple[int, int], missing: str) -> Violation:
    text = f"between {first} (cut {at[0]}) and {second} (cut {at[1]}) there must be {missing}"
    return Violation("heat-lag", (first, second), text, at)


def linked(cuts: CutSequence, *positions: int) -> CutSequence:
    """The cuts, those at these positions linked with the one before."""
    return CutSequence(tuple(replace(one, linked=k in positions) for k, one in enumerate(cuts, 1)))


CASES = (
    Case(
        "a link leaves no time between near parts",
        "fails",
        ROW,
        linked(in_order(ROW, "A.outer B.outer C.outer"), 2),
        (too_soon("A.outer", "B.outer", (1, 2), "1 other cut (there is none)"),),
    ),
    Case("one far away between", "passes", ROW, in_order(ROW, "A.mark1 A.hole1 A.outer C.outer B.outer")),
    Case(
        "one right after the other",
        "fails",
        ROW,
        in_order(ROW, "B.outer A.outer C.outer"),
        (too_soon("B.outer", "A.outer", (1, 2), "1 other cut (there is none)"),),
    ),
    Case(
        "the holes of the other part count too",
        "fails",
        ROW,
        in_order(ROW, "B.outer A.hole1 A.outer"),
        (too_soon("B.outer", "A.hole1", (1, 2), "1 other cut (there is none)"),),
    ),
    Case("contours of one part do not heat each other", "boundary", ROW, in_order(ROW, "A.hole1 A.outer C.outer")),
    Case("a mark between is a cut between", "boundary", ROW, in_order(ROW, "B.outer A.mark1 A.outer")),
    Case("as far apart as heat reaches", "boundary", APART, in_order(APART, "A.outer B.outer")),
    Case(
        "a millimetre nearer",
        "boundary",
        NEAR,
        in_order(NEAR, "A.outer B.outer"),
        (too_soon("A.outer", "B.outer", (1, 2), "1 other cut (there is none)"),),
    ),
    Case(
        "cuts enough, but no time",
        "fails",
        ROW,
        timed(in_order(ROW, "A.outer C.outer B.outer"), (0, 10), (11, 12), (13, 20)),
        (too_soon("A.outer", "B.outer", (1, 3), "5 s (there are 3.0 s)"),),
        options=HeatLagOptions(lag_s=5.0),
    ),
    Case(
        "as much time as asked",
        "boundary",
        ROW,
        timed(in_order(ROW, "A.outer C.outer B.outer"), (0, 10), (11, 14), (15, 20)),
        options=HeatLagOptions(lag_s=5.0),
    ),
)
