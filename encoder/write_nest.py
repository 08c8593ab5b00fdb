"""A nest as text of the format kerfwise-nest/1, which `readers.json_nest` reads, and the units of a DXF of one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from .geometry.curve import Curve
from .nest import Contour, Nest, Part, Sheet


def nest_json(nest: Nest) -> str:
    """The nest as kerfwise-nest/1, a part a line."""
    rows = ",\n  ".join(json.dumps(_part(part), ensure_ascii=False) for part in nest.parts)
    sheet = json.dumps(_sheet(nest.sheet))
    scrap = json.dumps([_open(line.curve) for line in nest.scrap])
    more = f',\n "scrap": {scrap}' if nest.scrap else ""
    return f'{{"format": "kerfwise-nest/1", "units": "mm",\n "sheet": {sheet},\n "parts": [\n  {rows}\n ]{more}}}\n'


def _part(part: Part) -> dict[str, Any]:
    source = part.outer.source
    drawn = {"layer": source.layer, "colour": source.colour, "block": source.block}
    attributes = {key: value for key, value in drawn.items() if value} | part.attributes
    entry: dict[str, Any] = {"id": part.id, **attributes, "outer": part.outer.curve.as_rows()}
    if part.holes:
        entry["holes"] = [hole.curve.as_rows() for hole in part.holes]
    if part.marks:
        entry["marks"] = [_open(mark.curve) for mark in part.marks]
    if part.tabs:
        entry["tabs"] = [{"at": tab.at, **({"width": tab.width_mm} if tab.width_mm else {})} for tab in part.tabs]
    contours = (("outer", part.outer), *((f"hole{k}", hole) for k, hole in enumerate(part.holes, 1)))
    bevels = [{"of": of, **row} for of, contour in contours for row in _bevels(contour)]
    return entry | ({"bevel": bevels} if bevels else {})


def _bevels(contour: Contour) -> Iterator[dict[str, Any]]:
    """The bevels of a contour as a nest file has them, those of single edges with the numbers of their vertices."""
    if contour.bevel is not None:
        yield contour.bevel.as_json()
    each = contour.bevel_of_edge if contour.edge_bevels else ()
    for bevel in dict.fromkeys(one for one in each if one is not None):
        yield bevel.as_json() | {"edges": [k for k, one in enumerate(each, 1) if one == bevel]}


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


_DXF_IN_MM = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n9\n$MEASUREMENT\n70\n1\n0\nENDSEC\n"


def dxf_in_mm(text: str) -> str:
    """A DXF without a header, with one that says that it is in millimetres: who reads it does not have to ask.

    Examples
    --------
    >>> dxf_in_mm("0\\nSECTION\\n2\\nENTITIES\\n").count("SECTION")
    2
    """
    return _DXF_IN_MM + text
