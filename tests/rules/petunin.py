"""Petunin 2009, figure 1: three parts, nine points to begin a cut at, and which of them will do.

The drawing is not in the text; this nest is laid out to fit its answers. A, B and C stand in a row along the top edge
of the sheet, A also along its left edge; below and to the right is solid metal. Points 4 and 7 lie between two parts.
"""

from __future__ import annotations

from collections.abc import Mapping

from kerfwise.encoder.cut import Direction
from kerfwise.encoder.geometry.segment import Point
from kerfwise.tests.nests import nest, part, rect

SIDE = 100.0
LEFT = {"A": 10.0, "B": 120.0, "C": 230.0}
BOTTOM = 290.0
FIGURE_1 = nest(600, 400, *(part(name, rect(x, BOTTOM, SIDE, SIDE)) for name, x in LEFT.items()))

BEGIN: Mapping[str, Mapping[int, Point]] = {
    "A": {1: (20, 290), 2: (30, 390), 3: (90, 390), 4: (110, 310)},
    "B": {4: (120, 310), 5: (140, 390), 6: (200, 390), 7: (220, 310)},
    "C": {7: (230, 310), 8: (310, 390), 9: (250, 390)},
}
"""Part → number of the point → where it meets the part."""

Answers = Mapping[str, Mapping[int, set[Direction]]]
ABC: Answers = {
    "A": {1: {"cw"}, 2: set(), 3: {"ccw"}, 4: {"cw", "ccw"}},
    "B": {4: {"cw"}, 5: set(), 6: {"ccw"}, 7: {"cw", "ccw"}},
    "C": {7: {"cw"}, 8: {"ccw"}, 9: set()},
}
"""His answers when A is cut first, then B, then C."""
CBA: Answers = {
    "C": {7: {"cw", "ccw"}, 8: {"ccw"}, 9: {"cw"}},
    "B": {4: {"cw", "ccw"}, 5: {"cw"}, 6: set(), 7: {"ccw"}},
    "A": {1: {"cw"}, 2: set(), 3: set(), 4: {"ccw"}},
}
"""The other way round the sets are others; these follow from the layout."""
