"""SVG files to a drawing: groups are its layers."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import svgelements

from ..errors import InputError
from .drawing import Drawing, Piece
from .foreign import FOREIGN_ERRORS
from .options import ReadOptions
from .svg_page import page_of
from .svg_paths import curves
from .svg_sound import sound

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def read_svg(data: bytes, options: ReadOptions) -> Drawing:
    """Every shape that is shown, in mm with y up; writing and images are passed over.

    Parameters
    ----------
    data
        The file's bytes.
    options
        `units` says what a user unit (of the viewBox) is.

    Raises
    ------
    InputError
        When the file is no SVG or a shape in it cannot be understood.
    """
    try:
        svg = svgelements.SVG.parse(io.BytesIO(sound(data)), reify=True, ppi=96)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error
    if not isinstance(svg, svgelements.SVG):
        raise InputError("not an SVG file: its root is no <svg> element")
    try:
        page = page_of(svg, options)
        drawn = [(c, layer) for shape, layer in _shapes(svg, ()) for c in curves(shape, page.to_mm)]
    except FOREIGN_ERRORS as error:
        raise InputError(f"a shape of this SVG file is damaged ({error}); save it anew as plain SVG") from error
    pieces = tuple(Piece(c, layer, order) for order, (c, layer) in enumerate(drawn))
    return Drawing(pieces, page.units, page=page.sheet)


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
