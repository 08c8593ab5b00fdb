"""SVG files to a drawing: groups are its layers."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import svgelements

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Note
from kerfwise.encoder.still_going import so_much

from .drawing import Drawing, DrawnCurve
from .foreign import FOREIGN_ERRORS
from .layers import Layers, Purpose
from .options import ReadOptions
from .svg_page import page_of
from .svg_paths import curves
from .svg_sound import sound
from .writing import writing_note

NUMBERED = re.compile(
    "(path|rect|circle|ellipse|line|polyline|polygon|g|group|use|text|tspan|image|layer|svg)[-_]?[0-9][-_0-9]*"
)
"""Ids that a drawing program numbers on by itself: `text12` says nothing of what a shape is for."""
DRAWN = (svgelements.Shape, svgelements.Text, svgelements.Image)
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def read_svg(data: bytes, options: ReadOptions) -> Drawing:
    """Every shape that is shown, in mm with y up; writing and images are passed over, and that is said.

    Parameters
    ----------
    data
        The file's bytes.
    options
        `units` says what a user unit (of the viewBox) is, `layers` what the groups are for.

    Raises
    ------
    InputError
        When the file is no SVG or a shape in it cannot be understood.
    """
    svg = parsed_svg(data)
    try:
        page = page_of(svg, options)
        shown = list(shown_elements(svg))
        so_much(len(shown), "shape", "shapes")
        drawn = [
            (c, s) for s in shown if isinstance(s.element, svgelements.Shape) for c in curves(s.element, page.to_mm)
        ]
    except FOREIGN_ERRORS as error:
        raise InputError(f"a shape of this SVG file is damaged ({error}); save it again as plain SVG") from error
    pieces = tuple(DrawnCurve(c, s.layer, order, s.names) for order, (c, s) in enumerate(drawn))
    return Drawing(pieces, page.units, tuple(_unread(shown, options.layers)), page.sheet)


def parsed_svg(data: bytes) -> Any:
    """The root of a file, as its library has it.

    Raises
    ------
    InputError
        If it is no SVG that can be read.
    """
    try:
        svg = svgelements.SVG.parse(io.BytesIO(sound(data)), reify=True, ppi=96)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error
    if not isinstance(svg, svgelements.SVG):
        raise InputError("not an SVG file: its root is no <svg> element")
    return svg


@dataclass(frozen=True, slots=True)
class Shown:
    """A shape or a text with the layer it is said to be on, and every name that says what it is for."""

    element: Any
    layer: str
    names: tuple[str, ...]


def shown_elements(group: Any, layers: tuple[str, ...] = (), names: tuple[str, ...] = ()) -> Iterator[Shown]:
    """Each shown shape and text. Its names are the ids and labels of the groups around it, then its own."""
    for element in group:
        if element.values.get("tag") == "symbol":
            raise InputError("the drawing holds <symbol> elements; unlink the clones and save it as plain SVG")
        label = element.values.get(LABEL)
        label = None if label in layers else label  # svgelements hands on the label of the group around
        known = [n for n in (element.id, label) if n is not None and not NUMBERED.fullmatch(str(n))]
        own = tuple(dict.fromkeys(str(n) for n in known if n not in names))
        called = [str(n) for n in (label, element.id) if n is not None][:1]
        if isinstance(element, svgelements.Group | svgelements.Use):
            yield from shown_elements(element, (*layers, *called), (*names, *own))
        elif isinstance(element, DRAWN) and element.values.get("visibility") != "hidden":
            yield Shown(element, "/".join(layers or called), (*names, *own))


def _unread(shown: Sequence[Shown], layers: Layers) -> list[Note]:
    found: dict[tuple[str, Purpose | None], list[str]] = {}
    for one in shown:
        if isinstance(one.element, svgelements.Text) and (text := str(one.element.text or "").strip()):
            found.setdefault((one.layer, layers.use(one.names).purpose), []).append(text)
    notes = [writing_note(texts, layer, use) for (layer, use), texts in found.items() if use != "ignore"]
    if images := sum(isinstance(one.element, svgelements.Image) for one in shown):
        count = "1 image is" if images == 1 else f"{images} images are"
        notes.append(Note("warning", f"{count} left out: trace to paths what is to be cut"))
    return notes
