"""Cases of rule no-islands."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence, Tab
from kerfwise.rules.case import Case, in_order, nest, part, rect
from kerfwise.rules.catalogue.no_islands import NoIslandsOptions
from kerfwise.rules.judging.violation import Violation

# Three by three, 10 mm apart and from the edges: M in the middle faces nothing but its neighbours.
NAMES = ("A", "B", "C", "D", "M", "E", "F", "G", "H")
GRID = nest(340, 340, *(part(n, rect(10 + 110 * (k % 3), 10 + 110 * (k // 3), 100, 100)) for k, n in enumerate(NAMES)))
# M and N side by side in a ring of others, nothing else near them.
RING = nest(
    400, 340,
    part("M", rect(120, 120, 75, 100)), part("N", rect(205, 120, 75, 100)),
    part("S", rect(10, 10, 380, 100)), part("T", rect(10, 230, 380, 100)),
    part("W", rect(10, 120, 100, 100)), part("E", rect(290, 120, 100, 100)),
)  # fmt: skip
# A stands 30 mm from everything.
FAR = nest(400, 200, part("A", rect(30, 30, 100, 100)), part("B", rect(160, 30, 100, 100)))
HOST = nest(400, 400, part("H", rect(50, 50, 300, 300), [rect(70, 70, 120, 120)]), part("G", rect(80, 80, 100, 100)))


def island(after: str, at: int, *left: str) -> Violation:
    ids = tuple(f"{name}.outer" for name in left)
    text = f"{after}.outer (cut {at}) leaves {', '.join(ids)} on an island that nothing still in holds"
    return Violation("no-islands", ids, text, (at,))


def held(names: str) -> CutSequence:
    """The parts of the grid in order, all with tabs."""
    sequence = in_order(GRID, " ".join(f"{name}.outer" for name in names))
    return replace(sequence, cuts=tuple(replace(one, tabs=(Tab(one.entry, 1.0),)) for one in sequence))


def order(names: str) -> str:
    return " ".join(f"{name}.outer" for name in names)


CASES = (
    Case("row after row", "passes", GRID, in_order(GRID, order("ABCDMEFGH"))),
    Case("the middle last", "fails", GRID, in_order(GRID, order("ABCDEFGHM")), (island("G", 7, "M"),)),
    Case("the middle last, with a tab", "fails", GRID, held("ABCDEFGHM"), (island("G", 7, "M"),)),
    Case("two in the middle", "fails", RING, in_order(RING, order("STWEMN")), (island("E", 4, "M", "N"),)),
    Case(
        "two in the middle, one after the other",
        "passes",
        RING,
        in_order(RING, order("STWMNE")),
    ),
    Case(
        "a row cut from both ends leaves the middle one on the frame",
        "passes",
        FAR,
        in_order(FAR, order("AB")),
    ),
    Case("a guest hangs on its host", "boundary", HOST, in_order(HOST, "G.outer H.hole1 H.outer")),
    Case("a neighbour left to the last hold it", "boundary", GRID, in_order(GRID, order("ABCDEFHMG"))),
    Case("the strip along the edge is frame", "boundary", GRID, in_order(GRID, order("CMHEBDAGF"))),
    Case(
        "a frame is no frame to a part that too little of faces it",
        "boundary",
        GRID,
        in_order(GRID, order("CMHEBDAGF")),
        (island("H", 3, "E"),),
        options=NoIslandsOptions(frame_share=0.35),
    ),
)
