"""Outlines that overlap each other, as drawings of illustrators have them, and holes that reach an edge: notches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Asking, Choice, Question

from .closing import split_at_vertices
from .drawing import SNAP_MM, DrawnCurve
from .fit_arcs import FLATTEN_MM, fit_curve
from .join import join
from .layers import counted
from .sheet import surrounding

LEAST_MM2 = 0.01
"""Outlines that overlap by less are drawn to touch."""


def without_overlaps(rings: Sequence[DrawnCurve], asking: Asking) -> tuple[tuple[DrawnCurve, ...], list[Note]]:
    """The rings with those that overlap each other made one, as is answered; those of a DXF file stay.

    Parts of a DXF file that overlap are parts of a nest that went wrong; shapes of an SVG file are drawn over each
    other for want of better.
    """
    groups = _overlapping(rings)
    if not groups:
        return tuple(rings), []
    answer = asking.ask(_question([rings[k] for k in groups[0]], groups))
    if answer == "refuse":
        return tuple(rings), []
    gone: set[int] = set()
    curves: dict[int, list[DrawnCurve]] = {}
    for group in groups:
        largest = max(group, key=lambda k: rings[k].area.area)
        gone |= set(group)
        curves[largest] = [rings[largest]] if answer == "largest" else _merged(rings, group, largest, answer == "join")
    kept = [one for k, ring in enumerate(rings) for one in (curves.get(k, []) if k in gone else [ring])]
    done = {"join": "made one outline round them", "notch": "the smaller ones cut out of the largest"}
    text = f"{counted(rings[k].layer for k in sorted(gone))} overlap: {done.get(answer, 'the largest of each is kept')}"
    return tuple(kept), [Note("repaired", text)]


def _overlapping(rings: Sequence[DrawnCurve]) -> list[list[int]]:
    """Groups of rings that overlap, by their numbers: none lies in the other."""
    drawn = [k for k, ring in enumerate(rings) if ring.within is not None]
    areas = np.array([rings[k].area for k in drawn], dtype=object)
    if len(areas) < 2:
        return []
    one, other = shapely.STRtree(areas).query(areas, predicate="overlaps")
    first = one < other
    one, other = one[first], other[first]
    common = shapely.area(shapely.intersection(areas[one], areas[other]))
    least = np.minimum(shapely.area(areas[one]), shapely.area(areas[other]))
    deep = (common > LEAST_MM2) & (least - common > LEAST_MM2)
    pairs = np.column_stack([one[deep], other[deep]])
    if not len(pairs):
        return []
    label = weak_components(len(areas), pairs)
    touched = np.unique(pairs)
    return [[drawn[k] for k in touched.tolist() if label[k] == number] for number in np.unique(label[touched]).tolist()]


def _question(first: Sequence[DrawnCurve], groups: Sequence[Sequence[int]]) -> Question:
    count = sum(map(len, groups))
    return Question(
        "overlap",
        f"{count} outlines overlap each other, the first {first[0].place}: what is meant?",
        (
            Choice("join", "one outline round those that overlap"),
            Choice("notch", "the smaller ones are cut out of the largest, as notches"),
            Choice("largest", "the largest of each; the others are left out"),
            Choice("refuse", "not cut: the drawing is refused, to be changed"),
        ),
    )


def _merged(rings: Sequence[DrawnCurve], group: Sequence[int], largest: int, join: bool) -> list[DrawnCurve]:
    """The outlines of all areas together, or of the largest without the others."""
    areas = {k: shapely.make_valid(Curve(rings[k].curve.vertices, True).polygon(FLATTEN_MM)) for k in group}
    if join:
        shape = shapely.union_all(list(areas.values()))
    else:
        others = shapely.union_all([area for k, area in areas.items() if k != largest])
        shape = shapely.difference(areas[largest], others)
    outlines = [
        ring
        for part in shapely.get_parts(shape)
        if part.geom_type == "Polygon"
        for ring in (part.exterior, *part.interiors)
        if ring.length > SNAP_MM and shapely.Polygon(ring).area > LEAST_MM2
    ]
    points = [np.array(ring.coords) for ring in outlines]
    return [replace(rings[largest], curve=fit_curve(each) or Curve.of(each[:-1])) for each in points]


# Holes that have a stretch of their edge in common with their part's outline, or with another hole of it. No metal is
# between: the hole is a notch, or the two are one. Where a notch goes right across, the part is two.

LEAST_SHARED_MM = 0.1
"""Edges that have less than this in common touch at a point."""


def with_notches(rings: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[tuple[DrawnCurve, ...], list[Note]]:
    """The rings with holes that share an edge with their part's outline, or with another hole, made one with that."""
    found = list(rings)
    notes: list[Note] = []
    while (pair := _sharing(found, tolerance_mm)) is not None:
        one, other = pair
        made = _outline_of_both(found[one], found[other], tolerance_mm)
        if made is None:
            break
        places = f"the hole {found[other].place} shares an edge with the line {found[one].place}"
        text = f"{places}: they are cut as one outline"
        notes.append(Note("repaired", text))
        found = [each for k, each in enumerate(found) for each in (made if k == one else () if k == other else (each,))]
    return tuple(found), notes


def _sharing(rings: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[int, int] | None:
    """The first ring and hole that have a stretch of their edge in common, of a part's outline and its holes."""
    if len(rings) < 2:
        return None
    depth, parent = surrounding([ring.area for ring in rings])
    lines = np.array([ring.curve.line() for ring in rings], dtype=object)
    near = np.column_stack(shapely.STRtree(lines).query(lines, predicate="dwithin", distance=SNAP_MM))
    for one, other in near.tolist():
        hole = depth[other] % 2 == 1
        beside = one < other and depth[one] % 2 == 1 and parent[one] == parent[other]
        if hole and (parent[other] == one or beside) and _shared_mm(lines[one], lines[other]) > LEAST_SHARED_MM:
            return one, other
    return None


def _shared_mm(one: shapely.Geometry, other: shapely.Geometry) -> float:
    band = shapely.buffer(one, SNAP_MM, cap_style="flat", quad_segs=2)
    return float(shapely.intersection(other, band).length) - 4 * SNAP_MM


def _outline_of_both(one: DrawnCurve, other: DrawnCurve, tolerance_mm: float) -> list[DrawnCurve] | None:
    """What is left of two rings without the edge that they share; None where that does not close."""
    left = [
        piece
        for ring, beside in ((one, other), (other, one))
        for piece in split_at_vertices(ring, (beside, replace(ring)), tolerance_mm)  # at all of its own, too
        if piece.curve.line().interpolate(0.5, normalized=True).distance(beside.curve.line()) > SNAP_MM
    ]
    joined = join(left, tolerance_mm)
    if joined.chains or not joined.rings:
        return None
    return [replace(one, curve=ring.curve) for ring in joined.rings]
