"""A picture as a list of shapes and texts in page units, its colours, and where millimetres fall on the page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import ArrayLike

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve, flattened
from kerfwise.encoder.geometry.segment import Point

# A picture as a list of shapes and texts in page units, whatever draws it: nothing here knows SVG or PNG.
#
# The page has its origin at the top left, x to the right and y down; one unit is one pixel at the usual size.

Anchor = Literal["start", "middle", "end"]

CAP_HEIGHT = 0.74
"""Height of digits and capitals in DejaVu Sans, as a share of the font size."""

HALO = 0.22
"""Width of the rim around a text, as a share of the font size; half of it lies outside the letters."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a shape is painted; colours as `#rrggbb`, None for not at all. Dash lengths in page units."""

    fill: str | None = None
    stroke: str | None = None
    width: float = 0.0
    dash: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """One or more polylines, closed or open, painted together. Holes run the other way round than what they are in.

    `cut` is the place in the cutting order that the shape belongs to, 0 where it belongs to none; `title` is shown
    by viewers that have tooltips.
    """

    lines: tuple[Floats, ...]
    style: Style
    closed: bool = True
    cut: int = 0
    title: str = ""


@dataclass(frozen=True, slots=True)
class Dot:
    """A small disc."""

    x: float
    y: float
    radius: float
    style: Style
    cut: int = 0


@dataclass(frozen=True, slots=True)
class TextLine:
    """One line of text; (x, y) is its anchor, half way up the capitals. `halo` is the colour of a thin rim.

    `turned` texts read from the bottom to the top.
    """

    x: float
    y: float
    text: str
    size: float
    colour: str = "#212529"
    anchor: Anchor = "middle"
    bold: bool = False
    halo: str | None = None
    turned: bool = False
    cut: int = 0


Item = Shape | Dot | TextLine


