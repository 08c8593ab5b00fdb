"""Where the number (or the name) of every contour stands: inside the metal or the hole that it belongs to."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest, Part

from .text_room import TextPlace, find_room

_ENOUGH = 0.8  # share of the wanted size with which no better place is looked for
_FINE = 0.02  # of the wanted size: how far an outline may be simplified
_NAME = 0.85  # of the numbers' size
_LEAST = 1 / 16  # of the wanted size: below that labels may overlap
_TOUCH_MM2 = 1e-9
_BESIDE = 2.5  # a hole's number outside it stands within so many font sizes


@dataclass(frozen=True, slots=True)
class Label:
    """What to write for a contour, the point it should be near, if any, and the leads it should keep clear of."""

    text: str
    near: Point | None = None
    obstacles: tuple[Curve, ...] = ()


def place_labels(
    nest: Nest,
    labels: Mapping[str, Label],
    wanted_mm: float,
    window: shapely.Polygon | None = None,
) -> dict[str, TextPlace]:
    """The place of every label by contour id; contours outside the window have none.

    An outer contour's label lies in the part's metal; a hole's lies in the hole, clear of parts nested there and of
    its lead, or in the metal beside the hole where that is roomier; a mark's lies in the metal beside the mark, a scrap
    line's in the skeleton beside the line. No two overlap. Font sizes are `wanted_mm` where there is room; in a crowded
    part the holes' labels are placed before the outer contour's or after it, whichever leaves the smallest of them
    larger.
    """
    filled = _nested_metal(nest, [h for p in nest.parts for h in p.holes if h.id in labels])
    places: dict[str, TextPlace] = {}
    for part in nest.parts:
        size_mm, tried = wanted_mm, _of_part(part, labels, wanted_mm, filled, window)
        while _meet(tried) and size_mm > wanted_mm * _LEAST:
            size_mm /= 2.0
            tried = _of_part(part, labels, size_mm, filled, window)
        places |= tried
    return places | _in_the_skeleton(nest, labels, wanted_mm, window)


def _of_part(
    part: Part,
    labels: Mapping[str, Label],
    wanted_mm: float,
    filled: Mapping[str, shapely.Geometry],
    window: shapely.Polygon | None,
) -> dict[str, TextPlace]:
    metal = _free_metal(part, wanted_mm, window)
    in_holes = {
        hole.id: _in_hole(hole, labels[hole.id], wanted_mm, filled.get(hole.id), window)
        for hole in part.holes
        if hole.id in labels
    }
    tried = _place_part(part, metal, labels, wanted_mm, in_holes, outer_first=False) or {}
    if in_holes and (above_mm := _smallest(tried)) < _ENOUGH * wanted_mm:  # without holes it would be the same again
        return _place_part(part, metal, labels, wanted_mm, in_holes, outer_first=True, above_mm=above_mm) or tried
    return tried


def _meet(places: Mapping[str, TextPlace]) -> bool:
    """Whether labels overlap: large ones leave no metal for others."""
    if len(places) < 2:
        return False
    boxes = np.array([place.box() for place in places.values()])
    one, other = shapely.STRtree(boxes).query(boxes)
    pairs = one < other
    return bool((shapely.area(shapely.intersection(boxes[one[pairs]], boxes[other[pairs]])) > _TOUCH_MM2).any())


def place_names(
    nest: Nest, numbers: Mapping[str, TextPlace], wanted_mm: float, least_mm: float
) -> dict[str, TextPlace]:
    """Where the name of each part stands in the metal that the numbers leave, by part id, where it has room."""
    taken = shapely.STRtree([place.box() for place in numbers.values()])
    boxes = taken.geometries
    found: dict[str, TextPlace] = {}
    for part in nest.parts:
        metal = _free_metal(part, wanted_mm, None)
        near = boxes[taken.query(metal, predicate="intersects")]
        if len(near):
            metal = metal.difference(shapely.union_all(near).buffer(0.2 * wanted_mm, join_style="mitre"))
        place = find_room(metal, part.id, _NAME * wanted_mm)
        if place is not None and place.size_mm >= least_mm:
            found[part.id] = place
    return found


def _in_the_skeleton(
    nest: Nest, labels: Mapping[str, Label], wanted_mm: float, window: shapely.Polygon | None
) -> dict[str, TextPlace]:
    """The labels of scrap lines, each beside its line, between the parts."""
    lines = [line for line in nest.scrap if line.id in labels]
    if not lines:
        return {}
    free = shapely.make_valid(nest.sheet.polygon).difference(shapely.union_all([p.outer.polygon for p in nest.parts]))
    free = free.difference(shapely.union_all([line.line for line in lines]).buffer(0.15 * wanted_mm))
    free = free if window is None else free.intersection(window)
    places: dict[str, TextPlace] = {}
    for line in lines:
        band = free.intersection(line.line.buffer(_BESIDE * wanted_mm, quad_segs=4))
        middle = shapely.line_interpolate_point(line.line, 0.5, normalized=True)
        place = find_room(band, labels[line.id].text, wanted_mm, middle)
        if place is not None:
            places[line.id] = place
            free = free.difference(place.box().buffer(0.12 * place.size_mm, join_style="mitre"))
    return places


def _smallest(places: Mapping[str, TextPlace]) -> float:
    return min((p.size_mm for p in places.values()), default=math.inf)


def _free_metal(part: Part, wanted_mm: float, window: shapely.Polygon | None) -> shapely.Geometry:
    """The part's metal in the window, clear of its marks where these leave anything."""
    metal = _seen(part.polygon, wanted_mm, window)
    if not part.marks:
        return metal
    clear = metal.difference(shapely.union_all([m.line for m in part.marks]).buffer(0.15 * wanted_mm))
    return metal if clear.is_empty else clear


