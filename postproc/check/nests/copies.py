"""Whether a part in a nest is a copy of one that was drawn, and how it lies: by its shape alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely import affinity

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Part

from .asked import AskedPart

SAME_MM = 0.02
"""Outlines no further apart than this are the same: each is chords within 0.01 mm."""


def wrong_copy(part: Part, asked: AskedPart) -> str | None:
    """Why a part is no copy of what was drawn, in a clause; None where it is one, turned and mirrored as is allowed."""
    counts = [(len(p.holes), len(p.marks)) for p in (part, asked.part)]
    if counts[0] != counts[1]:
        return f"has {counts[0][0]} holes and {counts[0][1]} marks, and the drawing {counts[1][0]} and {counts[1][1]}"
    if [tab.width_mm for tab in part.tabs] != [tab.width_mm for tab in asked.part.tabs]:
        return "has other tabs than the drawing"
    if lost := _arcs_lost(part, asked.part):
        return lost
    turns = _any_turn(part, asked.part) if asked.turns_deg is None else asked.turns_deg
    if any(_matches(part, laid) for laid in _ways(asked, turns, (False, True) if asked.mirror else (False,))):
        return None
    if any(_matches(part, laid) for laid in _ways(asked, turns, (True,))):
        return "is mirrored, which is not allowed"
    if any(_matches(part, laid) for laid in _ways(asked, _any_turn(part, asked.part), (False, True))):
        return "is turned as it may not be"
    return "has another shape than the drawing"


def _ways(asked: AskedPart, turns_deg: Sequence[float], flips: Sequence[bool]) -> Iterator[list[shapely.Geometry]]:
    """The lines and tabs of the drawn part in each way that it may lie, the outline first."""
    drawn = _drawn(asked.part)
    for flip in flips:
        for turn in turns_deg:
            flipped = [affinity.scale(line, -1, 1, origin=(0, 0)) if flip else line for line in drawn]
            yield [affinity.rotate(line, turn, origin=(0, 0)) for line in flipped]


def _matches(part: Part, drawn: Sequence[shapely.Geometry]) -> bool:
    """Whether all contours and tabs coincide once the outlines are laid over each other."""
    lines = _drawn(part)
    x, y = _corner(lines[0])
    a, b = _corner(drawn[0])
    over = [affinity.translate(line, x - a, y - b) for line in drawn]
    return all(
        abs(one.length - other.length) <= SAME_MM * 10 and shapely.hausdorff_distance(one, other) <= SAME_MM
        for one, other in zip(lines, over, strict=True)
    )


def _drawn(part: Part) -> list[shapely.Geometry]:
    """The lines of the contours, the outline first, and the middles of the tabs."""
    return [*(contour.line for contour in _contours(part)), *(shapely.Point(tab.at) for tab in part.tabs)]


def _corner(line: shapely.LineString) -> tuple[float, float]:
    """Lower left corner of the box around a line."""
    x0, y0, _, _ = line.bounds
    return x0, y0


def _contours(part: Part) -> list[Contour]:
    return [part.outer, *part.holes, *part.marks]


def _arcs_lost(part: Part, drawn: Part) -> str | None:
    for mine, its in zip(_contours(part), _contours(drawn), strict=True):
        here, there = _arcs(mine.curve), _arcs(its.curve)
        if here != there:
            return f"has {here} arcs in {mine.kind}, and the drawing {there}"
    return None


def _arcs(curve: Curve) -> int:
    return sum(segment.is_arc for segment in curve.segments)


def _any_turn(part: Part, drawn: Part) -> list[float]:
    """The turns that lay the first side of the one along any side of the other that is as long."""
    one, other = (np.diff(np.asarray(p.outer.line.coords), axis=0) for p in (drawn, part))
    length = math.hypot(*one[0])
    alike = [side for side in other.tolist() if abs(math.hypot(*side) - length) < SAME_MM]
    begin = math.atan2(one[0][1], one[0][0])
    return sorted({round(math.degrees(math.atan2(dy, dx) - begin), 6) for dx, dy in alike})
