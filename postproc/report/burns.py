"""Programs without a plan as a picture: what each burns, in which order, and the travel; several side by side."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.shown import shown
from kerfwise.postproc.check.reader.program import Burn

from .colours import ALERT, FAINT, INK, MARK, OUTER, PAGE, PIERCE, SHEET, time_colour
from .png import png_bytes
from .scene import Dot, Item, Scene, SceneLayer, Shape, Style, TextLine
from .svg import svg_text

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

    Parameters
    ----------
    panels
        At least one, with at least one burn in all.
    suffix
        ".svg", or ".png".
    title
        Of the picture.
    """
    scene = burns_scene(panels, title)
    return png_bytes(scene) if suffix.lower() == ".png" else svg_text(scene)


def expect_kind(path: str) -> None:
    """Say at once that no picture of burns can be drawn to a file of such a name.

    Raises
    ------
    InputError
        With those that can be.
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
    return Scene(width, height, tuple(layers), shown(title), 1.5)


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
    yield TextLine(place.left, place.top - 32, shown(panel.title), 15.0, INK, "start", bold=True)
    yield TextLine(place.left, place.top - 13, shown(panel.told), 12.0, FAINT, "start")


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
        x, y = place.at(burn.path.vertices[0, :2].tolist())
        yield Dot(x, y, size / 5, Style(fill=PIERCE), cut=k)
        if len(burns) <= _MOST_NUMBERS:
            yield TextLine(x + size / 3, y - size / 2, str(k + panel.first - 1), size, INK, "start", halo=PAGE, cut=k)
    x, y = place.at(panel.home)
    yield Dot(x, y, 4.0, Style(fill=None, stroke=INK, width=1.5))


def _pen(burn: Burn, loud: bool) -> Style:
    if loud:
        return Style(stroke=ALERT, width=2.0)
    return Style(stroke=MARK if burn.tool else OUTER, width=1.2)
