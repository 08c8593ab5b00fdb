"""Petunin 2009, figure 1: three parts, nine points to begin a cut at, and which of them will do.

The nest and its points are those of the cases of part-rigidity.
"""

from __future__ import annotations

from collections.abc import Mapping

from kerfwise.rule_kit import Direction, Point
from kerfwise.rules.run_cases import cases_of

FIGURE_1 = next(case.nest for case in cases_of("part-rigidity") if case.name == "each part ends where it is held")
BEGIN: Mapping[str, Mapping[int, Point]] = {
    "A": {1: (20, 290), 2: (30, 390), 3: (90, 390), 4: (110, 310)},
    "B": {4: (120, 310), 5: (140, 390), 6: (200, 390), 7: (220, 310)},
    "C": {7: (230, 310), 8: (310, 390), 9: (250, 390)},
}
"""Part → number of the point → where it meets the part; the cases give names to some of them."""
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
