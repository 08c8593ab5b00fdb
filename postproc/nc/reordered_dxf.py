"""A DXF drawing in cutting order: its own entities, untouched but for their order, or a nest's contours."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.models.plan.plan import Plan

from .drawn_order import DrawnOrder, DrawnPlace, Reordered, contours_in_order, notes_of
from .dxf_out import LAYERS

SHEET_LAYER = "SHEET"
_BY_BLOCK, _BY_LAYER = 0, 256
"""Numbers of colours that say whose colour an entity has."""


def reordered_dxf(plan: Plan, nest: Nest, file: str | Path, options: ReadOptions) -> Reordered:
    """The drawing of a nest with its entities in the order of the plan.

    Entities of a DXF keep geometry, layer, colour and all else; blocks that hold contours are taken apart. What the
    plan does not cut stays in front. Another kind of nest file is drawn from its contours: a polyline each, arcs as
    bulges, from its entry on and in its direction. The same plan gives the same bytes.

    Raises
    ------
    InputError
        If the file cannot be read any more.
    """
    if Path(file).suffix.lower() != ".dxf":
        return Reordered(_from_contours(plan, nest))
    from kerfwise.encoder.readers.dxf import document_of, mm_per_unit

    document = document_of(Path(file))
    space = document.modelspace()
    order = DrawnOrder(plan, nest, options)
    scale = mm_per_unit(Path(file), document, options)
    lost: set[str] = set()
    moved: list[tuple[DrawnPlace, int, Any]] = []
    for entity in list(space):
        pieces = list(_pieces(entity, document, order, scale))
        lost.update(place.dropped for _, place in pieces if place.dropped)
        if not any(place.position or place.dropped for _, place in pieces):
            continue
        if pieces[0][0] is not entity:
            space.delete_entity(entity)
        else:
            space.unlink_entity(entity)
        moved += [(place, len(moved) + k, piece) for k, (piece, place) in enumerate(pieces) if not place.dropped]
    for _, _, entity in sorted(moved, key=lambda row: row[:2]):
        space.add_entity(entity)
    text = io.StringIO()
    with _without_dates():
        document.write(text)
    return Reordered(document.encode(text.getvalue()), notes_of(lost))


def _pieces(entity: Any, document: Any, order: DrawnOrder, scale: float) -> Iterator[tuple[Any, DrawnPlace]]:
    """The entity with its place; of a block all that it holds, each on the layer that it is seen on."""
    from kerfwise.encoder.readers.dxf import hidden_layers
    from kerfwise.encoder.readers.dxf_entities import curve, entities
    from kerfwise.encoder.readers.unread import Unread

    for piece, layer, _ in entities([entity], hidden_layers(document), Unread()):
        drawn = curve(piece, scale)
        if piece is not entity:
            piece.dxf.layer = layer
            if piece.dxf.get("color", _BY_LAYER) == _BY_BLOCK:
                piece.dxf.color = entity.dxf.get("color", _BY_LAYER)
        yield piece, DrawnPlace(0) if drawn is None else order.place(drawn)


@contextmanager
def _without_dates() -> Iterator[None]:
    """The library writes when and by whom a drawing was saved, unless it is told that this is a test."""
    import ezdxf

    options: Any = vars(ezdxf)["options"]
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def _from_contours(plan: Plan, nest: Nest) -> bytes:
    from ezdxf.addons.r12writer import r12writer

    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for curve in (nest.sheet.outline, *nest.sheet.holes) if nest.sheet.stated else ():
            drawing.add_polyline_2d(curve.vertices.tolist(), format="xyb", closed=True, layer=SHEET_LAYER)
        for contour, curve in contours_in_order(plan, nest):
            rows = curve.vertices.tolist()
            drawing.add_polyline_2d(rows, format="xyb", closed=curve.closed, layer=LAYERS[contour.kind])
    return text.getvalue().encode("ascii")
