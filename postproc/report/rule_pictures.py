"""A picture of a rule's cases: each a small nest with its cuts as the torch makes them, and what is wrong with it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from textwrap import wrap

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import Case, wrong_and_right
from kerfwise.rules.judging.violation import Violation

from . import scene
from .layers import (
    contour_layer,
    direction_layer,
    lead_layer,
    part_layer,
    pierce_layer,
    sheet_layer,
    tab_layer,
    travel_layer,
    zone_layer,
    zone_map,
)
from .plot import svg_text
from .scene import Dot, Item, Scene, SceneLayer, Shape, Style, TextLine, View

PAGE, MARGIN, LINE = 460.0, 16.0, 16.0
MOST_HEIGHT, MOST_LETTERS = 230.0, 66
_DISC, _PITCH = 8.0, 90.0
_ROUND = tuple(k * math.pi / 8 for k in range(16))
_TRAVEL = 0.3  # of the scale of time: one colour, since the numbers tell the order


@dataclass(frozen=True, eq=False, slots=True)
class Panel:
    """One nest with its cuts in order, under a title."""

    title: str
    nest: Nest
    cuts: CutSequence
    violations: tuple[Violation, ...] = ()


def case_picture(panels: Sequence[Panel]) -> str:
    """An SVG document of the panels, one below the other, with a key.

    Each cut has its number, its way round, its leads, its pierce and its tabs, and the idle travel to it, from home
    and back where the case says where home is; the start side is a bar, a temperature a ring. Contours that break the
    rule are red.
    """
    y = MARGIN
    layers: list[SceneLayer] = []
    for k, panel in enumerate(panels, 1):
        drawn, height = _panel(panel, y, k)
        layers += drawn
        y += height
    key = [TextLine(MARGIN, y + LINE * k, text, 10, scene.FAINT, "start") for k, text in enumerate(_key(panels))]
    layers.append(SceneLayer("key", tuple(key)))
    return svg_text(Scene(PAGE, y + LINE * len(key), tuple(layers), ", ".join(panel.title for panel in panels)))


def rule_panels(cases: Sequence[Case]) -> dict[str, Panel]:
    """The panels `wrong` and `right` of a rule, of those that its cases have."""
    pair = zip(("wrong", "right"), wrong_and_right(cases), strict=True)
    return {word: Panel(f"{word}: {case.name}", case.nest, case.cuts, case.violations) for word, case in pair if case}


def _key(panels: Sequence[Panel]) -> list[str]:
    """Lines that say what the signs of these pictures mean."""
    cuts = [cut for panel in panels for cut in panel.cuts]
    signs = {
        "dot: pierce": any(not cut.linked for cut in cuts),
        "arrow: the way round": bool(cuts),
        "dashed: idle travel": any(len(panel.cuts) > 1 for panel in panels),
        "solid: link": any(cut.linked for cut in cuts),
        "green: tab": any(cut.tabs for cut in cuts),
        "orange bar: cutting starts from this side": any(panel.cuts.start_side for panel in panels),
        "ring: hottest metal": any(panel.cuts.hot_spots for panel in panels),
        "thick red: breaks the rule": any(panel.violations for panel in panels),
    }
    return wrap(" · ".join(sign for sign, there in signs.items() if there), MOST_LETTERS + 10)


def _panel(panel: Panel, top: float, number: int) -> tuple[list[SceneLayer], float]:
    """The panel's layers, and how much height it takes."""
    nest, cuts = panel.nest, panel.cuts
    xmin, ymin, xmax, ymax = nest.sheet.bounds
    scale = min((PAGE - 2 * MARGIN) / (xmax - xmin), MOST_HEIGHT / (ymax - ymin))
    high = (ymax - ymin) * scale
    view = View(nest.sheet.bounds, scale, MARGIN, PAGE, high, _PITCH, top + LINE)
    wrong = frozenset(name for violation in panel.violations for name in violation.contours if _is_of(nest, name))
    zones = zone_map(nest, {nest.contour(cut.contour).part: cut.zone for cut in cuts})
    order = {cut.contour: k for k, cut in enumerate(cuts, 1)}
    home = cuts.home if cuts.home != CutSequence(()).home else None
    layers = [
        sheet_layer(nest, view),
        part_layer(nest, view, zones, order),
        zone_layer(nest, view, zones, []),
        _side_layer(view, high, cuts.start_side),
        contour_layer(nest, view, order, wrong),
        travel_layer(view, tuple(cuts), home, [_TRAVEL] * (len(cuts) + 1)),
        direction_layer(nest, view, tuple(cuts)),
        _links(view, cuts),
        lead_layer(view, tuple(cuts)),
        pierce_layer(nest, view, tuple(cuts)),
        tab_layer(nest, view, tuple(cuts)),
        _hot_layer(view, cuts),
        _number_layer(nest, view, cuts, wrong),
    ]
    sentences = [violation.text for violation in panel.violations] or ["nothing is wrong"]
    below = [line for text in sentences for line in wrap(text, MOST_LETTERS)]
    ink = scene.ALERT if panel.violations else scene.INK
    floor = top + LINE + high
    texts = [TextLine(MARGIN, top + 6, panel.title, 12, scene.INK, "start", bold=True)]
    texts += [TextLine(MARGIN, floor + LINE * k - 4, text, 12, ink, "start") for k, text in enumerate(below, 1)]
    layers.append(SceneLayer("texts", tuple(texts)))
    return [SceneLayer(f"{layer.name}-{number}", layer.items) for layer in layers], high + LINE * (len(below) + 2)


