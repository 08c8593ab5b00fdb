"""Where the torch's centre must run: each contour grown or shrunk by half the kerf, made here by shapely alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import shapely

from kerfwise.encoder.nest import Contour

Side = Literal["right", "wrong", "on"]
_CHORD_MM = 0.005


def torch_rings(
    contours: Sequence[Contour], kerf_mm: float, side: Side = "right"
) -> list[shapely.LinearRing | shapely.LineString | None]:
    """The line the torch's centre follows around each contour; None where the kerf leaves nothing.

    "right" is half the kerf outside an outer contour and inside a hole, "wrong" the other way round, "on" the contour
    itself. Marks, slits and scrap lines are their own lines. Chords lie within 0.006 mm of the true curve.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> hole = Contour("P.hole1", "P", "hole", Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    >>> torch_rings([hole], 2.0)[0].length
    32.0
    """
    half = {"right": kerf_mm / 2, "wrong": -kerf_mm / 2, "on": 0.0}[side]
    rings: list[shapely.LinearRing | shapely.LineString | None] = []
    for contour in contours:
        if not contour.encloses or half == 0:
            rings.append(contour.curve.line(_CHORD_MM))
            continue
        area = shapely.make_valid(contour.curve.polygon(_CHORD_MM))
        grown = shapely.buffer(area, half if contour.kind == "outer" else -half, quad_segs=16)
        pieces = [p for p in shapely.get_parts(grown) if p.area > 0]
        rings.append(max(pieces, key=lambda p: float(p.area)).exterior if pieces else None)
    return rings
