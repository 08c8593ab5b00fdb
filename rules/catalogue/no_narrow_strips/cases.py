"""Cases of rule no-narrow-strips."""

from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.catalogue.no_narrow_strips import NoNarrowStripsOptions
from kerfwise.rules.judging.violation import Violation

# Long parts side by side, 10 mm apart: A and C 150 mm wide, B between them.
ROWS = nest(1200, 450, part("A", rect(50, 50, 1000, 150)), part("B", rect(50, 210, 1000, 40)),
            part("C", rect(50, 260, 1000, 150)))  # fmt: skip
# What is left between A and C is the gap less a web: B in a gap of 85 mm lies in 60 mm of metal, in 83 mm in 58.
WIDE, TIGHT = (
    nest(1200, 600, part("A", rect(50, 50, 1000, 150)), part("B", rect(50, 220, 1000, 40)),
         part("C", rect(50, 200 + gap, 1000, 150)))
    for gap in (87, 83)
)  # fmt: skip
# Eight plates around M.
NAMES = ("A", "B", "C", "D", "M", "E", "F", "G", "H")
GRID = nest(700, 700, *(part(n, rect(50 + 210 * (k % 3), 50 + 210 * (k // 3), 200, 200)) for k, n in enumerate(NAMES)))


def order(names: str) -> str:
    return " ".join(f"{name}.outer" for name in names)


def strip(after: str, at: int, left: str, out: str, cuts: tuple[int, ...]) -> Violation:
    between = ", ".join(f"{name}.outer" for name in out)
    text = f"after {after}.outer (cut {at}) {left}.outer lies in a narrow strip between {between}"
    return Violation("no-narrow-strips", (f"{left}.outer",), text, cuts)


CASES = (
    Case("from one side to the other", "passes", ROWS, in_order(ROWS, order("ABC"))),
    Case("the one between last", "fails", ROWS, in_order(ROWS, order("ACB")), (strip("C", 2, "B", "AC", (1, 2)),)),
    Case("the strip is first seen when it is there", "passes", ROWS, in_order(ROWS, order("CBA"))),
    Case("metal wider than a strip", "boundary", WIDE, in_order(WIDE, order("ACB"))),
    Case(
        "metal narrower than a strip",
        "boundary",
        TIGHT,
        in_order(TIGHT, order("ACB")),
        (strip("C", 2, "B", "AC", (1, 2)),),
    ),
    Case(
        "thick plate makes wider strips",
        "boundary",
        WIDE,
        in_order(WIDE, order("ACB")),
        (strip("C", 2, "B", "AC", (1, 2)),),
        options=NoNarrowStripsOptions(thickness_mm=30.0),
    ),
    Case(
        "a wide island",
        "fails",
        GRID,
        in_order(GRID, order("BDEGMACFH")),
        (
            Violation(
                "no-narrow-strips",
                ("M.outer",),
                "after G.outer (cut 4) M.outer lies on an island, cut off from F.outer by B.outer, D.outer, E.outer, "
                "G.outer",
                (1, 2, 3, 4),
            ),
        ),
    ),
    Case("the last part has nothing to be cut off from", "passes", GRID, in_order(GRID, order("ABCDFEHMG"))),
)
