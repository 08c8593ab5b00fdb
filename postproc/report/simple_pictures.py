"""Simple pictures: programs without a plan, drawings as they were understood, nests at a thumb's size."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.reader.program import Burn

from . import scene
from .plot import png_bytes, render_picture, svg_text
from .scene import (
    ALERT,
    FAINT,
    INK,
    MARK,
    OUTER,
    PAGE,
    PIERCE,
    SHEET,
    Dot,
    Item,
    Scene,
    SceneLayer,
    Shape,
    Style,
    TextLine,
    View,
    Window,
    text_width,
    time_colour,
)

_LONG_PX, _GAP_PX, _HEAD_PX = 900.0, 24.0, 46.0
_CHORD_MM = 0.05
_NUMBER_PX = (7.0, 13.0)
_MOST_NUMBERS = 600


@dataclass(frozen=True, slots=True)
class Panel:
    """One program: two lines above the drawing, its burns in order, where the torch starts and where it ends.

    The burns in `loud`, counted from 0, are red. The first burn has the number `first`.
    """

    title: str
    told: str
    burns: Sequence[Burn]
    home: Point
    end: Point
    loud: frozenset[int] = frozenset()
    first: int = 1


def draw_burns(panels: Sequence[Panel], suffix: str, title: str) -> str | bytes:
    """All panels in one picture, to one scale; below each other where the sheet is wide.

    `panels`: at least one, with at least one burn in all. `suffix`: ".svg", or ".png".
    """
    scene = burns_scene(panels, title)
    return png_bytes(scene) if suffix.lower() == ".png" else svg_text(scene)


def expect_kind(path: str) -> None:
    """Say at once that no picture of burns can be drawn to a file of such a name.

    Raises InputError with those that can be.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".svg", ".png"):
        raise InputError(f"cannot draw a program as {suffix or path!r}: give a name ending in .svg or .png", file=path)


