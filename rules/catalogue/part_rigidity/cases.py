"""Cases of rule part-rigidity."""

from collections.abc import Mapping
from dataclasses import replace

from kerfwise.encoder.cut import CutSequence, Direction, Span, Tab
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import Case, cut, nest, part, rect
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.judging.violation import Violation

ALONE = nest(200, 200, part("P", rect(10, 10, 180, 180)))
HOST = nest(400, 400, part("H", rect(50, 50, 300, 300), [rect(70, 70, 120, 120)]), part("G", rect(80, 80, 100, 100)))

SIDE = 100.0
LEFT = {"A": 10.0, "B": 120.0, "C": 230.0}
BOTTOM = 290.0
FIGURE_1 = nest(600, 400, *(part(name, rect(x, BOTTOM, SIDE, SIDE)) for name, x in LEFT.items()))
"""Petunin 2009, figure 1. The drawing is not in the text; this nest is laid out to fit his answers: A, B and C stand in
a row along the top edge of the sheet, A also along its left edge; below and to the right is solid metal. Points 4 and 7
lie between two parts."""

BEGIN: Mapping[str, Mapping[int, Point]] = {
    "A": {1: (20, 290), 2: (30, 390), 3: (90, 390), 4: (110, 310)},
    "B": {4: (120, 310), 5: (140, 390), 6: (200, 390), 7: (220, 310)},
    "C": {7: (230, 310), 8: (310, 390), 9: (250, 390)},
}
"""Part → number of the point → where it meets the part."""


def ways(sheet: Nest, *given: tuple[str, Point, Direction]) -> CutSequence:
    return CutSequence(tuple(cut(sheet, f"{name}.outer", entry=entry, direction=way) for name, entry, way in given))


def point(name: str, number: int, way: Direction) -> tuple[str, Point, Direction]:
    return name, BEGIN[name][number], way


def ends_on(name: str, at: int, share: str) -> Violation:
    text = (
        f"{name}.outer (cut {at}) ends along {share} rigid metal, less than 60%: the rest of its last 25% faces the "
        "sheet's edge or parts already out"
    )
    return Violation("part-rigidity", (f"{name}.outer",), text, (at,))


def held(sequence: CutSequence, *at: int) -> CutSequence:
    """The cuts, those at these places with a tab."""
    cuts = (replace(one, tabs=(Tab(one.entry, 1.0),)) if k in at else one for k, one in enumerate(sequence, 1))
    return replace(sequence, cuts=tuple(cuts))


PAIR = nest(400, 160, part("A", rect(20, 30, 150, 100)), part("B", rect(171.5, 30, 150, 100)))
"""Two parts a kerf apart, the edges of the sheet above and below them, solid metal to the right."""


def after_a(begin: Point, end: Point) -> CutSequence:
    """A all round, then B along what is left of it, from one end of the common edge to the other."""
    first = cut(PAIR, "A.outer", entry=(170, 130), direction="ccw")
    return CutSequence((first, cut(PAIR, "B.outer", entry=begin, direction="ccw", span=Span(begin, end))))


CASES = (
    Case(
        "a stretch that ends along solid metal, while the edge that is cut already faces a part that is out",
        "passes",
        PAIR,
        after_a((171.5, 30), (171.5, 130)),
    ),
    Case(
        "the end of a stretch is that of the way along it, not of the whole contour",
        "fails",
        PAIR,
        after_a((171.5, 30), (171.5, 130)),
        (
            Violation(
                "part-rigidity",
                ("B.outer",),
                "B.outer (cut 2) ends along 0% rigid metal, less than 60%: the rest of its last 25% faces the sheet's "
                "edge or parts already out",
                (2,),
            ),
        ),
        PartRigidityOptions(edge_band_mm=40.0),
    ),
    Case(
        "a part that a tab holds ends along the edges of the sheet",
        "passes",
        FIGURE_1,
        held(ways(FIGURE_1, point("A", 2, "cw"), point("B", 4, "cw"), point("C", 7, "cw")), 1),
    ),
    Case(
        "the tab of another part does not hold it",
        "fails",
        FIGURE_1,
        held(ways(FIGURE_1, point("A", 2, "cw"), point("B", 4, "cw"), point("C", 7, "cw")), 2),
        (ends_on("A", 1, "0%"),),
    ),
    Case(
        "each part ends where it is held",
        "passes",
        FIGURE_1,
        ways(FIGURE_1, point("A", 1, "cw"), point("B", 4, "cw"), point("C", 7, "cw")),
    ),
    Case(
        "the first part ends along the edges of the sheet",
        "fails",
        FIGURE_1,
        ways(FIGURE_1, point("A", 2, "cw"), point("B", 4, "cw"), point("C", 7, "cw")),
        (ends_on("A", 1, "0%"),),
    ),
    Case(
        "the other way round it ends along the gap where the part before it was",
        "fails",
        FIGURE_1,
        ways(FIGURE_1, point("A", 1, "cw"), point("B", 4, "ccw"), point("C", 7, "ccw")),
        (ends_on("B", 2, "0%"), ends_on("C", 3, "0%")),
    ),
    Case(
        "while the neighbour is still in, the same way will do",
        "passes",
        FIGURE_1,
        ways(FIGURE_1, point("C", 7, "ccw"), point("B", 4, "ccw"), point("A", 4, "ccw")),
    ),
    Case(
        "a guest is held by its host",
        "passes",
        HOST,
        ways(HOST, ("G", (80.0, 80.0), "cw"), ("H", (200.0, 50.0), "cw")),
    ),
    Case(
        "just less than asked is taken for enough",
        "boundary",
        FIGURE_1,
        ways(FIGURE_1, ("A", (110.0, 333.0), "cw"), point("B", 4, "cw"), point("C", 7, "cw")),
    ),
    Case(
        "more than 0.05 less is not",
        "boundary",
        FIGURE_1,
        ways(FIGURE_1, ("A", (110.0, 337.0), "cw"), point("B", 4, "cw"), point("C", 7, "cw")),
        (ends_on("A", 1, "53%"),),
    ),
    Case(
        "an edge farther than the band is solid metal",
        "boundary",
        ALONE,
        ways(ALONE, ("P", (10.0, 10.0), "cw")),
        options=PartRigidityOptions(edge_band_mm=9.0),
    ),
    Case(
        "an edge as far as the band is free",
        "boundary",
        ALONE,
        ways(ALONE, ("P", (10.0, 10.0), "cw")),
        (ends_on("P", 1, "0%"),),
        options=PartRigidityOptions(edge_band_mm=10.0),
    ),
)
