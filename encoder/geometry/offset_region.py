"""The area a closed curve bounds when it is grown or shrunk, as a ring of chords: where offset curves must lie."""

from __future__ import annotations

import math

import numpy as np
import shapely

from kerfwise.arrays import Floats

CHORD_MM = 0.001
"""How far the ring's own rounding may lie from the true offset."""
SLIVER_MM = 0.02
"""A separate piece nowhere wider than this is an artefact of tolerances and is left out."""


def offset_ring(outline: Floats, distance_mm: float, patient: bool = False) -> Floats:
    """Boundary of the area inside `outline` grown (distance > 0) or shrunk (distance < 0), or of its largest piece.

    Where the area grown closes around a pocket, the ring runs past its mouth; where shrunk it falls into pieces, the
    ring is that of the largest. What is lost of the outline then, `encoder.narrow` finds.
    Taken from the band of points within `distance_mm` of the outline rather than from the area, so that outlines
    that touch or cross themselves are as good as any other.

    Parameters
    ----------
    outline
        Array (n, 2), the outline without its first point repeated.
    distance_mm
        How far to go, mm, not 0.
    patient
        GEOS evens out shallow hollows of a line before it buffers it, by up to a few hundredths of the distance.
        Where that shows, the band is put together from the bands of the single chords instead, a hundred times slower.

    Returns
    -------
    Array (m, 2), running the same way round as the outline, first point not repeated.

    Raises
    ------
    ValueError
        If nothing is left.
    """
    reach_mm = abs(distance_mm)
    closed = np.concatenate([outline, outline[:1]])
    half_step_rad = math.acos(max(1 - CHORD_MM / reach_mm, 0.5))
    chords = np.stack([closed[:-1], closed[1:]], axis=1)
    lines = shapely.linestrings(chords) if patient else shapely.LineString(closed)
    band = shapely.union_all(shapely.buffer(lines, reach_mm, quad_segs=math.ceil(math.pi / 4 / half_step_rad)))
    if distance_mm > 0:
        ring = band.exterior
    else:
        inside = shapely.Polygon(closed)
        shapely.prepare(inside)
        gaps = [shapely.Polygon(ring) for ring in band.interiors]
        pieces = [gap for gap in gaps if shapely.contains_xy(inside, *gap.representative_point().coords[0])]
        pieces.sort(key=lambda piece: -piece.area)
        if not pieces or _is_sliver(pieces[0]):
            raise ValueError(f"shrunk by {reach_mm:g} mm nothing is left: nowhere is it {2 * reach_mm:g} mm wide")
        ring = pieces[0].exterior
    points: Floats = shapely.get_coordinates(ring)[:-1]
    return points if _is_ccw(points) == _is_ccw(outline) else points[::-1]


def _is_sliver(piece: shapely.Polygon) -> bool:
    return bool(shapely.buffer(piece, -SLIVER_MM / 2).is_empty)


def _is_ccw(points: Floats) -> bool:
    (x, y), (nx, ny) = (points - points[0]).T, (np.roll(points, -1, axis=0) - points[0]).T
    return bool(np.dot(x, ny) > np.dot(nx, y))