def burns_scene(panels: Sequence[Panel], title: str) -> Scene:
    """The same picture as a scene."""
    x0, y0, x1, y1 = _bounds(panels)
    wide, high = max(x1 - x0, 1.0), max(y1 - y0, 1.0)
    px = _LONG_PX / max(wide, high)
    below = wide > 1.2 * high
    size = max(wide * px, 380.0) + _GAP_PX, high * px + _HEAD_PX + _GAP_PX
    layers = []
    for k, panel in enumerate(panels):
        left, top = (0.0, k * size[1]) if below else (k * size[0], 0.0)
        place = _Place(x0, y1, px, left + _GAP_PX / 2, top + _HEAD_PX)
        frame = np.array([place.at(p) for p in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))])
        ground = (Shape((frame,), Style(fill=SHEET)), *_headings(panel, place))
        layers.append(SceneLayer(f"program-{k + 1}", (*ground, *_items(panel, place))))
    count = len(panels)
    width, height = (size[0], size[1] * count) if below else (size[0] * count, size[1])
    return Scene(width, height, tuple(layers), escape_text(title), 1.5)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where on the page points of the sheet are."""

    x_mm: float
    y_mm: float
    px: float
    left: float
    top: float

    def at(self, point: Sequence[float]) -> Point:
        """A point of the page."""
        return self.left + (point[0] - self.x_mm) * self.px, self.top + (self.y_mm - point[1]) * self.px


def _bounds(panels: Sequence[Panel]) -> Box:
    paths = [burn.path.flatten(_CHORD_MM) for panel in panels for burn in panel.burns]
    points = np.concatenate([*paths, np.array([p for panel in panels for p in (panel.home, panel.end)])])
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    margin = 0.03 * max(x1 - x0, y1 - y0, 1.0)
    return x0 - margin, y0 - margin, x1 + margin, y1 + margin


def _headings(panel: Panel, place: _Place) -> Iterator[Item]:
    yield TextLine(place.left, place.top - 32, escape_text(panel.title), 15.0, INK, "start", bold=True)
    yield TextLine(place.left, place.top - 13, escape_text(panel.told), 12.0, FAINT, "start")


def _items(panel: Panel, place: _Place) -> Iterator[Item]:
    burns = panel.burns
    for k, burn in enumerate(burns, 1):
        path = np.array([place.at(p) for p in burn.path.flatten(_CHORD_MM).tolist()])
        yield Shape((path,), _pen(burn, k - 1 in panel.loud), closed=False, cut=k)
    first = [burn for burn in burns if burn.torch == 1]
    stops = [panel.home, *(p for burn in first for p in burn.path.vertices[[0, -1], :2].tolist()), panel.end]
    for k, (begin, end) in enumerate(zip(stops[::2], stops[1::2], strict=True)):
        if math.dist(begin, end) > 0:
            way = np.array([place.at(begin), place.at(end)])
            style = Style(stroke=time_colour(k / max(len(burns), 1)), width=1.0, dash=(5.0, 3.0))
            yield Shape((way,), style, closed=False, cut=min(k + 1, len(burns)))
    size = min(max(90.0 / math.sqrt(len(burns)), _NUMBER_PX[0]), _NUMBER_PX[1])
    for k, burn in enumerate(burns, 1):
        x, y = place.at(burn.path.start)
        yield Dot(x, y, size / 5, Style(fill=PIERCE), cut=k)
        if len(burns) <= _MOST_NUMBERS:
            yield TextLine(x + size / 3, y - size / 2, str(k + panel.first - 1), size, INK, "start", halo=PAGE, cut=k)
    x, y = place.at(panel.home)
    yield Dot(x, y, 4.0, Style(fill=None, stroke=INK, width=1.5))


def _pen(burn: Burn, loud: bool) -> Style:
    if loud:
        return Style(stroke=ALERT, width=2.0)
    return Style(stroke=MARK if burn.tool else OUTER, width=1.2)


# A nest as a picture of a thumb's size: the parts, and how the torch travels between them.

WIDTH, HEIGHT = 240, 150
"""Page units that a thumbnail fits in."""
_MARGIN = 3.0
_STRAY = 0.25  # page units that a simplified line may stray from its curve


def thumbnail(nest: Nest, plan: Plan | None = None, alert: Collection[str] = ()) -> str:
    """The nest as a small SVG text without numbers or names: the same nest and plan give the same text.

    Idle travel is drawn where there is a plan, dark at the start and light at the end; contours whose ids are in
    `alert` are red.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> thumbnail(nest(100, 50, part("A", rect(10, 10, 30, 30)))).startswith('<svg xmlns="http://www.w3.org/2000/svg" ')
    True
    """
    frame = _Frame.of(nest)
    ordered = sorted(nest.parts, key=lambda part: -abs(part.outer.polygon.area))
    zones = {} if plan is None else {nest.contour(p.cut.contour).part: p.cut.zone for p in plan.cuts}
    shapes = [_path([frame.path(nest.sheet.outline), *map(frame.path, nest.sheet.holes)], fill=scene.SHEET,
                    stroke=scene.FAINT)]  # fmt: skip
    for part in ordered:
        fill = scene.zone_tint(zones[part.id] - 1) if zones.get(part.id) else scene.PART
        rings = [frame.path(part.outer.curve), *(frame.path(hole.curve) for hole in part.holes)]
        shapes.append(_path(rings, fill=fill, stroke=scene.OUTER))
    shapes += [_path([frame.path(c.curve)], stroke=scene.ALERT, width=1.6) for c in nest.contours if c.id in alert]
    if plan is not None:
        shapes += _travel(frame, plan)
    width, height = _number(frame.width), _number(frame.height)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
    return f"{head}{''.join(shapes)}</svg>"


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where the millimetres of the sheet fall: its upper left corner, and page units a millimetre."""

    x0: float
    y1: float
    scale: float
    width: float
    height: float

    @staticmethod
    def of(nest: Nest) -> _Frame:
        x0, y0, x1, y1 = nest.sheet.bounds
        wide, high = max(x1 - x0, 1e-6), max(y1 - y0, 1e-6)
        scale = min((WIDTH - 2 * _MARGIN) / wide, (HEIGHT - 2 * _MARGIN) / high)
        return _Frame(x0, y1, scale, wide * scale + 2 * _MARGIN, high * scale + 2 * _MARGIN)

    def xy(self, points: Floats) -> Floats:
        return np.column_stack([points[:, 0] - self.x0, self.y1 - points[:, 1]]) * self.scale + _MARGIN

    def path(self, curve: Curve) -> str:
        points = self.xy(np.asarray(curve.flatten(_STRAY / self.scale), dtype=np.float64).reshape(-1, 2))
        if curve.closed and len(points) > 2:
            points = shapely.get_coordinates(shapely.LinearRing(points).simplify(_STRAY))[:-1]
        return f"M{_points(points)}{'Z' if curve.closed else ''}"


