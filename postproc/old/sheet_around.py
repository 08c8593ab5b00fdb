"""The sheet that burns lie on: the one that is given, or one laid around them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Note, Sheet
from kerfwise.postproc.check.reader.program import Burn

MARGIN_MM = 20.0
"""Sheet that is assumed around the burns where nobody says how large it is."""
_OFF_MM = 1.0
"""How far beyond a sheet's edge the torch's path may come, as it does where parts stand on the edge."""


def sheet_around(
    burns: Sequence[Burn], sheet_mm: tuple[float, float] | None, zero: Point | None
) -> tuple[Sheet, tuple[Note, ...]]:
    """The sheet of a given size from `zero` on, or else one around the burns, with a note that says so.

    Raises
    ------
    InputError
        If the sheet given does not hold the burns.
    """
    bounds = np.array([burn.path.line().bounds for burn in burns])
    (x0, y0), (x1, y1) = bounds[:, :2].min(axis=0).tolist(), bounds[:, 2:].max(axis=0).tolist()
    if sheet_mm is None:
        m = MARGIN_MM
        left, low = (x0 - m, y0 - m) if zero is None else (min(zero[0], x0), min(zero[1], y0))
        left, low, right, high = (round(v, 3) for v in (left, low, x1 + m, y1 + m))
        text = (
            f"the program does not say how large the sheet is: {right - left:g} x {high - low:g} mm are assumed, {m:g} "
            "mm around what it cuts; rules on the sheet's edges mean little (--sheet WxH gives it)"
        )
        return Sheet(_rectangle(left, low, right, high), stated=False), (Note("warning", text),)
    (w, h), (x, y) = sheet_mm, zero or (0.0, 0.0)
    if x0 < x - _OFF_MM or y0 < y - _OFF_MM or x1 > x + w + _OFF_MM or y1 > y + h + _OFF_MM:
        raise InputError(
            f"--sheet {w:g}x{h:g}: the program cuts from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}), beyond that sheet "
            f"from ({x:g}, {y:g}) on; give its size, or leave it out"
        )
    return Sheet(_rectangle(x, y, x + w, y + h)), ()


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> Curve:
    return Curve.of([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
