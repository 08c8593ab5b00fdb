"""What `repair` can mend in contours, each mend with its note."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Note, Part
from kerfwise.encoder.validate.rings import flat, place, speck

from .arcs import FLATTEN_MM, fitted

DOMINANT = 0.95
"""A ring that crosses itself is mended if one of the rings it falls into has this share of the whole area."""


def mended(nest: Nest) -> Nest:
    """The nest without holes, marks and parts that enclose nothing, and with rings that cross no line of their own.

    A ring without one dominant loop stays as it is, for the checks to report. Contours keep their ids.
    """
    notes: list[Note] = []
    parts = [p for p in (_mended_part(part, notes) for part in nest.parts) if p is not None]
    return replace(nest, parts=tuple(parts), notes=(*nest.notes, *notes))


def _mended_part(part: Part, notes: list[Note]) -> Part | None:
    gone = [c for c in part if (speck if c.kind == "mark" else flat)(c.curve)]
    if part.outer in gone and len(part.holes) + len(part.marks) > len(gone) - 1:
        gone.remove(part.outer)  # a part that still holds something is no speck: let the checks report it
    notes += [Note("repaired", f"{c.id} encloses nothing, {place(c.curve)}: left out", (c.id,)) for c in gone]
    if part.outer in gone:
        return None
    holes = tuple(_mended_ring(h, notes) for h in part.holes if h not in gone)
    marks = tuple(m for m in part.marks if m not in gone)
    return replace(part, outer=_mended_ring(part.outer, notes), holes=holes, marks=marks)


def _mended_ring(contour: Contour, notes: list[Note]) -> Contour:
    if flat(contour.curve) or contour.polygon.is_valid:
        return contour
    polygon = contour.curve.polygon(FLATTEN_MM)
    pieces = [g for g in shapely.get_parts(shapely.make_valid(polygon)) if g.geom_type == "Polygon"]
    whole = sum(g.area for g in pieces)
    largest = max(pieces, key=lambda g: g.area, default=shapely.Polygon())
    ring = shapely.Polygon(largest.exterior)
    if not whole or largest.area < DOMINANT * whole or ring.area - largest.area > (1 - DOMINANT) * whole:
        return contour
    curve = fitted(np.array(ring.exterior.coords))
    if curve is None or not curve.polygon().is_valid:
        curve = Curve.of(ring.exterior.coords[:-1])
    reason = shapely.is_valid_reason(polygon)
    lost = f"{len(pieces) - 1} loops of {whole - largest.area:.3f} mm² in all are cut off"
    notes.append(Note("repaired", f"{contour.id} crossed itself ({reason}): {lost}", (contour.id,)))
    return replace(contour, curve=curve)