def _travel(frame: _Frame, plan: Plan) -> Iterator[str]:
    """Idle travel from each cut to the next, in as many colours as it goes through."""
    cuts = [planned.cut for planned in plan.cuts if planned.cut.torch == 1]
    for k, (cut, after) in enumerate(pairwise(cuts)):
        if not after.linked:
            line = frame.xy(np.array([cut.end, after.pierce]))
            yield _path([f"M{_points(line)}"], stroke=scene.time_colour(k / len(cuts)), width=0.9)


def _points(points: Floats) -> str:
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points.tolist())


def _number(value: float) -> str:
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def _path(paths: Sequence[str], *, fill: str = "none", stroke: str, width: float = 0.5) -> str:
    data = "".join(paths)
    return f'<path d="{data}" fill="{fill}" fill-rule="evenodd" stroke="{stroke}" stroke-width="{width:g}"/>'


# A drawing as it was understood: what is cut, marked, left out and unknown, each in a colour of its own.

STYLES = {
    "sheet": ("the sheet", Style(stroke="#495057", width=1.6)),
    "ignore": ("left out", Style(stroke="#adb5bd", width=1.0, dash=(4.0, 3.0))),
    "scrap": ("scrap lines", Style(stroke="#7950f2", width=1.2)),
    "bridge": ("bridges", Style(stroke="#7950f2", width=1.2)),
    "tab": ("tabs", Style(stroke="#7950f2", width=2.0)),
    "cut": ("cut", Style(stroke="#1971c2", width=1.4)),
    "mark": ("marked", Style(stroke="#2f9e44", width=1.4)),
    "repaired": ("repaired", Style(stroke="#f08c00", width=3.0)),
    "unknown": ("unknown: a question", Style(stroke="#e03131", width=2.4, dash=(7.0, 4.0))),
}
"""What lines are taken for → words, and how they are drawn; later ones lie above earlier ones."""

_READING_PICTURE_MARGIN = 0.03


def reading_picture(
    lines: Sequence[tuple[str, Curve]], nest: Nest | None, title: str, suffix: str, bold: float = 1.0
) -> bytes:
    """The picture as the content of a file.

    `lines`: curves in mm, each with what it is taken for: a key of `STYLES`. `nest`: what was made of them, for the
    sheet and its contours; None where nothing could be. `title`: stands above the drawing. `suffix`: ".svg", ".png" or
    ".pdf". `bold`: how many times as thick lines and letters are, for a picture that is shown small.
    """
    rows = list(lines) or ([(_of(c.kind), c.curve) for c in nest.contours] if nest is not None else [])
    if nest is not None:
        rows += [("sheet", curve) for curve in (nest.sheet.outline, *nest.sheet.holes)]
        fixed = {name for note in nest.notes if note.severity == "repaired" for name in note.contours}
        rows += [("repaired", contour.curve) for contour in nest.contours if contour.id in fixed]
    view = View.of(_window([curve for _, curve in rows]), len(rows), 1.0)
    layers = [
        SceneLayer(
            kind,
            tuple(Shape((view.path(curve),), _bold(style, bold), curve.closed) for of, curve in rows if of == kind),
        )
        for kind, (_, style) in STYLES.items()
    ]
    used = {kind for kind, _ in rows}
    texts = (TextLine(28, 16 + 18 * bold, title, 18 * bold, INK, "start", True), *_legend(used, view.height - 26, bold))
    return render_picture(Scene(view.width, view.height, (*layers, SceneLayer("legend", tuple(texts))), title), suffix)


def _of(kind: str) -> str:
    return {"mark": "mark", "scrap": "scrap"}.get(kind, "cut")


def _window(curves: Sequence[Curve]) -> Window:
    lines = np.array([curve.line() for curve in curves], dtype=object)
    x0, y0, x1, y1 = shapely.total_bounds(lines).tolist() if len(lines) else (0.0, 0.0, 1.0, 1.0)
    room = _READING_PICTURE_MARGIN * max(x1 - x0, y1 - y0)
    return x0 - room, y0 - room, x1 + room, y1 + room


def _bold(style: Style, bold: float) -> Style:
    return replace(style, width=style.width * bold, dash=tuple(bold * length for length in style.dash))


def _legend(used: set[str], y: float, bold: float) -> Iterator[Item]:
    x = 28.0
    for kind, (words, style) in STYLES.items():
        if kind in used:
            yield Shape((np.array([[x, y], [x + 34.0 * bold, y]]),), _bold(style, bold), closed=False)
            yield TextLine(x + 42.0 * bold, y, words, 14 * bold, INK, "start")
            x += 66.0 * bold + text_width(words, 14 * bold)
