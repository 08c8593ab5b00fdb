"""Where the number (or the name) of every contour stands: inside the metal or the hole that it belongs to."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest

from .label_fit import Room, Shapes, TextPlace, find_rooms

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
    every = [h for p in nest.parts for h in p.holes]
    holes = [h for h in every if h.id in labels]
    filled = nested_metal(nest, tuple(h.id for h in holes))
    whole = window is None and len(holes) == len(every)
    areas = number_areas(nest, wanted_mm) if whole else _Areas.of(nest.parts, holes, wanted_mm, window)
    tried = _of_parts(nest.parts, labels, wanted_mm, areas, filled)
    size_mm, crowded = wanted_mm, [k for k, places in enumerate(tried) if _meet(places)]
    while crowded and size_mm > wanted_mm * _LEAST:
        size_mm /= 2.0
        parts = [nest.parts[k] for k in crowded]
        areas = _Areas.of(parts, [h for p in parts for h in p.holes if h.id in labels], size_mm, window)
        again = _of_parts(parts, labels, size_mm, areas, filled)
        for k, places in zip(crowded, again, strict=True):
            tried[k] = places
        crowded = [k for k in crowded if _meet(tried[k])]
    found = {name: place for places in tried for name, place in places.items()}
    return found | _scrap_labels(nest, labels, wanted_mm, window)


@dataclass(frozen=True, eq=False, slots=True)
class _Areas:
    """Where numbers of a size may stand: the `metals` of some parts, one after the other, and `holes` by id."""

    metals: list[shapely.Geometry]
    holes: dict[str, shapely.Geometry]

    @staticmethod
    def of(parts: Sequence[Part], holes: Sequence[Contour], wanted_mm: float, window: shapely.Polygon | None) -> _Areas:
        """What of them lies in the window."""
        inside = _seen([hole.polygon for hole in holes], wanted_mm, window).tolist()
        metals = _free_metals(parts, wanted_mm, window).tolist()
        return _Areas(metals, dict(zip((hole.id for hole in holes), inside, strict=True)))


@cached_with_nest(most=1)
def number_areas(nest: Nest, wanted_mm: float) -> _Areas:
    """Where numbers of a size may stand in a whole nest: it needs no plan, so it may be told before there is one."""
    return _Areas.of(nest.parts, [hole for part in nest.parts for hole in part.holes], wanted_mm, None)


def _of_parts(
    parts: Sequence[Part],
    labels: Mapping[str, Label],
    wanted_mm: float,
    areas: _Areas,
    filled: Mapping[str, shapely.Geometry],
) -> list[dict[str, TextPlace]]:
    """The labels of every part."""
    holes = [hole for part in parts for hole in part.holes if hole.id in labels]
    in_holes = dict(zip((h.id for h in holes), _in_holes(holes, labels, wanted_mm, areas, filled), strict=True))
    of_each = zip(parts, areas.metals, strict=True)
    return run_batched([_of_part(part, metal, labels, wanted_mm, in_holes) for part, metal in of_each])


def _of_part(
    part: Part,
    metal: shapely.Geometry,
    labels: Mapping[str, Label],
    wanted_mm: float,
    in_holes: Mapping[str, TextPlace | None],
) -> BatchedTask[dict[str, TextPlace]]:
    tried = (yield from _place_part(part, metal, labels, wanted_mm, in_holes, outer_first=False)) or {}
    holes = any(hole.id in labels for hole in part.holes)
    if holes and (above_mm := _smallest(tried)) < _ENOUGH * wanted_mm:  # without holes it would be the same again
        better = yield from _place_part(part, metal, labels, wanted_mm, in_holes, outer_first=True, above_mm=above_mm)
        return better or tried
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
    rooms: list[Room] = []
    for part, metal in zip(nest.parts, _free_metals(nest.parts, wanted_mm, None), strict=True):
        near = boxes[taken.query(metal, predicate="intersects")]
        if len(near):
            metal = metal.difference(shapely.union_all(near).buffer(0.2 * wanted_mm, join_style="mitre"))
        rooms.append(Room(metal, part.id, _NAME * wanted_mm))
    found = zip(nest.parts, find_rooms(rooms), strict=True)
    return {part.id: place for part, place in found if place is not None and place.size_mm >= least_mm}


def _scrap_labels(
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
        (place,) = find_rooms([Room(band, labels[line.id].text, wanted_mm, middle)])
        if place is not None:
            places[line.id] = place
            free = free.difference(place.box().buffer(0.12 * place.size_mm, join_style="mitre"))
    return places


def _smallest(places: Mapping[str, TextPlace]) -> float:
    return min((p.size_mm for p in places.values()), default=math.inf)


def _free_metals(parts: Sequence[Part], wanted_mm: float, window: shapely.Polygon | None) -> Shapes:
    """The metal of parts in the window, clear of their marks where these leave anything."""
    metals = _seen([part.polygon for part in parts], wanted_mm, window)
    for k, part in enumerate(parts):
        if part.marks:
            marks = shapely.union_all([m.line for m in part.marks]).buffer(0.15 * wanted_mm)
            clear = metals[k].difference(marks)
            metals[k] = metals[k] if clear.is_empty else clear
    return metals


def _place_part(
    part: Part,
    metal: shapely.Geometry,
    labels: Mapping[str, Label],
    wanted_mm: float,
    in_holes: Mapping[str, TextPlace | None],
    outer_first: bool,
    above_mm: float = 0.0,
) -> BatchedTask[dict[str, TextPlace] | None]:
    """The labels of one part, each in what the ones before it leave of the metal (or anywhere, if they leave none).

    `in_holes` is where those of holes stand within them. None where one of them is no larger than `above_mm`.
    """
    whole, open_lines = metal, (*part.marks, *part.slits)
    contours = (part.outer, *part.holes, *open_lines) if outer_first else (*part.holes, part.outer, *open_lines)
    places: dict[str, TextPlace] = {}
    last: TextPlace | None = None
    for contour in contours:
        if contour.id not in labels:
            continue
        label = labels[contour.id]
        place = in_holes.get(contour.id)
        inside = contour.encloses and contour.kind != "outer"
        if not inside or place is None or place.size_mm < _ENOUGH * wanted_mm:
            if last is not None:
                metal, last = (yield _less, (metal, last)), None
            if inside:
                least_mm = 0.0 if place is None else max(above_mm, place.size_mm)
                band = yield _around, (metal, contour.polygon, _BESIDE * wanted_mm)
                room = Room(band, label.text, wanted_mm, _point(label) or contour.line, above_mm=least_mm)
            else:
                near, bold = (_point(label), True) if contour.kind == "outer" else (contour.line, False)
                room = Room(whole if metal.is_empty else metal, label.text, wanted_mm, near, bold)
            found = yield find_rooms, room
            if not inside or (found is not None and (place is None or found.size_mm > place.size_mm)):
                place = found
        if place is not None:
            if place.size_mm <= above_mm:
                return None
            places[contour.id] = place
            if last is not None:
                metal = yield _less, (metal, last)
            last = place
    return places


def _less(shapes: Sequence[tuple[shapely.Geometry, TextPlace]]) -> Shapes:
    """What texts, with some air around them, leave of areas."""
    areas, places = zip(*shapes, strict=True)
    air_mm = np.array([0.12 * place.size_mm for place in places])
    boxes = shapely.buffer([place.box() for place in places], air_mm, join_style="mitre")
    left: Shapes = shapely.difference(np.array(areas, dtype=object), boxes)
    return left


def _around(shapes: Sequence[tuple[shapely.Geometry, shapely.Geometry, float]]) -> Shapes:
    """What of areas lies so near to others."""
    areas, others, far_mm = zip(*shapes, strict=True)
    bands = shapely.buffer(np.array(others, dtype=object), np.array(far_mm), quad_segs=4)
    near: Shapes = shapely.intersection(np.array(areas, dtype=object), bands)
    return near


def _point(label: Label) -> shapely.Point | None:
    return None if label.near is None else shapely.Point(label.near)


def _in_holes(
    holes: Sequence[Contour],
    labels: Mapping[str, Label],
    wanted_mm: float,
    areas: _Areas,
    filled: Mapping[str, shapely.Geometry],
) -> list[TextPlace | None]:
    """The places in holes, clear of what lies in them and of their leads."""
    leads = [curve for hole in holes for curve in labels[hole.id].obstacles if curve.segments]
    wide = iter(shapely.buffer(lines_of(leads, 0.5), 0.2 * wanted_mm, quad_segs=2))
    rooms = []
    for hole in holes:
        area, label = areas.holes[hole.id], labels[hole.id]
        if hole.id in filled:
            area = area.difference(filled[hole.id])
        own = [next(wide) for curve in label.obstacles if curve.segments]
        clear = area.difference(shapely.union_all(own)) if own else area
        rooms.append(Room(area if clear.is_empty else clear, label.text, wanted_mm, _point(label)))
    return find_rooms(rooms)


def _seen(areas: Sequence[shapely.Geometry], wanted_mm: float, window: shapely.Polygon | None) -> Shapes:
    """What lies in the window, with no more points than a label can tell: curves of a thousand chords are slow."""
    exact = shapely.make_valid(np.array(areas, dtype=object))
    # A simplified outline may stray outwards, so it is drawn in by as much: labels stay inside the exact one.
    fewer = shapely.make_valid(shapely.simplify(exact, _FINE * wanted_mm))
    simple = shapely.buffer(fewer, -_FINE * wanted_mm, quad_segs=16, join_style="mitre")
    seen: Shapes = np.where(shapely.is_empty(simple), exact, simple)
    return seen if window is None else shapely.intersection(seen, window)


@cached_with_nest(most=1)
def nested_metal(nest: Nest, names: tuple[str, ...]) -> dict[str, shapely.Geometry]:
    """The outlines of the parts that lie in each of these holes, by hole id; empty holes are left out."""
    if not names:
        return {}
    holes = [nest.contour(name) for name in names]
    outlines = shapely.make_valid([p.outer.polygon for p in nest.parts])
    rims = shapely.make_valid([h.polygon for h in holes])
    # One point decides, as a part may touch the rim; it may be a point of the host too, which is the larger.
    hole, part = shapely.STRtree(shapely.point_on_surface(outlines)).query(rims, predicate="contains")
    smaller = shapely.area(outlines)[part] < shapely.area(rims)[hole]
    inside: dict[str, list[shapely.Geometry]] = {}
    for h, p in zip(hole[smaller].tolist(), part[smaller].tolist(), strict=True):
        inside.setdefault(holes[h].id, []).append(outlines[p])
    return {hole_id: shapely.union_all(found) for hole_id, found in inside.items()}


# Many tasks side by side: what all of them ask for next is answered in one go, as the geometry library likes it.

DoneT = TypeVar("DoneT")

Many = Callable[[Sequence[Any]], Iterable[Any]]
"""Answers many questions at once, each by itself."""
BatchedTask = Generator[tuple[Many, Any], Any, DoneT]
"""A task that yields who answers and what it asks, and is sent the answer."""


def run_batched(tasks: Sequence[BatchedTask[DoneT]]) -> list[DoneT]:
    """What every task comes to.

    Examples
    --------
    >>> def squares(numbers):
    ...     return [k * k for k in numbers]
    >>> def fourth_power(k):
    ...     square = yield squares, k
    ...     return (yield squares, square)
    >>> run_batched([fourth_power(2), fourth_power(3)])
    [16, 81]
    """
    done: dict[int, DoneT] = {}
    answers: dict[int, Any] = dict.fromkeys(range(len(tasks)))
    while answers:
        by_kind: dict[Many, dict[int, Any]] = {}
        for k, answer in answers.items():
            try:
                many, question = tasks[k].send(answer)
            except StopIteration as end:
                done[k] = end.value
            else:
                by_kind.setdefault(many, {})[k] = question
        answers = {}
        for many, questions in by_kind.items():
            answers |= dict(zip(questions, many(list(questions.values())), strict=True))
    return [done[k] for k in range(len(tasks))]
