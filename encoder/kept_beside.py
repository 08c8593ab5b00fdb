"""Paths of the torch that run beside their contours, stretch by stretch: how far the contours lie from them.

A path has a stretch beside each line and arc of its contour, and arcs of half a kerf around some corners. A line whose
two ends lie near the ends of another line is as near to that all along; an arc lies as far from one about the same
centre as their radii differ, and beyond the ends of that no farther than its own ends do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays

EXACT_MM = 1e-6
"""Centres and radii that are the same differ by no more."""
ALIKE_RAD = 1.0
"""Arcs that turn through no more than this more or less go the same way round their centre."""


def kept_beside(curves: Sequence[Curve], paths: Sequence[Curve], half_mm: float, most_mm: float) -> Bools:
    """Which closed curves surely lie nowhere farther than `most_mm` from their paths; False says nothing yet.

    Parameters
    ----------
    curves, paths
        One path for each curve, beginning beside the curve's first line or arc.
    half_mm
        Half the kerf: the radius of what goes round a corner.
    most_mm
        What is asked.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)])
    >>> around = Curve.of([(-1, -1), (10, -1), (10, 10), (-1, 10)])
    >>> kept_beside([square], [around], 1.0, 1.5).tolist(), kept_beside([square], [around], 1.0, 1.4).tolist()
    ([True], [False])
    """
    if not curves:
        return np.zeros(0, dtype=np.bool_)
    drawn, cut = SegmentArrays.of(*curves), SegmentArrays.of(*paths)
    around = (cut.bulge != 0) & (np.abs(cut.radius_mm - half_mm) < EXACT_MM)
    beside = np.append(0, np.cumsum(~around))[cut.first]
    count = np.diff(drawn.first)
    paired = (np.diff(beside) == count) & (count > 0)
    of = np.repeat(np.arange(len(curves)), count)
    rows = np.flatnonzero(paired[of])
    stretch = np.flatnonzero(~around)[beside[of[rows]] + rows - drawn.first[of[rows]]]
    far = np.zeros(len(of), dtype=np.bool_)
    far[rows] = ~_near_all_along(drawn, rows, cut, stretch, most_mm)
    kept = paired & (np.bincount(of[far], minlength=len(curves)) == 0)
    return np.asarray(kept, dtype=np.bool_)


def _near_all_along(drawn: SegmentArrays, rows: Ints, cut: SegmentArrays, stretch: Ints, most_mm: float) -> Bools:
    """Whether lines and arcs lie nowhere farther than so much from the stretches beside them."""
    ends = ((drawn.start[rows], cut.start[stretch]), (drawn.end[rows], cut.end[stretch]))
    centre, cut_centre = drawn.centre[rows], cut.centre[stretch]
    near = np.ones(len(rows), dtype=np.bool_)
    ahead = np.ones(len(rows), dtype=np.bool_)  # seen from the centre, less than a right angle from each other
    for one, other in ends:
        near &= np.hypot(*(one - other).T) <= most_mm
        ahead &= ((one - centre) * (other - cut_centre)).sum(axis=1) > 0
    bulge, cut_bulge = drawn.bulge[rows], cut.bulge[stretch]
    lines = (bulge == 0) & (cut_bulge == 0)
    off_mm = np.hypot(*(centre - cut_centre).T)
    wider_mm = np.abs(drawn.radius_mm[rows] - cut.radius_mm[stretch])
    alike = (bulge * cut_bulge > 0) & (4 * np.abs(np.arctan(bulge) - np.arctan(cut_bulge)) < ALIKE_RAD)
    arcs = alike & ahead & (off_mm < EXACT_MM) & (wider_mm + EXACT_MM <= most_mm)
    return np.asarray(near & (lines | arcs), dtype=np.bool_)
