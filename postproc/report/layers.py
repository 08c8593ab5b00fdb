"""The layers of a picture: sheet, parts, zones and marks; contours, leads, pierces, travel and numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import KINDS, Contour, Nest, Part, cached_with_nest
from kerfwise.models.plan.plan import PlannedCut

from . import scene
from .label_fit import Room, Shapes, TextPlace, find_rooms
from .scene import Dot, Item, SceneLayer, Shape, Style, TextLine, View

INKS: Mapping[str, str] = {
    "outer": scene.OUTER, "hole": scene.HOLE, "mark": scene.MARK, "slit": scene.SLIT,
    "scrap": scene.SCRAP, "stretch": scene.STRETCH,
}  # fmt: skip
_ARROW_EVERY = 260.0  # page units along a contour


def contour_layer(
    nest: Nest,
    view: View,
    order: Mapping[str, int],
    alert: frozenset[str] = frozenset(),
    out: frozenset[str] = frozenset(),
) -> SceneLayer:
    """Every contour as a line; those in `alert` thick and red, on top, those that are `out` dotted.

    Small holes that are not cut are dashed.
    """
    plain = sorted((c for c in nest.contours if c.id not in alert), key=lambda c: KINDS.index(c.kind))
    dots = (2 * view.line_width, 2 * view.line_width)
    gone = Style(stroke=scene.FAINT, width=0.7 * view.line_width, dash=dots)
    paths = zip(plain, view.paths([c.curve for c in plain]), strict=True)
    items = [
        _outline(c, path, order, gone if c.id in out else Style(stroke=_ink(c), width=_pen(c, view)))
        for c, path in paths
    ]
    dashed = Style(stroke=scene.FAINT, width=view.line_width, dash=(3 * view.line_width, 2 * view.line_width))
    items += [Shape((view.path(hole.curve),), dashed) for hole in nest.not_cut]
    loud = Style(stroke=scene.ALERT, width=3 * view.line_width)
    items += [_outline(c, view.path(c.curve), order, loud) for c in nest.contours if c.id in alert]
    return SceneLayer("contours", tuple(items))


def _ink(contour: Contour) -> str:
    return INKS[contour.kind]


def _pen(contour: Contour, view: View) -> float:
    return view.line_width * (0.7 if contour.kind == "mark" else 1.0)


def _outline(contour: Contour, path: Floats, order: Mapping[str, int], style: Style) -> Shape:
    return Shape((path,), style, closed=contour.curve.closed, cut=order.get(contour.id, 0))


def direction_layer(nest: Nest, view: View, cuts: Sequence[Cut]) -> SceneLayer:
    """Arrow heads on the contours: one soon after the entry, more on long contours."""
    items: list[Item] = []
    for k, cut in enumerate(cuts, 1):
        contour = nest.contour(cut.contour)
        curve = contour.curve
        if curve.closed:
            curve = curve.towards(cut.direction)
        elif cut.direction == "cw":
            curve = curve.reversed()
        start_mm = curve.project(cut.entry)[0] if curve.closed else 0.0
        length_mm = curve.length_mm
        if cut.span is not None:
            length_mm = (curve.project(cut.span.end)[0] - start_mm) % length_mm
        length = length_mm * view.scale
        size = min(view.arrow_size, 0.14 * length)
        count = min(max(round(length / _ARROW_EVERY), 1), 8)
        first = min(2.5 * size, 0.2 * length)
        heads = []
        for j in range(count):
            s_mm = start_mm + (first + j * length / count) * view.mm
            heads.append(_head(view.point(curve.point_at(s_mm)), curve.tangent_at(s_mm), size))
        items.append(Shape(tuple(heads), Style(fill=_ink(contour)), cut=k))
    return SceneLayer("directions", tuple(items))


def _head(middle: Point, tangent: Point, size: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """An arrow head about a page point; the tangent has y up, as in the nest."""
    (x, y), (dx, dy) = middle, (tangent[0], -tangent[1])
    along, across = np.array([dx, dy]) * size, np.array([-dy, dx]) * size * 0.38
    tail = np.array([x, y]) - along / 2
    return np.array([tail + along, tail + across, tail + along * 0.25, tail - across])


def lead_layer(view: View, cuts: Sequence[Cut]) -> SceneLayer:
    """Lead-ins, and lead-outs drawn thinner; links as the contours that they lead to.

    Further torches have a colour of their own.
    """
    leads: list[Curve] = []
    looks: list[tuple[Style, int]] = []
    for k, cut in enumerate(cuts, 1):
        for lead, width in ((cut.lead_in, 1.1), (cut.lead_out, 0.7)):
            if lead is not None and len(lead.segments) > 0:
                link = cut.linked and lead is cut.lead_in
                leads.append(lead)
                looks.append((Style(stroke=scene.OUTER if link else _torch_ink(cut), width=width * view.line_width), k))
    drawn = zip(view.paths(leads), looks, strict=True)
    return SceneLayer("leads", tuple(Shape((path,), style, closed=False, cut=k) for path, (style, k) in drawn))


def stretch_layer(nest: Nest, view: View, begun: Sequence[tuple[int, Cut]]) -> SceneLayer:
    """Stretches that are cut before the rest of their contours, with their links and pierces: before which cut."""
    items: list[Item] = []
    width = 1.8 * view.line_width
    for k, cut in begun:
        curve = nest.contour(cut.contour).curve.towards(cut.direction)
        start_mm = curve.project(cut.entry)[0]
        end_mm = start_mm if cut.span is None else curve.project(cut.span.end)[0]
        piece = curve.between(start_mm, (end_mm - start_mm) % curve.length_mm)
        ways = [lead for lead in (cut.lead_in, piece) if lead is not None and len(lead.segments) > 0]
        style = Style(stroke=scene.STRETCH, width=width)
        items += [Shape((path,), style, closed=False, cut=k) for path in view.paths(ways)]
        size = min(view.arrow_size, 0.3 * piece.length_mm * view.scale)
        middle_mm = piece.length_mm / 2
        head = _head(view.point(piece.point_at(middle_mm)), piece.tangent_at(middle_mm), size)
        items.append(Shape((head,), Style(fill=scene.STRETCH), cut=k))
        if not cut.linked:
            items.append(Dot(*view.point(cut.pierce), view.dot_radius, Style(fill=_torch_ink(cut)), k))
    return SceneLayer("stretches", tuple(items))


def bevel_layer(view: View, cuts: Sequence[PlannedCut]) -> SceneLayer:
    """The ways of tilted torches: a line where they go at the top face, dots where their jet comes out below."""
    items: list[Item] = []
    top = Style(stroke=scene.STRETCH, width=1.2 * view.line_width)
    below = Style(stroke=scene.STRETCH, width=0.9 * view.line_width, dash=(1.5 * view.line_width, 2 * view.line_width))
    for k, planned in enumerate(cuts, 1):
        for one in (path for path in planned.passes if path.tilt_deg):
            for depth_mm, style in ((0.0, top), (one.thickness_mm, below)):
                lines = [view.path(Curve.of(line.coords, closed=False)) for line in one.lines(depth_mm)]
                items += [Shape((line,), style, closed=False, cut=k) for line in lines]
    return SceneLayer("bevels", tuple(items))


def pierce_layer(nest: Nest, view: View, cuts: Sequence[Cut]) -> SceneLayer:
    """A dot where the torch pierces, a ring where it begins off the sheet or in an older kerf.

    Blue and smaller where a mark begins.

    A cut that is linked has none.
    """
    items = []
    for k, cut in enumerate(cuts, 1):
        if cut.linked:
            continue
        x, y = view.point(cut.pierce)
        if nest.contour(cut.contour).kind == "mark":
            items.append(Dot(x, y, 0.7 * view.dot_radius, Style(fill=scene.MARK), k))
        elif shapely.intersects_xy(nest.sheet.polygon, *cut.pierce) and cut.span is None:
            items.append(Dot(x, y, view.dot_radius, Style(fill=_torch_ink(cut)), k))
        else:
            ring = Style(fill=scene.PAGE, stroke=_torch_ink(cut), width=0.5 * view.dot_radius)
            items.append(Dot(x, y, view.dot_radius, ring, k))
    return SceneLayer("pierces", tuple(items))


def _torch_ink(cut: Cut) -> str:
    return scene.PIERCE if cut.torch == 1 else scene.FURTHER


def across_layer(view: View, cuts: Sequence[PlannedCut]) -> SceneLayer:
    """A cross on the mouth of each slot, notch and neck that the torch cuts straight across, so that it is not cut."""
    items: list[Item] = []
    half = 3.0 * view.line_width
    for k, planned in enumerate(cuts, 1):
        for at in planned.across:
            x, y = view.point(at)
            strokes = tuple(np.array([(x - half, y - s * half), (x + half, y + s * half)]) for s in (-1, 1))
            items.append(Shape(strokes, Style(stroke=scene.ACROSS, width=1.6 * view.line_width), closed=False, cut=k))
    return SceneLayer("across", tuple(items))


def tab_layer(nest: Nest, view: View, cuts: Sequence[Cut]) -> SceneLayer:
    """A bar across the contour where a tab stays, or all of the tab where that is wider."""
    items: list[Item] = []
    for k, cut in enumerate(cuts, 1):
        for tab in cut.tabs:
            curve = nest.contour(cut.contour).curve
            dx, dy = curve.tangent_at(curve.project(tab.at)[0])
            (x, y), half = view.point(tab.at), 3.5 * view.line_width
            bar = np.array([(x - half * dy, y - half * dx), (x + half * dy, y + half * dx)])
            width = max(2.2 * view.line_width, tab.width_mm * view.scale)
            items.append(Shape((bar,), Style(stroke=scene.TAB, width=width), closed=False, cut=k))
    return SceneLayer("tabs", tuple(items))


def travel_layer(
    view: View,
    cuts: Sequence[Cut],
    home: Point | None,
    shares: Sequence[float],
    pierced: Mapping[int, Sequence[Pierce]] | None = None,
    begun: Sequence[tuple[int, Cut]] = (),
) -> SceneLayer:
    """Idle travel as dashed arrows, coloured by `shares`: when each begins, 0 … 1; the last leads home.

    Without a `home` the ways from there and back are left out.

    The way through the holes that are `pierced` in a pass before a cut, counted from 1, is dotted. Further torches go
    along with the first, whose way this is. What is `begun` before a cut comes before it.
    """
    linked = {id(cut) for cut in cuts if cut.linked}
    way = [(k, cut) for k, cut in enumerate(cuts, 1) if cut.torch == 1]
    way = sorted([*begun, *way], key=lambda row: row[0]) if begun else way
    stops = [(k, a.end, b.pierce) for (_, a), (k, b) in pairwise(way) if id(b) not in linked]
    if home is not None:
        stops = [(way[0][0], home, way[0][1].pierce), *stops, (len(cuts) + 1, way[-1][1].end, home)]
    width = max(view.line_width, 0.7)
    items: list[Item] = []
    heads: list[Item] = []
    for k, start, end in stops:
        share = shares[k - 1]
        if holes := (pierced or {}).get(k):
            through = np.array([view.point(at) for at in (start, *(hole.at for hole in holes))])
            dots = Style(stroke=scene.PIERCE, width=0.8 * width, dash=(width, 2 * width))
            items.append(Shape((through,), dots, closed=False, cut=k))
            start = holes[-1].at
        a, b = view.point(start), view.point(end)
        length = math.dist(a, b)
        if length < 0.5:
            continue
        colour = scene.time_colour(share)
        cut = min(k, len(cuts))
        dash = (3.5 * width, 2.5 * width)
        items.append(Shape((np.array([a, b]),), Style(stroke=colour, width=width, dash=dash), closed=False, cut=cut))
        size = min(1.1 * view.arrow_size, 0.45 * length)
        tangent = ((b[0] - a[0]) / length, (a[1] - b[1]) / length)
        middle = (a[0] + 0.55 * (b[0] - a[0]), a[1] + 0.55 * (b[1] - a[1]))
        heads.append(Shape((_head(middle, tangent, size),), Style(fill=colour), cut=cut))
    return SceneLayer("travel", tuple(items + heads))


def home_layer(view: View, home: Point) -> SceneLayer:
    """The machine's home: a ring with a cross."""
    x, y = view.point(home)
    r = 5.0
    pen = Style(stroke=scene.INK, width=1.2)
    cross = (np.array([(x - 1.7 * r, y), (x + 1.7 * r, y)]), np.array([(x, y - 1.7 * r), (x, y + 1.7 * r)]))
    return SceneLayer(
        "home", (Dot(x, y, r, Style(fill="#ffffff", stroke=scene.INK, width=1.2)), Shape(cross, pen, False))
    )


