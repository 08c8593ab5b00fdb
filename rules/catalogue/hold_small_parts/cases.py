"""Cases of rule hold-small-parts."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import Case, cut, nest, part, rect
from kerfwise.rules.catalogue.hold_small_parts import HoldSmallPartsOptions
from kerfwise.rules.judging.violation import Violation

SMALL = nest(400, 200, part("A", rect(20, 20, 80, 50), [rect(50, 35, 20, 20)]))
WIDE = nest(400, 200, part("A", rect(20, 20, 120, 50)))
DRAWN = nest(400, 200, replace(part("A", rect(20, 20, 120, 50)), tabs=(Tab((60, 20), 0.4),)))
DRAWN_TWICE = nest(400, 200, replace(part("A", rect(20, 20, 120, 50)), tabs=(Tab((60, 20), 0.4), Tab((60, 70), 0.4))))
LASER = HoldSmallPartsOptions(kerf_mm=0.2, process="laser")
WHY = "its centroid is 40.0 mm from one end, and slats lie 60 mm apart"


def cuts(sheet: Nest, *tabs: Tab) -> CutSequence:
    """Cuts of all contours, the last of them with tabs."""
    drawn_cuts = [cut(sheet, contour.id) for contour in sheet.contours]
    return CutSequence((*drawn_cuts[:-1], replace(drawn_cuts[-1], tabs=tabs)))


def tab(*at: Point, width: float = 1.0) -> tuple[Tab, ...]:
    return tuple(Tab(place, width) for place in at)


def wrong(*texts: str, at: int = 2) -> tuple[Violation, ...]:
    return tuple(Violation("hold-small-parts", ("A.outer",), f"A.outer (cut {at}) {text}", (at,)) for text in texts)


def ending(pierce: Point, sheet: Nest = SMALL) -> CutSequence:
    """Cuts of all contours; that of A joins at (61.25, 19.25) and stops 2.5 mm before: a tab of 1 mm, and the kerf."""
    lead_in, stop = (Curve.of(points, closed=False) for points in ([pierce, (61.25, 19.25)], [(58.75, 19.25)]))
    all_cuts = cuts(sheet, *tab((60, 20)))
    return CutSequence((*all_cuts[:-1], replace(all_cuts[-1], pierce=pierce, lead_in=lead_in, lead_out=stop)))


CASES = (
    Case("a lead-in straight off the cut", "passes", SMALL, ending((61.25, 13))),
    Case(
        "a lead-in that leans over the tab",
        "fails",
        SMALL,
        ending((57, 13)),
        wrong("burns all but 0.57 mm of its tab with its lead-in"),
    ),
    Case(
        "a lead-in that leans over some of it",
        "fails",
        SMALL,
        ending((59.63, 13.05)),
        wrong("burns all but 0.92 mm of its tab with its lead-in"),
    ),
    Case("as much of it, where all is in tenths of a millimetre", "boundary", SMALL, ending((59.65, 13.05))),
    Case("one tab where the cut of plasma ends", "passes", SMALL, cuts(SMALL, *tab((60, 20)))),
    Case("two tabs by laser", "passes", SMALL, cuts(SMALL, *tab((60, 20), (60, 70))), options=LASER),
    Case("no tab", "fails", SMALL, cuts(SMALL), wrong(f"has no tab: {WHY}")),
    Case(
        "one of two is missing", "fails", SMALL, cuts(SMALL, *tab((60, 20))), wrong(f"has 1 tab, not 2: {WHY}"), LASER
    ),
    Case(
        "three, as they are asked for",
        "passes",
        SMALL,
        cuts(SMALL, *tab((40, 20), (80, 20), (60, 70))),
        options=replace(LASER, count=3),
    ),
    Case(
        "too wide, and too narrow",
        "fails",
        SMALL,
        cuts(SMALL, Tab((60, 20), 0.9), Tab((60, 70), 0.3)),
        wrong(
            "has a tab at (60.0, 20.0) that is 0.90 mm wide, not 0.6 mm",
            "has a tab at (60.0, 70.0) that is 0.30 mm wide, not 0.6 mm",
        ),
        replace(LASER, width_mm=0.6),
    ),
    Case(
        "in a corner",
        "fails",
        SMALL,
        cuts(SMALL, *tab((97, 20))),
        wrong("has a tab at (97.0, 20.0) that lies in a corner, or less than 3 mm from one"),
    ),
    Case(
        "on the waste of a hole",
        "fails",
        SMALL,
        CutSequence((replace(cut(SMALL, "A.hole1"), tabs=tab((50, 35))), *cuts(SMALL, *tab((60, 20))).cuts[1:])),
        (Violation("hold-small-parts", ("A.hole1",), "A.hole1 (cut 1) has 1 tab that nothing asks for", (1,)),),
    ),
    Case("just far enough from a corner", "boundary", SMALL, cuts(SMALL, *tab((95.75, 20)))),
    Case(
        "not asked to be far from one",
        "passes",
        SMALL,
        cuts(SMALL, *tab((98, 20))),
        options=HoldSmallPartsOptions(corner_mm=0.5),
    ),
    Case("as wide as two pitches lies safely", "boundary", WIDE, cuts(WIDE)),
    Case(
        "on slats further apart",
        "fails",
        WIDE,
        cuts(WIDE),
        wrong("has no tab: its centroid is 60.0 mm from one end, and slats lie 75 mm apart", at=1),
        HoldSmallPartsOptions(slat_pitch_mm=75.0),
    ),
    Case(
        "along the slats it is short",
        "fails",
        WIDE,
        cuts(WIDE),
        wrong("has no tab: its centroid is 25.0 mm from one end, and slats lie 60 mm apart", at=1),
        HoldSmallPartsOptions(slats="x"),
    ),
    Case(
        "every part",
        "fails",
        WIDE,
        cuts(WIDE),
        wrong("has no tab: every part is to have one", at=1),
        HoldSmallPartsOptions(tabs="all"),
    ),
    Case("only what the nest draws", "passes", SMALL, cuts(SMALL), options=HoldSmallPartsOptions(tabs="nest")),
    Case("as it is drawn", "passes", DRAWN, cuts(DRAWN, Tab((60.2, 20), 0.42))),
    Case(
        "elsewhere than it is drawn",
        "fails",
        DRAWN,
        cuts(DRAWN, Tab((70, 20), 0.4)),
        wrong("has a tab at (70.0, 20.0), 10.0 mm from where it is asked for", at=1),
    ),
    Case(
        "two at one of the places that are drawn",
        "fails",
        DRAWN_TWICE,
        cuts(DRAWN_TWICE, Tab((59.8, 20), 0.4), Tab((60.3, 20), 0.4)),
        wrong("has no tab at (60.0, 70.0): the nest draws it", at=1),
        LASER,
    ),
    Case("both as they are drawn", "passes", DRAWN_TWICE, cuts(DRAWN_TWICE, *DRAWN_TWICE.parts[0].tabs), options=LASER),
)
