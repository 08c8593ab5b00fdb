"""Lengths as whole micrometres, and how close counts as touching, as the same, or as on the path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Ints

from .segment import Point

# Lengths as whole micrometres, so that every engine adds up the same.

UM_PER_MM = 1000
ROUNDING_MM = 1e-6
"""Lengths that differ by less are equal: no fact may hang on the last bit of a coordinate."""
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


TOUCH_MM = 0.01
"""Metal thinner than this is none, and contours nearer than this touch; curves are flattened as finely."""

COINCIDE_MM = 0.02
"""Two curves no further apart than this everywhere are one line drawn twice (each is flattened within 0.01 mm)."""


# How far a torch's path may be from where it belongs, and how deep a kerf may reach into the metal of a part.

TOLERANCE_MM = 0.05
"""How far a torch path may be from where it belongs; less where the kerf is so thin that sides would be confused."""


def tolerance_mm(kerf_mm: float) -> float:
    """The tolerance at this kerf: 0.05 mm, a quarter of a kerf under 0.2 mm, but never less than 0.02 mm.

    Examples
    --------
    >>> tolerance_mm(1.5), tolerance_mm(0.1), tolerance_mm(0.0)
    (0.05, 0.025, 0.05)
    """
    return min(TOLERANCE_MM, max(kerf_mm / 4, 0.02)) if kerf_mm > 0 else TOLERANCE_MM
