"""Cases of rule level-ahead."""

from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.judging.violation import Violation

ROW = nest(400, 100, part("A", rect(10, 10, 80, 80)), part("B", rect(110, 10, 80, 80)))
# B's lower edge at y = 50, the level of A's centroid: the ray along it grazes B. And a micrometre higher it misses.
GRAZING = nest(400, 200, part("A", rect(10, 10, 80, 80)), part("B", rect(110, 50, 80, 80)))
MISSING = nest(400, 200, part("A", rect(10, 10, 80, 80)), part("B", rect(110, 50.001, 80, 80)))
HOST = nest(
    400, 200, part("H", rect(10, 10, 180, 180), [rect(20, 20, 160, 160)]), part("G", rect(30, 80, 40, 40)),
    part("B", rect(200, 10, 80, 180)),
)  # fmt: skip


def too_late(side: str) -> Violation:
    return Violation(
        "level-ahead",
        ("A.outer", "B.outer"),
        f"A.outer (cut 2) must be cut before B.outer (cut 1): it lies between B.outer and the {side} side, where "
        "cutting starts, and would be left on an island behind the torch",
        (1, 2),
    )


CASES = (
    Case("from the left: the left part first", "passes", ROW, in_order(ROW, "A.outer B.outer", "left")),
    Case(
        "from the left: the left part last", "fails", ROW, in_order(ROW, "B.outer A.outer", "left"), (too_late("left"),)
    ),
    Case("from the right it is the other way round", "passes", ROW, in_order(ROW, "B.outer A.outer", "right")),
    Case("from below they stand side by side", "passes", ROW, in_order(ROW, "B.outer A.outer", "bottom")),
    Case(
        "a ray that grazes the other part meets it",
        "boundary",
        GRAZING,
        in_order(GRAZING, "B.outer A.outer", "left"),
        (too_late("left"),),
    ),
    Case(
        "a ray just below the other part misses it", "boundary", MISSING, in_order(MISSING, "B.outer A.outer", "left")
    ),
    Case(
        "a guest in a hole and a part outside have no level",
        "boundary",
        HOST,
        in_order(HOST, "H.hole1 H.outer B.outer G.outer", "left"),
    ),
    Case("no start side is stated", "boundary", ROW, in_order(ROW, "B.outer A.outer")),
)