@dataclass(frozen=True, eq=False, slots=True)
class SceneLayer:
    """Items of one sort; later layers lie above earlier ones."""

    name: str
    items: tuple[Item, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Scene:
    """A whole picture. `enlarge` is the pixels a page unit needs for its small texts to be read."""

    width: float
    height: float
    layers: tuple[SceneLayer, ...]
    title: str = ""
    enlarge: float = 1.0

    def __iter__(self) -> Iterator[SceneLayer]:
        return iter(self.layers)

    def layer(self, name: str) -> tuple[Item, ...]:
        """The items of the layer of that name (KeyError if there is none)."""
        return {layer.name: layer.items for layer in self.layers}[name]


_NARROW = frozenset(" .,:;'|!()[]fijlrtI-·")
_WIDE = frozenset("mwMW@%—→ЖМФШЩЫЮжмфшщыю")


def text_width(text: str, size: float, bold: bool = False) -> float:
    """An upper estimate of the width of a text in DejaVu Sans; digits are exact.

    Examples
    --------
    >>> round(text_width("12", 10), 2)
    12.72
    """
    narrow, digit, letter, wide = (0.5, 0.696, 0.8, 1.11) if bold else (0.42, 0.636, 0.7, 1.0)
    widths = (narrow if c in _NARROW else wide if c in _WIDE else digit if c.isdigit() else letter for c in text)
    return size * sum(widths)


# The colours of the pictures: soft tints for zones, a perceptual scale for time, one dark ink each for the rest.

SHEET = "#eceef0"
PAGE = "#ffffff"
INK = "#212529"
NAME = "#495057"
FAINT = "#868e96"
OUTER = "#343a40"
HOLE = "#9c3612"
MARK = "#1971c2"
SLIT = "#087f5b"
SCRAP = "#7048e8"
STRETCH = "#ae3ec9"
TAB = "#2b8a3e"
ACROSS = "#e8590c"
PIERCE = "#d6001c"
FURTHER = "#0b7285"
ALERT = "#e03131"
WAIT = "#7b2cbf"
START = "#f08c00"
PART = "#c5d7e6"

_ZONES = ("#b3d1ea", "#f8d9a8", "#bfe0b4", "#dcc6e8", "#f3b9b0", "#f1e79f", "#aadfd6", "#d9c9b1")
# viridis (matplotlib) from 0 to 0.85 in even steps: its yellow end cannot be read on a light ground.
_TIME = ("#440154", "#472c7a", "#3b518b", "#2c718e", "#21908d", "#27ad81", "#5cc863", "#97d83f")


def zone_tint(colour: int) -> str:
    """The tint of a zone's colour number, which may be any natural number."""
    return _ZONES[colour % len(_ZONES)]


def zone_tints() -> int:
    """How many tints there are before they repeat."""
    return len(_ZONES)


def shade(colour: str, share: float) -> str:
    """The colour mixed with black; 0 leaves it, 1 is black.

    Examples
    --------
    >>> shade("#ff8000", 0.5)
    '#804000'
    """
    return mix(colour, "#000000", share)


def mix(first: str, second: str, share: float) -> str:
    """`share` of the second colour in the first, both `#rrggbb`."""
    a, b = (tuple(int(c[k : k + 2], 16) for k in (1, 3, 5)) for c in (first, second))
    return "#" + "".join(f"{round(x + (y - x) * share):02x}" for x, y in zip(a, b, strict=True))


def time_colour(share: float) -> str:
    """The colour of a moment, 0 the start of the program and 1 its end.

    Examples
    --------
    >>> time_colour(0.0), time_colour(1.0)
    ('#440154', '#97d83f')
    """
    place = min(max(share, 0.0), 1.0) * (len(_TIME) - 1)
    k = min(int(place), len(_TIME) - 2)
    return mix(_TIME[k], _TIME[k + 1], place - k)


# Where the millimetres of a nest fall on the page, and how fine a pen the picture needs.

Window = tuple[float, float, float, float]

PAGE_WIDTH = 1600.0
MARGIN = 28.0
HEADER = 70.0
FOOTER = 62.0
_MAX_DRAWING_HEIGHT = 1240.0
_MIN_PAGE_WIDTH = 1080.0
_CHORD = 0.03  # page units that a flattened line may stray from its curve: not seen at ten times the size


@dataclass(frozen=True, slots=True)
class View:
    """A window of the nest (xmin, ymin, xmax, ymax in mm) on a page; `pitch` is the room a contour has, page units.

    The window begins at `left` and `top` of the page.
    """

    window: Window
    scale: float
    left: float
    width: float
    height: float
    pitch: float
    top: float = HEADER

    @staticmethod
    def of(window: Window, contours: int, used_mm2: float) -> View:
        """Fit the window on a page of usual size; `contours` are seen in it, on a rectangle of `used_mm2`."""
        x0, y0, x1, y1 = window
        wide, high = max(x1 - x0, 1e-6), max(y1 - y0, 1e-6)
        scale = min((PAGE_WIDTH - 2 * MARGIN) / wide, _MAX_DRAWING_HEIGHT / high)
        width = max(wide * scale + 2 * MARGIN, _MIN_PAGE_WIDTH)
        pitch = scale * math.sqrt(used_mm2 / max(contours, 1))
        return View(window, scale, (width - wide * scale) / 2, width, high * scale + HEADER + FOOTER, pitch)

    def xy(self, points: ArrayLike) -> Floats:
        """Points (n, 2) in mm as page points."""
        p = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        x0, _, _, y1 = self.window
        return np.column_stack([(p[:, 0] - x0) * self.scale + self.left, (y1 - p[:, 1]) * self.scale + self.top])

    def point(self, point: Sequence[float]) -> Point:
        """One point in mm as a page point."""
        x0, _, _, y1 = self.window
        return float((point[0] - x0) * self.scale + self.left), float((y1 - point[1]) * self.scale + self.top)

    def path(self, curve: Curve) -> Floats:
        """A curve as page points, no more than the eye can tell; a closed one does not repeat its first."""
        return self.paths([curve])[0]

    def paths(self, curves: Sequence[Curve]) -> list[Floats]:
        """As `path` of each, made together."""
        if not curves:
            return []
        tolerance_mm = _CHORD / self.scale
        points = flattened(curves, tolerance_mm)
        closed = np.array([curve.closed for curve in curves], dtype=np.bool_)
        wide = np.array([len(own) >= 3 for own in points], dtype=np.bool_)
        for some, made in ((wide & closed, shapely.linearrings), (wide & ~closed, shapely.linestrings)):
            chosen = np.flatnonzero(some).tolist()
            if not chosen:
                continue
            own = [points[k] for k in chosen]
            lines = made(np.concatenate(own), indices=np.repeat(np.arange(len(own)), [len(p) for p in own]))
            rows, of = shapely.get_coordinates(shapely.simplify(lines, tolerance_mm), return_index=True)
            last = np.searchsorted(of, np.arange(len(own)), side="right")
            for k, begin, end in zip(chosen, [0, *last.tolist()], last.tolist(), strict=False):
                points[k] = rows[begin : end - bool(closed[k])]
        return np.split(self.xy(np.concatenate(points)), np.cumsum([len(own) for own in points])[:-1])

    @property
    def mm(self) -> float:
        """Millimetres in one page unit."""
        return 1 / self.scale

    @property
    def line_width(self) -> float:
        """Width of a contour line, page units."""
        return min(max(0.014 * self.pitch, 0.4), 1.4)

    @property
    def number_size(self) -> float:
        """Font size of order numbers where there is room for it, page units."""
        return min(max(0.22 * self.pitch, 6.5), 15.0)

    @property
    def dot_radius(self) -> float:
        """Radius of a pierce point, page units."""
        return min(max(0.025 * self.pitch, 0.9), 3.0)

    @property
    def arrow_size(self) -> float:
        """Length of an arrow head, page units."""
        return min(max(0.1 * self.pitch, 3.0), 9.0)
