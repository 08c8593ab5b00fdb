"""Candidates of marks and of scrap lines, which are neither compensated nor led into."""

from __future__ import annotations

import numpy as np

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour

from .candidate import Candidate, LeadOptions

CLOSED_ENTRIES = 4
"""Where a closed mark may be begun."""


def mark_candidates(index: int, contour: Contour, options: LeadOptions) -> list[Candidate]:
    """An open line from either end ("ccw" along it as drawn, "cw" against it), a closed mark from a few points.

    The lead-out of an open line is its other end alone, so that a cut made of it knows where it ends.
    """
    curve, length_mm = contour.curve, contour.curve.length_mm
    found = []
    if curve.closed:
        count = min(options.entries, CLOSED_ENTRIES)
        at_mm = [length_mm * k / count for k in range(count)]
        locked = options.entry_points.get(contour.id)
        if locked is not None:
            at_mm = [curve.project(locked)[0], *at_mm]
        for s_mm in at_mm:
            at = curve.point_at(s_mm)
            for direction in options.directions[contour.kind]:
                found.append(Candidate(index, s_mm, at, direction, at, None, None, at, length_mm))
        return found
    for direction in options.directions[contour.kind]:
        s_mm = 0.0 if direction == "ccw" else length_mm
        at, end = curve.point_at(s_mm), curve.point_at(length_mm - s_mm)
        off = Curve(np.array([[*end, 0.0]]), closed=False)
        found.append(Candidate(index, s_mm, at, direction, at, None, off, end, length_mm))
    return found
