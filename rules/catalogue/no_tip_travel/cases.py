"""Cases of rule no-tip-travel."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence, Tab
from kerfwise.encoder.geometry.segment import Point
from kerfwise.rules.case import Case, cut, nest, part, rect
from kerfwise.rules.judging.violation import Violation

ROW = nest(400, 100, part("A", rect(10, 10, 60, 80)), part("B", rect(80, 10, 60, 80)), part("C", rect(150, 10, 60, 80)))


def travel(*given: tuple[str, Point], home: Point = (0.0, 0.0)) -> CutSequence:
    """Cuts that are pierced and end at the point given."""
    cuts = tuple(cut(ROW, f"{name}.outer", entry=at, pierce=at) for name, at in given)
    return CutSequence(cuts, home=home)


def over(text: str, part: str, at: tuple[int, ...]) -> Violation:
    return Violation("no-tip-travel", (f"{part}.outer",), text, at)


def held(sequence: CutSequence, name: str) -> CutSequence:
    """The cuts, that of one part with a tab."""
    of = f"{name}.outer"
    cuts = (replace(one, tabs=(Tab(one.entry, 1.0),)) if one.contour == of else one for one in sequence)
    return replace(sequence, cuts=tuple(cuts))


def linked(sequence: CutSequence) -> CutSequence:
    """The cuts, each after the first linked: it begins where the one before ends."""
    first, *others = sequence.cuts
    ends = [first, *others[:-1]]
    cuts = (replace(one, pierce=before.end, linked=True) for before, one in zip(ends, others, strict=True))
    return replace(sequence, cuts=(first, *cuts))


CASES = (
    Case(
        "a link is no travel, wherever it leads",
        "passes",
        ROW,
        linked(travel(("A", (5, 50)), ("B", (75, 50)), home=(75.0, 0.0))),
    ),
    Case(
        "over a part that a tab holds",
        "passes",
        ROW,
        held(travel(("A", (5, 50)), ("B", (75, 50)), home=(75.0, 0.0)), "A"),
    ),
    Case(
        "over two parts, one of them held by a tab",
        "fails",
        ROW,
        held(travel(("A", (75, 95)), ("B", (145, 95)), home=(0.0, 50.0)), "A"),
        (over("travel from B.outer (cut 2) home leads over B, cut out as cut 2", "B", (2,)),),
    ),
    Case("towards home along the row", "passes", ROW, travel(("C", (210, 5)), ("B", (140, 5)), ("A", (70, 5)))),
    Case("over what is still in", "passes", ROW, travel(("A", (75, 50)), ("C", (145, 50)), home=(145.0, 0.0))),
    Case(
        "over the part just cut",
        "fails",
        ROW,
        travel(("A", (5, 50)), ("B", (75, 50)), home=(75.0, 0.0)),
        (over("travel from A.outer (cut 1) to B.outer (cut 2) leads over A, cut out as cut 1", "A", (1, 2)),),
    ),
    Case(
        "home over the whole row",
        "fails",
        ROW,
        travel(("A", (75, 95)), ("B", (145, 95)), ("C", (215, 50)), home=(0.0, 50.0)),
        (
            over("travel from C.outer (cut 3) home leads over A, cut out as cut 1", "A", (1, 3)),
            over("travel from C.outer (cut 3) home leads over B, cut out as cut 2", "B", (2, 3)),
            over("travel from C.outer (cut 3) home leads over C, cut out as cut 3", "C", (3,)),
        ),
    ),
    Case("along the very edge of a part", "boundary", ROW, travel(("A", (5, 10)), ("B", (75, 10)), home=(75.0, 0.0))),
    Case(
        "a little further in",
        "boundary",
        ROW,
        travel(("A", (5, 10.2)), ("B", (75, 10.2)), home=(75.0, 0.0)),
        (over("travel from A.outer (cut 1) to B.outer (cut 2) leads over A, cut out as cut 1", "A", (1, 2)),),
    ),
)
