"""Parts against each other and against the sheet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Note, Part, Sheet

from .inside import around, thick
from .metal import metal_of
from .tolerances import TOUCH_MM

MOST_NOTES = 100


def overlap_problems(parts: Sequence[Part]) -> tuple[list[str], list[Note]]:
    """Parts that overlap, and notes on pairs that touch.

    Parameters
    ----------
    parts
        Parts whose rings are proper each.
    """
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