def _is_of(nest: Nest, name: str) -> bool:
    return any(contour.id == name for contour in nest.contours)


def _links(view: View, cuts: CutSequence) -> SceneLayer:
    """A line from the end of a cut to one that is linked with it, where the case says no way for it."""
    style = Style(stroke=scene.OUTER, width=1.4)
    return SceneLayer(
        "links",
        tuple(
            Shape((np.array([view.point(a.end), view.point(b.pierce)]),), style, closed=False, cut=k)
            for k, (a, b) in enumerate(pairwise(cuts), 2)
            if b.linked and b.lead_in is None
        ),
    )


def _side_layer(view: View, high: float, side: Side | None) -> SceneLayer:
    """A bar along the side of the sheet that cutting starts from."""
    if side is None:
        return SceneLayer("side", ())
    x0, y0, x1, y1 = view.window
    left, top = view.point((x0, y1))
    right, bottom = view.point((x1, y0))
    ends = {
        "left": ((left, bottom), (left, top)),
        "right": ((right, bottom), (right, top)),
        "bottom": ((left, bottom), (right, bottom)),
        "top": ((left, top), (right, top)),
    }[side]
    return SceneLayer("side", (Shape((np.array(ends),), Style(stroke=scene.START, width=7), closed=False),))


def _hot_layer(view: View, cuts: CutSequence) -> SceneLayer:
    """A ring where the metal is hottest during a cut, and how hot it ever is there."""
    items: list[Item] = []
    hottest = {spot.at: spot for spot in sorted(cuts.hot_spots or (), key=lambda spot: spot.peak_c)}
    for spot in hottest.values():
        x, y = view.point(spot.at)
        items.append(Dot(x, y, 6, Style(stroke=scene.ALERT, width=2)))
        text = f"{spot.peak_c:.0f} °C"
        items.append(TextLine(x + 10, y, text, 12, scene.ALERT, "start", halo=scene.PAGE))
    return SceneLayer("heat", tuple(items))


def _number_layer(nest: Nest, view: View, cuts: CutSequence, wrong: frozenset[str]) -> SceneLayer:
    """A disc with the number of every cut beside its entry, clear of lines and of other discs where there is room."""
    lines = [
        (shapely.LinearRing if contour.curve.closed else shapely.LineString)(view.path(contour.curve))
        for contour in nest.contours
    ]
    for before, cut in zip((None, *cuts.cuts), cuts, strict=False):
        leads = (lead for lead in (cut.lead_in, cut.lead_out) if lead is not None and lead.segments)
        lines += [shapely.LineString(view.path(lead)) for lead in leads]
        if before is not None:
            lines.append(shapely.LineString([view.point(before.end), view.point(cut.pierce)]))
    lines += [shapely.Point(view.point(spot.at)).buffer(14) for spot in cuts.hot_spots or ()]
    taken = shapely.GeometryCollection(lines)
    items: list[Item] = []
    for k, cut in enumerate(cuts, 1):
        x, y = _clear(view.point(cut.entry), taken, view)
        taken = shapely.GeometryCollection([*taken.geoms, shapely.Point(x, y).buffer(_DISC)])
        items.append(Dot(x, y, _DISC, Style(fill=scene.ALERT if cut.contour in wrong else scene.INK), k))
        items.append(TextLine(x, y, str(k), 11, scene.PAGE, cut=k))
    return SceneLayer("numbers", tuple(items))


def _clear(near: Point, taken: shapely.Geometry, view: View) -> Point:
    """The place by a point where a disc has most room, within the picture; near ones first."""
    found: list[tuple[float, Point]] = []
    for x, y in _about(near):
        if 0.6 * MARGIN < x < PAGE - 0.6 * MARGIN and view.top < y < view.top + view.height:
            room = min(taken.distance(shapely.Point(x, y)), _DISC + 3)
            found.append((round(room - 0.05 * math.dist(near, (x, y)), 6), (x, y)))
    return max(found, key=lambda one: one[0])[1] if found else near


def _about(near: Point) -> Iterator[Point]:
    for far in (15.0, 20.0, 27.0):
        yield from ((near[0] + far * math.cos(angle), near[1] - far * math.sin(angle)) for angle in _ROUND)
