"""Where the torch's centre must run: each contour grown or shrunk by half the kerf, made here by shapely alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import polygons_of
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Contour, Nest

Side = Literal["right", "wrong", "on"]
Ring: TypeAlias = shapely.LinearRing | shapely.LineString
_CHORD_MM = 0.005


def torch_rings(contours: Sequence[Contour], kerf_mm: float, side: Side = "right") -> list[Ring | None]:
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
    rings: list[Ring | None] = [
        None if contour.encloses and half else contour.curve.line(_CHORD_MM) for contour in contours
    ]
    beside = [k for k, ring in enumerate(rings) if ring is None]
    if not beside:
        return rings
    areas = shapely.make_valid(polygons_of([contours[k].curve for k in beside], _CHORD_MM))
    by_mm = [half if contours[k].kind == "outer" else -half for k in beside]
    pieces, of = shapely.get_parts(shapely.buffer(areas, by_mm, quad_segs=16), return_index=True)
    sizes = shapely.area(pieces)
    by_size = np.lexsort((np.arange(len(of)), -sizes, of))
    largest = by_size[np.flatnonzero(np.diff(of[by_size], prepend=-1))]
    largest = largest[sizes[largest] > 0]
    for k, ring in zip(of[largest].tolist(), shapely.get_exterior_ring(pieces[largest]), strict=True):
        rings[beside[k]] = ring
    return rings


@kept_with_nest(most=1)
def rings_of(nest: Nest, kerf_mm: float) -> tuple[Ring | None, ...]:
    """The right ring of every contour of a nest; kept with it, for a plan and its program."""
    return tuple(torch_rings(nest.contours, kerf_mm))
