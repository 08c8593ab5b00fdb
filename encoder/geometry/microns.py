"""Lengths as whole micrometres, so that every engine adds up the same."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.segment import Point

UM_PER_MM = 1000
GRAZE_UM = 100.0
"""A move that touches an area less deeply than this does not cross it."""
HALF = 0.501
"""What is added before a length in µm is cut off: coordinates carry rounding, and a half must not fall either way."""


def points_um(points_mm: Sequence[Point], home_mm: Point) -> Ints:
    """Points (k, 2) in whole µm, counted from home: a nest that is shifted with its home has the same travel.

    Half a micrometre is rounded away from home, and so is what is less by no more than rounding.

    Examples
    --------
    >>> points_um([(1.0005, -0.0005)], (0.0, 0.0)).tolist(), points_um([(0.3005, 0.1)], (0.1, 0.1)).tolist()
    ([[1001, -1]], [[301, 100]])
    """
    from_home = (np.array(points_mm, dtype=np.float64).reshape(-1, 2) - home_mm) * UM_PER_MM
    whole = np.copysign(np.floor(np.abs(from_home) + HALF), from_home)
    return np.asarray(whole + np.rint(np.array(home_mm) * UM_PER_MM), dtype=np.int64)


def cost_um(weight_mm: float | None) -> int:
    """What a soft statement costs, in whole µm of idle travel; 0 for a hard one."""
    return round((weight_mm or 0.0) * UM_PER_MM)
