"""SVG files to a drawing: mm from the page's size, y turned up, groups as layers."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from typing import Any

import svgelements

from ..errors import InputError
from ..nest import Sheet
from .drawing import Drawing, Piece
from .foreign import FOREIGN_ERRORS
from .options import ReadOptions
from .svg_paths import curves
from .units import DRAWN_MM, MM_PER

PX_PER_INCH = 96
MM_PER_SVG_LENGTH = {"mm": 1.0, "cm": 10.0, "q": 0.25, "in": 25.4, "pt": 25.4 / 72, "pc": 25.4 / 6}
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def read_svg(data: bytes, options: ReadOptions) -> Drawing:
    """Every shape that is shown, in mm with y up; writing and images are passed over.

    Parameters
    ----------
    data
        The file's bytes.
    options
        `units` says what a user unit (of the viewBox) is; without it the page's width decides, 96 px an inch where
        that has no unit.

    Raises
    ------
    InputError
        When the file is no SVG or a shape in it cannot be understood.
    """
    try:
        svg = svgelements.SVG.parse(io.BytesIO(data), reify=True, ppi=PX_PER_INCH)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error
    if not isinstance(svg, svgelements.SVG):
        raise InputError("not an SVG file: its root is no <svg> element")
    try:
        shapes = [(shape, layer) for shape, layer in _shapes(svg, ())]
        scale, units = _mm_per_px(svg, options)
        page = _page(svg, scale)
        height_mm = page.bounds[3] if page else 0.0
        drawn = [(c, layer) for shape, layer in shapes for c in curves(shape, scale, height_mm)]
    except FOREIGN_ERRORS as error:
        raise InputError(f"a shape of this SVG file is damaged ({error}); save it anew as plain SVG") from error
    pieces = tuple(Piece(c, layer, order) for order, (c, layer) in enumerate(drawn))
    return Drawing(pieces, units, page=page)


def _shapes(group: Any, names: tuple[str, ...]) -> Iterator[tuple[Any, str]]:
    """Each shown shape with its layer: the ids and labels of the groups around it and its own id."""
    for element in group:
        own = tuple(str(n) for n in (element.values.get(LABEL), element.id) if n is not None and str(n) not in names)
        if element.values.get("tag") == "symbol":
            raise InputError("the drawing holds <symbol> elements; unlink the clones and save it as plain SVG")
        if isinstance(element, svgelements.Group | svgelements.Use):
            yield from _shapes(element, (*names, *own))
        elif isinstance(element, svgelements.Shape) and element.values.get("visibility") != "hidden":
            yield element, "/".join((*names, *own))


def _mm_per_px(svg: Any, options: ReadOptions) -> tuple[float, str]:
    """Millimetres per pixel of svgelements, and what the drawing is in.

    svgelements rounds the inch in a millimetre; measuring its pixels by the page's width undoes that.
    """
    if options.units is not None:
        px_per_user_unit = svgelements.Matrix(svg.viewbox_transform or "").a
        return MM_PER[options.units] / px_per_user_unit, options.units
    for side, px in (("width", svg.width), ("height", svg.height)):
        given = re.fullmatch(r"\s*([0-9.eE+-]+)\s*([a-zA-Z]+)\s*", str(svg.values.get(side)))
        if given and given[2].lower() in MM_PER_SVG_LENGTH:
            return float(given[1]) * MM_PER_SVG_LENGTH[given[2].lower()] / px, "mm"
    return DRAWN_MM["px"], "px"


def _page(svg: Any, scale: float) -> Sheet | None:
    """The drawing area, where the file gives one."""
    if not svg.viewbox and not (svg.values.get("width") and svg.values.get("height")):
        return None
    width, height = svg.width * scale, svg.height * scale
    return Sheet.rectangle(width, height) if width > 0 and height > 0 else None
