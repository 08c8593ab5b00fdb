"""Which contours heat each other: those are the pairs whose order has a price in overheats."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat.regions import hot_contours
from kerfwise.rules.profile.heat_section import Heat

NEAR_BANDS = 6.0
"""Contours nearer than so many bands of the kerf heat each other."""


def near_pairs(nest: Nest, heat: Heat) -> tuple[Ints, Ints]:
    """Contours that heat each other, each pair once; marks heat nothing."""
    hot = hot_contours(nest)
    if not len(hot):
        return hot, hot
    lines = [nest.contours[k].line for k in hot]
    within_mm = NEAR_BANDS * max(heat.kerf_band_mm, heat.grid_mm)
    a, b = shapely.STRtree(lines).query(lines, "dwithin", distance=within_mm)
    pairs = np.unique(np.column_stack([a, b])[a < b], axis=0)
    return hot[pairs[:, 0]], hot[pairs[:, 1]]
