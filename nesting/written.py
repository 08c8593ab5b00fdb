"""Layouts as nests, and nests as text: kerfwise-nest/1, arcs as arcs, and DXF."""

from __future__ import annotations

import io
import json
from collections import Counter
from typing import Any

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Part, Sheet

from .allot import Layout

OF = "of"
"""The key of a part in a nest that names the part type."""


def nests_of(layout: Layout) -> list[Nest]:
    """A nest a sheet; copies are numbered through all sheets: `name-1`, `name-2`…"""
    count: Counter[int] = Counter()
    nests = []
    for sheet in layout.sheets:
        parts = []
        for one in sheet.placed:
            count[one.kind] += 1
            kind = layout.wanted.types[one.kind]
            made = one.part(kind.part, f"{kind.name}-{count[one.kind]}")
            told: dict[str, object] = {OF: kind.name, "priority": kind.priority}
            made.attributes.update(told | ({"order": kind.order} if kind.order else {}))
            parts.append(made)
        nests.append(Nest(sheet.stock.sheet, tuple(parts)))
    return nests


def nest_json(nest: Nest) -> str:
    """The nest as kerfwise-nest/1, a part a line."""
    rows = ",\n  ".join(json.dumps(_part(part), ensure_ascii=False) for part in nest.parts)
    sheet = json.dumps(_sheet(nest.sheet))
    return f'{{"format": "kerfwise-nest/1", "units": "mm",\n "sheet": {sheet},\n "parts": [\n  {rows}\n ]}}\n'


def _part(part: Part) -> dict[str, Any]:
    made: dict[str, Any] = {"id": part.id, **part.attributes, "outer": part.outer.curve.as_rows()}
    if part.holes:
        made["holes"] = [hole.curve.as_rows() for hole in part.holes]
    if part.marks:
        made["marks"] = [_open(mark.curve) for mark in part.marks]
    if part.tabs:
        made["tabs"] = [{"at": tab.at, **({"width": tab.width_mm} if tab.width_mm else {})} for tab in part.tabs]
    return made


def _open(curve: Curve) -> list[list[float]]:
    """A mark's rows; one that closes ends where it began."""
    rows = curve.as_rows()
    return [*rows, rows[0][:2]] if curve.closed else rows


def _sheet(sheet: Sheet) -> dict[str, Any]:
    x0, y0, x1, y1 = sheet.bounds
    if not sheet.holes and (x0, y0) == (0, 0) and sheet.polygon.area == x1 * y1:
        return {"width": x1, "height": y1}
    return {
        "outline": sheet.outline.as_rows(),
        **({"holes": [h.as_rows() for h in sheet.holes]} if sheet.holes else {}),
    }


def nest_dxf(nest: Nest) -> str:
    """The nest as DXF R12, mm: the sheet on layer SHEET, contours on CUT, marks on MARK, arcs as bulges."""
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for curve in (nest.sheet.outline, *nest.sheet.holes):
            drawing.add_polyline_2d(curve.vertices.tolist(), format="xyb", closed=True, layer="SHEET")
        for contour in nest.contours:
            rows, layer = contour.curve.vertices.tolist(), "MARK" if contour.kind == "mark" else "CUT"
            drawing.add_polyline_2d(rows, format="xyb", closed=contour.curve.closed, layer=layer)
    return text.getvalue()
