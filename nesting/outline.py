"""What a part takes on the sheet: its outline and half the gap around it, with few vertices."""

from __future__ import annotations

import math

import shapely

from kerfwise.encoder.nest import Part

LOOSE_MM = 2e-4
"""Parts are grown by so much less than half the gap, so that what fits exactly is found to fit."""
CHORD_MM = 0.01
"""Chords of arcs lie so far inside at most."""
FEW = 16
"""Outlines with no more vertices are kept as they are."""
_MITRE = 1.5
_LEAST_SPLIT = 0.2
_SPLIT_SHARE = 0.003


def grown(part: Part, half_gap_mm: float) -> shapely.Polygon:
    """The part with half the gap around it and in its holes; holes that the gap fills are gone.

    Outlines of many vertices are laid around with fewer: at most 0.3 % of the part's size is lost.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import part, rect
    >>> tuple(round(x, 3) for x in grown(part("A", rect(0, 0, 40, 20)), 5.0).bounds)
    (-5.0, -5.0, 45.0, 25.0)
    """
    curved = any(segment.is_arc for contour in (part.outer, *part.holes) for segment in contour.curve.segments)
    by_mm = half_gap_mm - LOOSE_MM + (CHORD_MM if curved else 0.0)
    outer = _around(shapely.Polygon(part.polygon.exterior), by_mm)
    holes = (_within(shapely.Polygon(ring), by_mm) for ring in part.polygon.interiors)
    return outer.difference(shapely.union_all([hole for hole in holes if not hole.is_empty]))


def _around(polygon: shapely.Polygon, by_mm: float) -> shapely.Polygon:
    if len(polygon.exterior.coords) - 1 <= FEW:
        sharp = polygon.buffer(by_mm, join_style="mitre", mitre_limit=_MITRE)
        if by_mm <= 0:  # a sharp tip would lose much of its length
            near = not sharp.is_empty and shapely.hausdorff_distance(sharp, polygon) < 4 * LOOSE_MM
            return _outer(sharp) if near else polygon
        if sharp.covers(polygon.buffer(by_mm * (1 - 1e-6), quad_segs=8)):
            return _outer(sharp)
    split_mm = _split(polygon)
    wide = polygon.buffer(by_mm + split_mm, quad_segs=8) if by_mm + split_mm > 0 else polygon
    return _outer(_outer(wide).simplify(split_mm * 0.8))


def _within(hole: shapely.Polygon, by_mm: float) -> shapely.Geometry:
    """The room in a hole, or nothing."""
    few = len(hole.exterior.coords) - 1 <= FEW
    split_mm = 0.0 if few else _split(hole)
    room = hole.buffer(-by_mm - split_mm, join_style="mitre", mitre_limit=_MITRE)
    return room if few else room.simplify(split_mm * 0.8)


def _split(polygon: shapely.Polygon) -> float:
    x0, y0, x1, y1 = polygon.bounds
    return max(_LEAST_SPLIT, _SPLIT_SHARE * math.hypot(x1 - x0, y1 - y0))


def _outer(area: shapely.Geometry) -> shapely.Polygon:
    """The outline of the largest piece, without holes."""
    largest = max(shapely.get_parts(area), key=lambda piece: piece.area)
    return shapely.Polygon(largest.exterior)
