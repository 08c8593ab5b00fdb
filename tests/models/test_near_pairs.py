"""Which contours heat each other."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.models.heat_prices import near_pairs
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat

HEAT = Heat()
ROW = nest(900, 100, *(part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABCDE")))


def test_only_near_contours_are_pairs() -> None:
    first, second = near_pairs(ROW, HEAT)
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == [(0, 1), (1, 2), (2, 3), (3, 4)]
    marked = nest(
        200, 100, part("A", rect(10, 10, 80, 80), marks=[[(20, 20), (40, 20)]]), part("B", rect(100, 10, 80, 80))
    )
    first, second = near_pairs(marked, HEAT)
    assert [(marked.contours[i].id, marked.contours[j].id) for i, j in zip(first, second, strict=True)] == [
        ("A.outer", "B.outer")
    ]
    assert len(near_pairs(ROW, replace(HEAT, kerf_band_mm=2.0, grid_mm=3.0))[0]) == 0
