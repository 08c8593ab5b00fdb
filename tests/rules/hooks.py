"""Two channels hooked into each other: each has its centroid in the mouth of the other."""

from __future__ import annotations

from kerfwise.rule_kit import nest, part

A = [(10, 10), (200, 10), (200, 40), (40, 40), (40, 160), (200, 160), (200, 190), (10, 190)]
B = [(60, 60), (260, 60), (260, 240), (60, 240), (60, 220), (230, 220), (230, 80), (60, 80)]
HOOKS = nest(600, 300, part("A", A), part("B", B))
