"""A nest is checked once, when it is read; from there on everyone may trust it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.tolerances import TOUCH_MM

from .contour_checks import (
    around,
    coincident,
    contour_problems,
    drop_duplicates,
    hole_problems,
    mark_notes,
    metal_of,
    place,
    sheet_ring_problems,
    speck,
    thick,
)
from .errors import InputError
from .nest import Contour, Nest, Note, Part, Sheet

__all__ = ["coincident", "problems_error", "validated"]


MOST_DETAILS = 200


def validated(nest: Nest) -> Nest:
    """The nest without contours drawn twice, every contour a proper ring (or mark) in its place.

    What is only doubtful (contours that touch, lines drawn twice, marks off their part) is added to the notes. Raises
    InputError one error for all that is wrong, with a line each in `details`: rings that cross themselves or enclose
    nothing, holes outside their part, parts that overlap or lie off the sheet, scrap lines through parts.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> validated(nest(100, 50, part("A", rect(5, 5, 60, 20)), part("B", rect(40, 5, 70, 20))))
    Traceback (most recent call last):
    kerfwise.encoder.errors.InputError: the nest cannot be cut as it is drawn: 2 problems
      - A.outer and B.outer overlap by 500.000 mm² at (52.500, 15.000): move one of the parts
      - B.outer reaches 10.000 mm off the sheet at (105.000, 15.000): move the part or give a larger sheet
    """
    parts, notes = drop_duplicates(nest.parts)
    by_contour = contour_problems([c for p in parts for c in p])
    problems = [*sheet_ring_problems(nest.sheet), *by_contour.values()]
    sound = [p for p in parts if not any(c.id in by_contour for c in p)]
    for found, said in (hole_problems(sound), overlap_problems(sound)):
        problems += found
        notes += said
    if not sheet_ring_problems(nest.sheet):
        problems += sheet_problems(sound, nest.sheet)
        problems += scrap_problems(nest.scrap, sound, nest.sheet)
    if problems:
        raise problems_error("the nest cannot be cut as it is drawn", problems)
    return replace(nest, parts=parts, notes=(*nest.notes, *notes, *mark_notes(parts)))


def problems_error(message: str, problems: list[str]) -> InputError:
    """One error for a list of problems; a very long list is cut short and says so."""
    count = f"{len(problems)} problem{'s' if len(problems) != 1 else ''}"
    shown = problems[:MOST_DETAILS]
    if len(problems) > MOST_DETAILS:
        shown.append(f"… and {len(problems) - MOST_DETAILS} more")
    return InputError(f"{message}: {count}", details=tuple(shown))


# Parts against each other and against the sheet.

MOST_NOTES = 5


def overlap_problems(parts: Sequence[Part]) -> tuple[list[str], list[Note]]:
    """Parts that overlap, and notes on pairs that touch. `parts`: parts whose rings are proper each."""
    metal = metal_of(parts)
    i, j = shapely.STRtree(metal).query(metal, predicate="dwithin", distance=TOUCH_MM)
    i, j = i[i < j], j[i < j]
    problems, touching = [], []
    for a, b, area in zip(i.tolist(), j.tolist(), shapely.intersection(metal[i], metal[j]), strict=True):
        if thick(area):
            problems.append(
                f"{parts[a].outer.id} and {parts[b].outer.id} overlap by {area.area:.3f} mm² {around(area)}: "
                "move one of the parts"
            )
        else:
            touching.append((parts[a], parts[b]))
    notes = [_touch(one, other) for one, other in touching[:MOST_NOTES]]
    if len(touching) > MOST_NOTES:
        notes.append(Note("warning", f"{len(touching) - MOST_NOTES} more pairs of parts touch"))
    return problems, notes


def _touch(one: Part, other: Part) -> Note:
    """Names the two contours that touch; one of them may be the hole that the other part lies in."""
    nearest = min(
        ((a, b) for a in (one.outer, *one.holes) for b in (other.outer, *other.holes)),
        key=lambda pair: (round(shapely.distance(pair[0].line, pair[1].line), 6), pair[0].id, pair[1].id),
    )
    ids = (nearest[0].id, nearest[1].id)
    text = f"{ids[0]} and {ids[1]} touch: parts {one.id} and {other.id} leave no room for the kerf between them"
    return Note("warning", text, ids)


def sheet_problems(parts: Sequence[Part], sheet: Sheet) -> list[str]:
    """Parts that do not lie on the metal of the sheet; along its edge is on it."""
    stock = sheet.polygon
    shapely.prepare(stock)
    metal = metal_of(parts)
    off = np.flatnonzero(~shapely.covered_by(metal, stock))
    problems = []
    for k, area in zip(off.tolist(), shapely.difference(metal[off], stock), strict=True):
        if thick(area):
            reach = shapely.distance(shapely.points(shapely.get_coordinates(area)), stock).max()
            how_far = f"reaches {reach:.3f} mm off the sheet" if reach > 0 else "lies over a hole of the sheet"
            problems.append(f"{parts[k].outer.id} {how_far} {around(area)}: move the part or give a larger sheet")
    return problems


# Lines that cut up the skeleton: open, on the sheet, off the parts, and none across another.

OVERSHOOT_MM = 1.0
"""A line that ends on another may go on beyond it by so much."""


def scrap_problems(scrap: Sequence[Contour], parts: Sequence[Part], sheet: Sheet) -> list[str]:
    """A sentence for each scrap line that cannot be cut where it is drawn.

    `parts`: parts whose rings are proper each. `sheet`: a sheet whose rings are proper.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(200, 100, part("A", rect(50, 20, 50, 50)), scrap=[[(0, 40), (70, 40)], [(150, 0), (150, 110)]])
    >>> print(*scrap_problems(plate.scrap, plate.parts, plate.sheet), sep="\\n")
    scrap2 runs 10.000 mm off the sheet at (150.0, 105.0): end it at the edge
    scrap1 runs through part A at (60.0, 40.0): end it before the part, or lead it round
    """
    problems = {line.id: text for line in scrap if (text := _by_itself(line))}
    sound = [line for line in scrap if line.id not in problems]
    found = [*_lines_off_sheet(sound, sheet), *_through_parts(sound, parts), *_crossing_lines(sound)]
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


def _lines_off_sheet(lines: Sequence[Contour], sheet: Sheet) -> list[str]:
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


def _crossing_lines(lines: Sequence[Contour]) -> list[str]:
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
