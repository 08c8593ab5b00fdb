"""Overheats by the contour that lies nearest."""

from __future__ import annotations

import numpy as np

from kerfwise.models.physics.heat import HeatResult, simulate
from kerfwise.models.physics.heat.grid import Regions, hot_contours, make_grid
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.tests.models.physics.heat.paths import rounds

ROW = nest(500, 120, part("A", rect(20, 20, 60, 60), marks=[[(40, 60), (70, 60)]]), part("B", rect(400, 20, 60, 60)))


def burnt(x: float, limit_c: float) -> HeatResult:
    """Twice round a square of 62 mm whose left side is at x."""
    ring = [(x, 19.0), (x + 62, 19.0), (x + 62, 81.0), (x, 81.0)]
    return simulate(ROW, rounds([ring, ring], 20.0), Heat(limit_c=limit_c, absorbed_power_w=2500.0), 6.0)


def test_marks_are_not_hot() -> None:
    assert [ROW.contours[k].id for k in hot_contours(ROW)] == ["A.outer", "B.outer"]


def test_overheats_are_counted_where_they_are() -> None:
    regions = Regions(ROW, make_grid(ROW, Heat().grid_mm))
    for x, name in ((19.0, "A.outer"), (399.0, "B.outer")):
        found = burnt(x, 80.0)
        counts = regions.count(found)
        assert counts[ROW.index[name]] == counts.sum() == found.overheats > 0
    assert np.array_equal(regions.count(burnt(19.0, 5000.0)), [0, 0, 0])