def name_layer(nest: Nest, view: View, places: Mapping[str, TextPlace]) -> SceneLayer:
    """The names of parts at their places, faint."""
    items = []
    for place in places.values():
        x, y = view.point((place.x, place.y))
        items.append(TextLine(x, y, place.text, place.size_mm * view.scale, scene.NAME, turned=place.turned))
    return SceneLayer("names", tuple(items))


def number_layer(nest: Nest, view: View, places: Mapping[str, TextPlace], order: Mapping[str, int]) -> SceneLayer:
    """The labels of the contours at their places: bold for outer contours, in the ink of the contour."""
    items = []
    for contour_id, place in places.items():
        contour = nest.contour(contour_id)
        x, y = view.point((place.x, place.y))
        items.append(
            TextLine(
                x,
                y,
                place.text,
                place.size_mm * view.scale,
                scene.INK if contour.kind == "outer" else _ink(contour),
                bold=place.bold,
                halo=scene.PAGE,
                turned=place.turned,
                cut=order.get(contour_id, 0),
            )
        )
    return SceneLayer("numbers", tuple(items))


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
        return scene.zone_tint(self.tint[zone]) if zone else scene.PART


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
        order = [(z - 1 + k) % scene.zone_tints() for k in range(scene.zone_tints())]
        tint[z] = next((c for c in order if c not in taken), order[0])
    return ZoneMap(of_part, tint)


