"""Outlines that overlap each other, as drawings of illustrators have them: one outline round all, or a notch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Asking, Choice, Question

from .drawing import SNAP_MM, DrawnCurve
from .fit_arcs import FLATTEN_MM, fit_curve
from .layers import counted

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
