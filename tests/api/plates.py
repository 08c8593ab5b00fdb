"""Small nests that the tests of the Python interface plan."""

from __future__ import annotations

from kerfwise.rule_kit import nest, part, rect

PAIR = nest(300, 100, part("P1", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]), part("P2", rect(110, 10, 80, 80)))
CLASH = ("P2.outer before P1.outer", "P1.outer position first")
WORK = 0.3
