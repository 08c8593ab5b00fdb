"""The layers that show the stock: sheet, parts, zones and marks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest, Part

from . import colours
from .scene import SceneLayer, Shape, Style, TextLine
from .text_room import Room, Shapes, find_rooms
from .view import View

_ZONE_GAP_MM = 40.0  # parts of two zones closer than this want different tints
_ZONE_PARTS = 12  # of a zone, its largest, among which its name finds room


@dataclass(frozen=True, slots=True)
class ZoneMap:
    """The zone of each part (0 for none) and the tint number of each zone."""

    of_part: Mapping[str, int]
    tint: Mapping[int, int]

    def colour(self, part: str) -> str:
        """The fill of a part."""
        zone = self.of_part.get(part, 0)
        return colours.zone_tint(self.tint[zone]) if zone else colours.PART


def zone_map(nest: Nest, of_part: Mapping[str, int]) -> ZoneMap:
    """Give zones tints so that zones that touch differ: the first tint, in a cycle, that no neighbour has."""
    first, second = near_parts(nest)
    zone = np.array([of_part.get(p.id, 0) for p in nest.parts], dtype=int)
    touching = np.unique(np.column_stack([zone[first], zone[second]]), axis=0)
    neighbours: dict[int, set[int]] = {z: {z - 1} for z in sorted(set(zone.tolist()))}
    for a, b in touching.tolist():
        neighbours[a].add(b)
    tint: dict[int, int] = {}
    for z in neighbours:
        taken = {tint[other] for other in neighbours[z] if other in tint}
        order = [(z - 1 + k) % colours.zone_tints() for k in range(colours.zone_tints())]
        tint[z] = next((c for c in order if c not in taken), order[0])
    return ZoneMap(of_part, tint)


@kept_with_nest(most=1)
def near_parts(nest: Nest) -> tuple[Ints, Ints]:
    """Pairs of parts so close to each other that their zones want different tints; it needs no plan."""
    outlines = np.array([p.outer.polygon for p in nest.parts], dtype=object)
    first, second = shapely.STRtree(outlines).query(outlines, predicate="dwithin", distance=_ZONE_GAP_MM)
    return first, second


@kept_with_nest(most=1)
def outlines_of_parts(nest: Nest, view: View) -> list[tuple[Part, tuple[Floats, ...]]]:
    """The lines of each part's metal on the page, the largest part first; it needs no plan."""
    by_size = sorted(nest.parts, key=lambda p: -p.outer.polygon.area)
    rings = [[p.outer.curve.towards("ccw"), *(hole.curve.towards("cw") for hole in p.holes)] for p in by_size]
    paths = iter(view.paths([ring for own in rings for ring in own]))
    return [(part, tuple(islice(paths, len(own)))) for part, own in zip(by_size, rings, strict=True)]


def sheet_layer(nest: Nest, view: View) -> SceneLayer:
    """The sheet's outline and its own holes."""
    fill = Style(fill=colours.SHEET, stroke=colours.FAINT, width=1.2)
    hole = Style(fill=colours.PAGE, stroke=colours.FAINT, width=1.0)
    items = [Shape((view.path(nest.sheet.outline),), fill)]
    items += [Shape((view.path(curve),), hole) for curve in nest.sheet.holes]
    return SceneLayer("sheet", tuple(items))


def part_layer(
    nest: Nest, view: View, zones: ZoneMap, order: Mapping[str, int], faded: frozenset[str] = frozenset(), made: int = 0
) -> SceneLayer:
    """The parts' metal, filled; `order` numbers the cuts by contour id. Hosts lie below what is nested in them.

    So many cuts are `made` before the first of the picture.
    """
    drawn = outlines_of_parts(nest, view)
    return SceneLayer("parts", tuple(_metal(p, own, zones, order, p.id in faded, made) for p, own in drawn))


def out_layer(nest: Nest, view: View, out: frozenset[str]) -> SceneLayer:
    """What has fallen out: parts, and the waste of holes."""
    by_size = sorted((c for c in nest.contours if c.curve.closed), key=lambda c: -c.polygon.area)
    void = Style(fill=colours.PAGE)
    fallen = [c for c in by_size if c.id in out and c.kind != "mark"]
    return SceneLayer("out", tuple(Shape((view.path(c.curve),), void, title=f"{c.id}  out") for c in fallen))


def _metal(
    part: Part, lines: tuple[Floats, ...], zones: ZoneMap, order: Mapping[str, int], faded: bool, made: int
) -> Shape:
    cuts = sorted((order[c.id], c.id) for c in part if c.id in order)
    title = "\n".join([part.id, *(f"{made + k}  {contour}" for k, contour in cuts)])
    fill = colours.mix(colours.SHEET, zones.colour(part.id), 0.4) if faded else zones.colour(part.id)
    return Shape(lines, Style(fill=fill), cut=order.get(part.outer.id, 0), title=title)


def zone_layer(nest: Nest, view: View, zones: ZoneMap, taken: Sequence[shapely.Polygon]) -> SceneLayer:
    """The name of every zone in its widest metal, clear of the boxes that are taken, mm."""
    members: dict[int, list[Part]] = {}
    for part in nest.parts:
        if zone := zones.of_part.get(part.id, 0):
            members.setdefault(zone, []).append(part)
    if not members:
        return SceneLayer("zones", ())
    widest = [sorted(members[zone], key=lambda p: -p.polygon.area)[:_ZONE_PARTS] for zone in sorted(members)]
    valid = shapely.make_valid([part.polygon for parts in widest for part in parts])
    metals = _unions(valid, np.repeat(np.arange(len(widest)), [len(parts) for parts in widest]), len(widest))
    boxes = shapely.STRtree(taken)
    of, box = boxes.query(metals, predicate="intersects")
    by = np.argsort(of, kind="stable")
    metals = shapely.difference(metals, _unions(boxes.geometries[box[by]], of[by], len(widest)))
    size_mm = 2.2 * view.number_size * view.mm
    rooms = [Room(metal, f"Z{zone}", size_mm, bold=True) for zone, metal in zip(sorted(members), metals, strict=True)]
    texts = []
    for zone, place in zip(sorted(members), find_rooms(rooms), strict=True):
        if place is not None:
            x, y = view.point((place.x, place.y))
            ink = colours.shade(colours.zone_tint(zones.tint[zone]), 0.3)
            texts.append(TextLine(x, y, place.text, place.size_mm * view.scale, ink, bold=True, turned=place.turned))
    return SceneLayer("zones", tuple(texts))


def _unions(shapes: Shapes, of: Ints, count: int) -> Shapes:
    """The union of all shapes of 0, of 1 …, `of` (k,) in rising order; empty where there are none."""
    first = np.searchsorted(of, np.arange(count))
    rows: Shapes = np.full((count, max(1, int(np.bincount(of, minlength=1).max()))), None, dtype=object)
    rows[of, np.arange(len(of)) - first[of]] = shapes
    united: Shapes = shapely.union_all(rows, axis=1)
    return united
