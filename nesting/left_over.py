"""What is left of a sheet: its largest rectangle along a side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

import shapely

from kerfwise.encoder.cut import Side
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.scrap.rectangle import saved

NOTHING: Box = (0.0, 0.0, 0.0, 0.0)


def largest_rectangle(sheet: Sheet, parts: Sequence[shapely.Geometry], gap_mm: float) -> Box:
    """The largest rectangle along a side that is `gap_mm` from the boxes around the parts.

    Of a sheet that is no rectangle nothing is said.

    Examples
    --------
    >>> largest_rectangle(Sheet.rectangle(100, 50), [shapely.box(0, 0, 40, 50)], 5.0)
    (45.0, 0.0, 100.0, 50.0)
    """
    x0, y0, x1, y1 = sheet.bounds
    if abs(sheet.polygon.area - (x1 - x0) * (y1 - y0)) > 1e-6 * sheet.polygon.area:
        return NOTHING
    blocks = [(a - gap_mm, b - gap_mm, c + gap_mm, d + gap_mm) for a, b, c, d in (part.bounds for part in parts)]
    found = [saved((x0, y0, x1, y1), blocks, side, 0.0)[0] for side in get_args(Side)]
    return max(found, key=lambda box: (box[2] - box[0]) * (box[3] - box[1]))