@cached_with_nest(most=1)
def near_parts(nest: Nest) -> tuple[Ints, Ints]:
    """Pairs of parts so close to each other that their zones want different tints; it needs no plan."""
    outlines = np.array([p.outer.polygon for p in nest.parts], dtype=object)
    first, second = shapely.STRtree(outlines).query(outlines, predicate="dwithin", distance=_ZONE_GAP_MM)
    return first, second


@cached_with_nest(most=1)
def outlines_of_parts(nest: Nest, view: View) -> list[tuple[Part, tuple[Floats, ...]]]:
    """The lines of each part's metal on the page, the largest part first; it needs no plan."""
    by_size = sorted(nest.parts, key=lambda p: -p.outer.polygon.area)
    rings = [[p.outer.curve.towards("ccw"), *(hole.curve.towards("cw") for hole in p.holes)] for p in by_size]
    paths = iter(view.paths([ring for own in rings for ring in own]))
    return [(part, tuple(islice(paths, len(own)))) for part, own in zip(by_size, rings, strict=True)]


def sheet_layer(nest: Nest, view: View) -> SceneLayer:
    """The sheet's outline and its own holes."""
    fill = Style(fill=scene.SHEET, stroke=scene.FAINT, width=1.2)
    hole = Style(fill=scene.PAGE, stroke=scene.FAINT, width=1.0)
    items = [Shape((view.path(nest.sheet.outline),), fill)]
    items += [Shape((view.path(curve),), hole) for curve in nest.sheet.holes]
    return SceneLayer("sheet", tuple(items))


