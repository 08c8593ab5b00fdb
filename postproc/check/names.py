"""Names of contours as they survive in a program's comments."""

from __future__ import annotations

import re


def folded(name: str) -> str:
    """A contour's id without what a writer replaces: everything but letters, digits and dots.

    Examples
    --------
    >>> folded("Plate (2)-a.hole1")
    'PLATE_2_A.HOLE1'
    """
    return re.sub(r"[^A-Za-z0-9.]+", "_", name).upper()