def _place_part(
    part: Part,
    metal: shapely.Geometry,
    labels: Mapping[str, Label],
    wanted_mm: float,
    in_holes: Mapping[str, TextPlace | None],
    outer_first: bool,
    above_mm: float = 0.0,
) -> dict[str, TextPlace] | None:
    """The labels of one part, each in what the ones before it leave of the metal (or anywhere, if they leave none).

    `in_holes` is where those of holes stand within them. None where one of them is no larger than `above_mm`.
    """
    whole, open_lines = metal, (*part.marks, *part.slits)
    contours = (part.outer, *part.holes, *open_lines) if outer_first else (*part.holes, part.outer, *open_lines)
    places: dict[str, TextPlace] = {}
    for contour in contours:
        if contour.id not in labels:
            continue
        label = labels[contour.id]
        if contour.kind == "outer":
            place = find_room(whole if metal.is_empty else metal, label.text, wanted_mm, _point(label), bold=True)
        elif not contour.encloses:
            place = find_room(whole if metal.is_empty else metal, label.text, wanted_mm, contour.line)
        else:
            place = in_holes[contour.id]
            if place is None or place.size_mm < _ENOUGH * wanted_mm:
                least_mm = 0.0 if place is None else max(above_mm, place.size_mm)
                beside = _beside(metal, contour, label, wanted_mm, least_mm)
                if beside is not None and (place is None or beside.size_mm > place.size_mm):
                    place = beside
        if place is not None:
            if place.size_mm <= above_mm:
                return None
            places[contour.id] = place
            metal = metal.difference(place.box().buffer(0.12 * place.size_mm, join_style="mitre"))
    return places


def _point(label: Label) -> shapely.Point | None:
    return None if label.near is None else shapely.Point(label.near)


def _in_hole(
    hole: Contour,
    label: Label,
    wanted_mm: float,
    filled: shapely.Geometry | None,
    window: shapely.Polygon | None,
) -> TextPlace | None:
    """The place in a hole, clear of what lies in it and of its lead."""
    area = _seen(hole.polygon, wanted_mm, window)
    if filled is not None:
        area = area.difference(filled)
    leads = [curve.line(0.5).buffer(0.2 * wanted_mm, quad_segs=2) for curve in label.obstacles if curve.segments]
    clear = area.difference(shapely.union_all(leads)) if leads else area
    return find_room(area if clear.is_empty else clear, label.text, wanted_mm, _point(label))


def _beside(
    metal: shapely.Geometry, hole: Contour, label: Label, wanted_mm: float, above_mm: float
) -> TextPlace | None:
    """The place in the metal by a hole, for a text larger than it could be elsewhere."""
    band = metal.intersection(hole.polygon.buffer(_BESIDE * wanted_mm, quad_segs=4))
    return find_room(band, label.text, wanted_mm, _point(label) or hole.line, above_mm=above_mm)


def _seen(area: shapely.Geometry, wanted_mm: float, window: shapely.Polygon | None) -> shapely.Geometry:
    """What lies in the window, with no more points than a label can tell: curves of a thousand chords are slow."""
    exact = shapely.make_valid(area)
    # A simplified outline may stray outwards, so it is drawn in by as much: labels stay inside the exact one.
    simple = shapely.make_valid(exact.simplify(_FINE * wanted_mm)).buffer(-_FINE * wanted_mm, join_style="mitre")
    seen = exact if simple.is_empty else simple
    return seen if window is None else seen.intersection(window)


def _nested_metal(nest: Nest, holes: list[Contour]) -> dict[str, shapely.Geometry]:
    """The outlines of the parts that lie in each hole, by hole id; empty holes are left out."""
    if not holes:
        return {}
    outlines = shapely.make_valid([p.outer.polygon for p in nest.parts])
    rims = shapely.make_valid([h.polygon for h in holes])
    # One point decides, as a part may touch the rim; it may be a point of the host too, which is the larger.
    hole, part = shapely.STRtree(shapely.point_on_surface(outlines)).query(rims, predicate="contains")
    smaller = shapely.area(outlines)[part] < shapely.area(rims)[hole]
    inside: dict[str, list[shapely.Geometry]] = {}
    for h, p in zip(hole[smaller].tolist(), part[smaller].tolist(), strict=True):
        inside.setdefault(holes[h].id, []).append(outlines[p])
    return {hole_id: shapely.union_all(found) for hole_id, found in inside.items()}
