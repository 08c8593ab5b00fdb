"""Each contour by itself: closed rings must enclose something, and cross nothing of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.meetings import MOST_MEETINGS, meets_itself_too_often
from kerfwise.encoder.nest import Contour, Sheet

from .tolerances import TOUCH_MM


def flat(curve: Curve) -> bool:
    """True for a ring that encloses no area: on average no wider than a touch.

    Examples
    --------
    >>> flat(Curve.of([(0, 0), (50, 0)])), flat(Curve.of([(0, 0), (9, 9), (9, 0), (0, 9)]))
    (True, False)
    """
    least_mm2 = TOUCH_MM * curve.length_mm / 2
    if len(curve.segments) < 2:
        return True
    # the loops of a figure eight cancel out in the signed area
    return abs(curve.signed_area_mm2) <= least_mm2 and enclosed(curve).area <= least_mm2


def enclosed(curve: Curve) -> shapely.Geometry:
    """The area inside a closed curve, made valid where the curve crosses itself; empty for a mere line.

    Raises
    ------
    InputError
        If it crosses itself so often that making it valid would take minutes.
    """
    points = curve.flatten()
    if len(points) < 3:
        return shapely.Polygon()
    polygon = shapely.Polygon(points)
    if polygon.is_valid:
        return polygon
    _expect_few_crossings(curve, points)
    return shapely.make_valid(polygon)


def _expect_few_crossings(curve: Curve, points: Floats) -> None:
    if meets_itself_too_often(points, closed=True, most=MOST_MEETINGS):
        raise InputError(
            f"the ring that starts {place(curve)} crosses or touches itself more than {MOST_MEETINGS} times: no "
            "part is drawn so; correct it in CAD, or leave its layer out (drawing.layers.ignore)"
        )


def speck(curve: Curve) -> bool:
    """True for a curve that is as good as a point."""
    return not curve.segments or curve.length_mm <= TOUCH_MM


def contour_problems(contours: Sequence[Contour]) -> dict[str, str]:
    """Contour id → what is wrong with it, for every mark without length and every ring that is no proper one."""
    problems = {
        c.id: f"{c.id} has no length, {place(c.curve)}: remove it, or try {REPAIR}, which removes it"
        for c in contours
        if c.kind == "mark" and speck(c.curve)
    }
    rings = [c for c in contours if c.kind != "mark"]
    problems |= {
        c.id: f"{c.id} encloses no area, {place(c.curve)}: remove it, or try {REPAIR}, which removes it"
        for c in rings
        if flat(c.curve)
    }
    sound = [c for c in rings if c.id not in problems]
    for k in np.flatnonzero(~shapely.is_valid(np.array([c.polygon for c in sound], dtype=object))).tolist():
        problems[sound[k].id] = f"{sound[k].id} {_crossing(sound[k].polygon)}: correct it in CAD, or try {REPAIR}"
    return {c.id: problems[c.id] for c in contours if c.id in problems}


def sheet_ring_problems(sheet: Sheet) -> list[str]:
    """A line for each ring of the sheet itself that is no proper one, and for a hole that is not in it."""
    named = [("the sheet's outline", sheet.outline)]
    named += [(f"the sheet's hole {k}", hole) for k, hole in enumerate(sheet.holes, 1)]
    problems = []
    for name, curve in named:
        if flat(curve):
            problems.append(f"{name} encloses no area, {place(curve)}: draw the sheet again")
        elif not curve.polygon().is_valid:
            problems.append(f"{name} {_crossing(curve.polygon())}: draw the sheet again")
    if not problems and not sheet.polygon.is_valid:
        problems.append(f"the sheet's holes overlap or reach out of it ({shapely.is_valid_reason(sheet.polygon)})")
    return problems


def place(curve: Curve) -> str:
    """Where a curve starts, for messages."""
    x, y = curve.vertices[0, :2].tolist()
    return f"at ({x:.3f}, {y:.3f})"


def _crossing(polygon: shapely.Polygon) -> str:
    """Shapely's reason, as "Ring Self-intersection[12.5 3]", in the words of the trade."""
    reason = shapely.is_valid_reason(polygon)
    touches = reason.startswith("Ring")
    found = re.search(r"\[(\S+) (\S+)\]", reason)
    where = f" at ({float(found[1]):.3f}, {float(found[2]):.3f})" if found else ""
    return f"{'touches' if touches else 'crosses'} itself{where}"
