"""Where on the sheet the cutting heat goes (Petunin 2009, fig. 2, rule d)."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.segment import Box

from .facts import SIDES
from .outlines import ROUNDING_MM, SAME_SHARE, Outlines
from .sides import AWAY, AXIS


def heat(outlines: Outlines, sheet_mm: Box) -> tuple[Floats, Ints]:
    """Cut length, mm, and number of small parts in the half of the sheet at each side, in the order of SIDES.

    Marks are left out: they do not cut through. So are scrap lines: they are cut when all parts are out. A part counts
    as small when its outer contour encloses no more than the median part does, and lies in the half that has its
    centroid. What lies on the line between two halves belongs half to each, a part to neither.
    """
    outers = outlines.outers
    area = outlines.area_mm2[outers]
    small = outers[area <= np.median(area) * (1 + SAME_SHARE)] if len(outers) else outers
    through = ~(outlines.is_mark | outlines.is_scrap)[outlines.chord_contour]
    start, end = outlines.chord_start[through], outlines.chord_end[through]
    length_mm = np.hypot(*(end - start).T)
    cut_mm, parts = [], []
    for side in SIDES:
        axis, away = AXIS[side], AWAY[side]
        middle = away * (sheet_mm[axis] + sheet_mm[axis + 2]) / 2
        cut_mm.append(float(length_mm @ _share_below(away * start[:, axis], away * end[:, axis], middle)))
        parts.append(int(np.count_nonzero(away * outlines.centroid[small, axis] < middle - ROUNDING_MM)))
    return np.array(cut_mm), np.array(parts, dtype=np.int64)


def _share_below(a: Floats, b: Floats, limit: float) -> Floats:
    """How much of each stretch from a to b lies below the limit; half of one that lies on it."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    level = high - low <= ROUNDING_MM
    share = np.clip((limit - low) / np.where(level, 1.0, high - low), 0.0, 1.0)
    side = np.where(np.abs(limit - low) <= ROUNDING_MM, 0.0, np.sign(limit - low))
    return np.where(level, (side + 1) / 2, share)
