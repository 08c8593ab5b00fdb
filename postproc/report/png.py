"""A scene as PNG, drawn by matplotlib without a display."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .scene import CAP_HEIGHT, HALO, Dot, Item, Scene, Shape, Style, TextLine

if TYPE_CHECKING:
    from matplotlib.collections import PathCollection
    from matplotlib.path import Path


def png_bytes(scene: Scene) -> bytes:
    """The scene as a PNG file, `scene.enlarge` pixels a page unit; the same scene gives the same bytes."""
    # Loading matplotlib takes longer than drawing an SVG, so only those who want a PNG pay for it.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    # At 72 dots per inch a point, the unit of line widths, is one page unit.
    figure = Figure(figsize=(scene.width / 72, scene.height / 72), dpi=72 * scene.enlarge, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0, scene.width)
    axes.set_ylim(scene.height, 0)
    for collection in as_collections(scene):
        axes.add_collection(collection, autolim=False)
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()


def as_collections(
    scene: Scene, scale: float = 1.0, without: Callable[[TextLine], bool] = lambda text: False
) -> Iterator[PathCollection]:
    """Everything as collections of paths, from the bottom up; lines are `scale` times as wide.

    Texts that are `without` are left to whoever writes them in another way.
    """
    from matplotlib.collections import PathCollection

    for depth, (_, group) in enumerate(groupby(_stroked(scene, without), key=_dash)):
        painted = list(group)
        yield PathCollection(
            [p.path for p in painted],
            facecolors=[p.style.fill or "none" for p in painted],
            edgecolors=[p.style.stroke or "none" for p in painted],
            linewidths=[scale * p.style.width if p.style.stroke else 0.0 for p in painted],
            linestyles=[_dash(painted[0])],
            capstyle="round",
            joinstyle="round",
            zorder=depth,
        )


class _Stroked(NamedTuple):
    path: Path
    style: Style


def _dash(painted: _Stroked) -> str | tuple[float, tuple[float, ...]]:
    """The dash as matplotlib has it, in line widths."""
    style = painted.style
    return (0.0, tuple(d / style.width for d in style.dash)) if style.dash else "solid"


def _stroked(scene: Scene, without: Callable[[TextLine], bool]) -> Iterator[_Stroked]:
    """Everything as paths from the bottom up; in a layer the rims of all texts lie below all texts."""
    for layer in scene:
        texts = [item for item in layer.items if isinstance(item, TextLine) and not without(item)]
        for item in layer.items:
            if not isinstance(item, TextLine):
                yield _Stroked(_path(item), item.style)
        paths = [_text_path(text) for text in texts]
        for text, path in zip(texts, paths, strict=True):
            if text.halo:
                yield _Stroked(path, Style(stroke=text.halo, width=HALO * text.size))
        for text, path in zip(texts, paths, strict=True):
            yield _Stroked(path, Style(fill=text.colour))


def _path(item: Item) -> Path:
    from matplotlib.path import Path

    if isinstance(item, Dot):
        return Path.circle((item.x, item.y), item.radius)
    assert isinstance(item, Shape)
    if not item.closed:
        return Path.make_compound_path(*(Path(line) for line in item.lines))
    rings = (np.concatenate([line, line[:1]]) for line in item.lines)
    return Path.make_compound_path(*(Path(ring, closed=True) for ring in rings))


def _text_path(text: TextLine) -> Path:
    """The outlines of the letters: far quicker than matplotlib's own texts where there are a thousand numbers."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.path import Path
    from matplotlib.textpath import TextToPath, text_to_path

    font = FontProperties(family="DejaVu Sans", weight="bold" if text.bold else "normal")
    points, codes = text_to_path.get_text_path(font, text.text)
    if len(points) == 0:
        return Path(np.zeros((0, 2)))
    points = np.asarray(points) * (text.size / TextToPath.FONT_SCALE)
    width = float(points[:, 0].max())
    x = points[:, 0] - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * width
    y = text.size * CAP_HEIGHT / 2 - points[:, 1]
    x, y = (y, -x) if text.turned else (x, y)
    return Path(np.column_stack([x + text.x, y + text.y]), codes)