def part_layer(
    nest: Nest,
    view: View,
    zones: ZoneMap,
    order: Mapping[str, int],
    faded: frozenset[str] = frozenset(),
    cuts_made: int = 0,
) -> SceneLayer:
    """The parts' metal, filled; `order` numbers the cuts by contour id. Hosts lie below what is nested in them.

    So many cuts are `cuts_made` before the first of the picture.
    """
    drawn = outlines_of_parts(nest, view)
    return SceneLayer("parts", tuple(_metal(p, own, zones, order, p.id in faded, cuts_made) for p, own in drawn))


def out_layer(nest: Nest, view: View, out: frozenset[str]) -> SceneLayer:
    """What has fallen out: parts, and the waste of holes."""
    by_size = sorted((c for c in nest.contours if c.curve.closed), key=lambda c: -c.polygon.area)
    void = Style(fill=scene.PAGE)
    fallen = [c for c in by_size if c.id in out and c.kind != "mark"]
    return SceneLayer("out", tuple(Shape((view.path(c.curve),), void, title=f"{c.id}  out") for c in fallen))


def _metal(
    part: Part, lines: tuple[Floats, ...], zones: ZoneMap, order: Mapping[str, int], faded: bool, cuts_made: int
) -> Shape:
    cuts = sorted((order[c.id], c.id) for c in part if c.id in order)
    title = "\n".join([part.id, *(f"{cuts_made + k}  {contour}" for k, contour in cuts)])
    fill = scene.mix(scene.SHEET, zones.colour(part.id), 0.4) if faded else zones.colour(part.id)
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
            ink = scene.shade(scene.zone_tint(zones.tint[zone]), 0.3)
            texts.append(TextLine(x, y, place.text, place.size_mm * view.scale, ink, bold=True, turned=place.turned))
    return SceneLayer("zones", tuple(texts))


def _unions(shapes: Shapes, of: Ints, count: int) -> Shapes:
    """The union of all shapes of 0, of 1 …, `of` (k,) in rising order; empty where there are none."""
    first = np.searchsorted(of, np.arange(count))
    rows: Shapes = np.full((count, max(1, int(np.bincount(of, minlength=1).max()))), None, dtype=object)
    rows[of, np.arange(len(of)) - first[of]] = shapes
    united: Shapes = shapely.union_all(rows, axis=1)
    return united
