"""Lines that cut up the skeleton: open, on the sheet, off the parts, and none across another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Contour, Part, Sheet

from .rings import place, speck
from .tolerances import TOUCH_MM

OVERSHOOT_MM = 1.0
"""A line that ends on another may go on beyond it by so much."""


def scrap_problems(scrap: Sequence[Contour], parts: Sequence[Part], sheet: Sheet) -> list[str]:
    """A sentence for each scrap line that cannot be cut where it is drawn.

    Parameters
    ----------
    scrap
        The lines.
    parts
        Parts whose rings are proper each.
    sheet
        A sheet whose rings are proper.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> plate = nest(200, 100, part("A", rect(50, 20, 50, 50)), scrap=[[(0, 40), (70, 40)], [(150, 0), (150, 110)]])
    >>> print(*scrap_problems(plate.scrap, plate.parts, plate.sheet), sep="\\n")
    scrap2 runs 10.000 mm off the sheet at (150.0, 105.0): end it at the edge
    scrap1 runs through part A at (60.0, 40.0): end it before the part, or lead it round
    """
    problems = {line.id: text for line in scrap if (text := _by_itself(line))}
    sound = [line for line in scrap if line.id not in problems]
    found = [*_off_the_sheet(sound, sheet), *_through_parts(sound, parts), *_across_each_other(sound)]
    return [*problems.values(), *found]


def _by_itself(line: Contour) -> str | None:
    if speck(line.curve):
        return f"{line.id} has no length, {place(line.curve)}: remove it"
    first, last = line.curve.vertices[0, :2], line.curve.vertices[-1, :2]
    if line.curve.closed or np.hypot(*(last - first)) <= TOUCH_MM:
        return f"{line.id} is closed, {place(line.curve)}: a scrap line goes from one place to another"
    if not line.line.is_simple:
        return f"{line.id} crosses itself, {place(line.curve)}: draw it as several lines"
    return None


def _off_the_sheet(lines: Sequence[Contour], sheet: Sheet) -> list[str]:
    metal = shapely.buffer(sheet.polygon, TOUCH_MM, quad_segs=2)
    shapely.prepare(metal)
    found = []
    for line in lines:
        if not shapely.covers(metal, line.line):
            off = shapely.difference(line.line, sheet.polygon)
            found.append(f"{line.id} runs {off.length:.3f} mm off the sheet {_on(off)}: end it at the edge")
    return found


def _through_parts(lines: Sequence[Contour], parts: Sequence[Part]) -> list[str]:
    areas = shapely.buffer(np.array([p.outer.polygon for p in parts], dtype=object), -TOUCH_MM, quad_segs=2)
    drawn = np.array([line.line for line in lines], dtype=object)
    if not len(drawn) or not len(areas):
        return []
    row, other = shapely.STRtree(areas).query(drawn, predicate="intersects")
    return [
        f"{lines[k].id} runs through part {parts[p].id} {_on(shapely.intersection(drawn[k], areas[p]))}: end it before "
        "the part, or lead it round"
        for k, p in sorted(zip(row.tolist(), other.tolist(), strict=True))
    ]


def _across_each_other(lines: Sequence[Contour]) -> list[str]:
    """A line may end on another; where two cross, one piece would be cut when it is loose already."""
    drawn = np.array([line.line for line in lines], dtype=object)
    row, other = shapely.STRtree(drawn).query(drawn, predicate="intersects")
    found = []
    for i, j in sorted(zip(row.tolist(), other.tolist(), strict=True)):
        if i >= j:
            continue
        common = shapely.intersection(drawn[i], drawn[j])
        ends = shapely.points([c.vertices[k, :2] for c in (lines[i].curve, lines[j].curve) for k in (0, -1)])
        near = shapely.buffer(shapely.union_all(ends), OVERSHOOT_MM)
        if common.length > OVERSHOOT_MM:
            found.append(f"{lines[i].id} and {lines[j].id} run on each other {_on(common)}: draw the line once")
        elif not shapely.covers(near, common):
            crossing = shapely.difference(common, near)
            found.append(f"{lines[i].id} and {lines[j].id} cross {_on(crossing)}: let one of them end at the other")
    return found


def _on(shape: shapely.Geometry) -> str:
    """A place on a shape, for messages."""
    if shape.length:
        part = max(shapely.get_parts(shape), key=lambda p: p.length)
        at = shapely.line_interpolate_point(part, 0.5, normalized=True)
    else:
        at = shapely.point_on_surface(shape)
    return f"at ({at.x:z.1f}, {at.y:z.1f})"
