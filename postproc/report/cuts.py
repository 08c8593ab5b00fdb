"""The layers that show the work: contours, directions, leads, pierces, idle travel and numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import KINDS, Contour, Nest

from . import colours
from .scene import Dot, Item, SceneLayer, Shape, Style, TextLine
from .text_room import TextPlace
from .view import View

INKS: Mapping[str, str] = {
    "outer": colours.OUTER, "hole": colours.HOLE, "mark": colours.MARK, "slit": colours.SLIT,
    "scrap": colours.SCRAP,
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
    gone = Style(stroke=colours.FAINT, width=0.7 * view.line_width, dash=dots)
    paths = zip(plain, view.paths([c.curve for c in plain]), strict=True)
    items = [
        _outline(c, path, order, gone if c.id in out else Style(stroke=_ink(c), width=_pen(c, view)))
        for c, path in paths
    ]
    dashed = Style(stroke=colours.FAINT, width=view.line_width, dash=(3 * view.line_width, 2 * view.line_width))
    items += [Shape((view.path(hole.curve),), dashed) for hole in nest.not_cut]
    loud = Style(stroke=colours.ALERT, width=3 * view.line_width)
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
                looks.append(
                    (Style(stroke=colours.OUTER if link else _torch_ink(cut), width=width * view.line_width), k)
                )
    drawn = zip(view.paths(leads), looks, strict=True)
    return SceneLayer("leads", tuple(Shape((path,), style, closed=False, cut=k) for path, (style, k) in drawn))


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
            items.append(Dot(x, y, 0.7 * view.dot_radius, Style(fill=colours.MARK), k))
        elif shapely.intersects_xy(nest.sheet.polygon, *cut.pierce) and cut.span is None:
            items.append(Dot(x, y, view.dot_radius, Style(fill=_torch_ink(cut)), k))
        else:
            ring = Style(fill=colours.PAGE, stroke=_torch_ink(cut), width=0.5 * view.dot_radius)
            items.append(Dot(x, y, view.dot_radius, ring, k))
    return SceneLayer("pierces", tuple(items))


def _torch_ink(cut: Cut) -> str:
    return colours.PIERCE if cut.torch == 1 else colours.FURTHER


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
            items.append(Shape((bar,), Style(stroke=colours.TAB, width=width), closed=False, cut=k))
    return SceneLayer("tabs", tuple(items))


def travel_layer(
    view: View,
    cuts: Sequence[Cut],
    home: Point | None,
    shares: Sequence[float],
    pierced: Mapping[int, Sequence[Pierce]] | None = None,
) -> SceneLayer:
    """Idle travel as dashed arrows, coloured by `shares`: when each begins, 0 … 1; the last leads home.

    Without a `home` the ways from there and back are left out.

    The way through the holes that are `pierced` in a pass before a cut, counted from 1, is dotted. Further torches go
    along with the first, whose way this is.
    """
    way = [(k, cut) for k, cut in enumerate(cuts, 1) if cut.torch == 1]
    stops = [(k, a.end, b.pierce) for (_, a), (k, b) in pairwise(way)]
    if home is not None:
        stops = [(way[0][0], home, way[0][1].pierce), *stops, (len(cuts) + 1, way[-1][1].end, home)]
    width = max(view.line_width, 0.7)
    items: list[Item] = []
    heads: list[Item] = []
    for k, start, end in stops:
        share = shares[k - 1]
        if holes := (pierced or {}).get(k):
            through = np.array([view.point(at) for at in (start, *(hole.at for hole in holes))])
            dots = Style(stroke=colours.PIERCE, width=0.8 * width, dash=(width, 2 * width))
            items.append(Shape((through,), dots, closed=False, cut=k))
            start = holes[-1].at
        a, b = view.point(start), view.point(end)
        length = math.dist(a, b)
        if length < 0.5 or (k <= len(cuts) and cuts[k - 1].linked):
            continue
        colour = colours.time_colour(share)
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
    pen = Style(stroke=colours.INK, width=1.2)
    cross = (np.array([(x - 1.7 * r, y), (x + 1.7 * r, y)]), np.array([(x, y - 1.7 * r), (x, y + 1.7 * r)]))
    return SceneLayer(
        "home", (Dot(x, y, r, Style(fill="#ffffff", stroke=colours.INK, width=1.2)), Shape(cross, pen, False))
    )


def name_layer(nest: Nest, view: View, places: Mapping[str, TextPlace]) -> SceneLayer:
    """The names of parts at their places, faint."""
    items = []
    for place in places.values():
        x, y = view.point((place.x, place.y))
        items.append(TextLine(x, y, place.text, place.size_mm * view.scale, colours.NAME, turned=place.turned))
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
                colours.INK if contour.kind == "outer" else _ink(contour),
                bold=place.bold,
                halo=colours.PAGE,
                turned=place.turned,
                cut=order.get(contour_id, 0),
            )
        )
    return SceneLayer("numbers", tuple(items))
