"""A picture as a list of shapes and texts in page units, whatever draws it: nothing here knows SVG or PNG.

The page has its origin at the top left, x to the right and y down; one unit is one pixel at the usual size.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from kerfwise.arrays import Floats

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
_WIDE = frozenset("mwMW@%—→")


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
