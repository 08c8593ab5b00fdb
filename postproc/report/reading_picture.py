"""A drawing as it was understood: what is cut, marked, left out and unknown, each in a colour of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest

from .colours import INK
from .plot import drawn
from .scene import Item, Scene, SceneLayer, Shape, Style, TextLine, text_width
from .view import View, Window

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

_MARGIN = 0.03


def reading_picture(lines: Sequence[tuple[str, Curve]], nest: Nest | None, title: str, suffix: str) -> bytes:
    """The picture as the content of a file.

    Parameters
    ----------
    lines
        Curves in mm, each with what it is taken for: a key of `STYLES`.
    nest
        What was made of them, for the sheet and its contours; None where nothing could be.
    title
        Stands above the drawing.
    suffix
        ".svg", ".png" or ".pdf".
    """
    rows = list(lines) or ([(_of(c.kind), c.curve) for c in nest.contours] if nest is not None else [])
    if nest is not None:
        rows += [("sheet", curve) for curve in (nest.sheet.outline, *nest.sheet.holes)]
        fixed = {name for note in nest.notes if note.severity == "repaired" for name in note.contours}
        rows += [("repaired", contour.curve) for contour in nest.contours if contour.id in fixed]
    view = View.of(_window([curve for _, curve in rows]), len(rows), 1.0)
    layers = [
        SceneLayer(kind, tuple(Shape((view.path(curve),), style, curve.closed) for of, curve in rows if of == kind))
        for kind, (_, style) in STYLES.items()
    ]
    used = {kind for kind, _ in rows}
    texts = (TextLine(28, 34, title, 18, INK, "start", True), *_legend(used, view.height - 26))
    return drawn(Scene(view.width, view.height, (*layers, SceneLayer("legend", tuple(texts))), title), suffix)


def _of(kind: str) -> str:
    return {"mark": "mark", "scrap": "scrap"}.get(kind, "cut")


def _window(curves: Sequence[Curve]) -> Window:
    lines = np.array([curve.line() for curve in curves], dtype=object)
    x0, y0, x1, y1 = shapely.total_bounds(lines).tolist() if len(lines) else (0.0, 0.0, 1.0, 1.0)
    room = _MARGIN * max(x1 - x0, y1 - y0)
    return x0 - room, y0 - room, x1 + room, y1 + room


def _legend(used: set[str], y: float) -> Iterator[Item]:
    x = 28.0
    for kind, (words, style) in STYLES.items():
        if kind in used:
            yield Shape((np.array([[x, y], [x + 34.0, y]]),), style, closed=False)
            yield TextLine(x + 42.0, y, words, 14, INK, "start")
            x += 66.0 + text_width(words, 14)
