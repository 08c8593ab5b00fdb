"""The four sides of a sheet as directions: everything that follows the start side reads these tables."""

from __future__ import annotations

from kerfwise.encoder.cut import Side
from kerfwise.encoder.geometry.segment import Box

from .outlines import SAME_SHARE

AXIS: dict[Side, int] = {"left": 0, "right": 0, "bottom": 1, "top": 1}
"""The coordinate (0 for x, 1 for y) that changes as one walks away from the side."""

AWAY: dict[Side, int] = {"left": 1, "right": -1, "bottom": 1, "top": -1}
"""+1 where that coordinate grows on the way into the sheet, -1 where it shrinks."""

OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}


def narrow_sides(bounds_mm: Box) -> tuple[Side, Side]:
    """The two short sides of the sheet's bounding rectangle; left and right of a square, a millionth more or less.

    Examples
    --------
    >>> narrow_sides((0, 0, 6000, 1500))
    ('left', 'right')
    """
    xmin, ymin, xmax, ymax = bounds_mm
    return ("left", "right") if xmax - xmin >= (ymax - ymin) * (1 - SAME_SHARE) else ("bottom", "top")
