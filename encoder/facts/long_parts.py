"""Which parts are long: the ones that heat bends most (Petunin 2009, section 2.2)."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Bools

from .outlines import SAME_SHARE, Outlines


def long_parts(outlines: Outlines, long_ratio: float) -> Bools:
    """Array (n,): outer contours whose minimum rotated rectangle has one side at least `long_ratio` × the other."""
    outers = outlines.outers
    rectangles = shapely.oriented_envelope(outlines.line[outers])
    corners = shapely.get_coordinates(rectangles).reshape(-1, 5, 2)
    one, other = (np.hypot(*(corners[:, k + 1] - corners[:, k]).T) for k in (0, 1))
    is_long = np.zeros(outlines.n, dtype=bool)
    # Relative to the ratio, so that a part drawn exactly 4 : 1 counts at any angle.
    is_long[outers] = np.maximum(one, other) >= long_ratio * np.minimum(one, other) * (1 - SAME_SHARE)
    return is_long
