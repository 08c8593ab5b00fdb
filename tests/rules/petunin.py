"""Petunin 2009, figure 1: three parts, nine points to begin a cut at, and which of them will do.

The nest and its points are those of the cases of part-rigidity.
"""

from __future__ import annotations

from collections.abc import Mapping

from kerfwise.rule_kit import Direction
from kerfwise.rules.catalogue.part_rigidity.cases import BEGIN, FIGURE_1

__all__ = ["ABC", "BEGIN", "CBA", "FIGURE_1", "Answers"]

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
