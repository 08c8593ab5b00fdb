"""Which parts lose metal to the cuts of others, by plain geometry: the judging half of rule shared-metal."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest, Part
from kerfwise.encoder.tolerance import tolerance_mm

CHORD_MM = 0.002
"""Contours are judged by chords that lie this close to them."""
COARSE_MM = 0.05
"""What coarse chords of two contours may make of a distance, and more."""
SLACK_MM = 0.004
"""What the chords of two contours may make of a distance."""


@dataclass(frozen=True, slots=True)
class Burnt:
    """Two contours of different parts, one of which burns the other's part: the gap between them, mm, and where."""

    contours: tuple[str, str]
    gap_mm: float
    place: Point


def burnt_parts(nest: Nest, cut: Collection[str], kerf_mm: float) -> list[Burnt]:
    """Pairs of contours of which one or both are `cut`, the kerf in the waste of one reaching into the other part.

    Each pair once, in the order of the nest.
    """
    reach_mm = kerf_mm - tolerance_mm(kerf_mm) - SLACK_MM
    cutting = [c for c in nest.contours if c.id in cut and c.encloses]
    if reach_mm <= 0 or not cutting or len(nest.parts) < 2:
        return []
    cutting, beside = _nearly(nest, cutting, reach_mm + COARSE_MM)
    if not cutting:
        return []
    metal = np.array([metal_of(part) for part in beside], dtype=object)
    inside = shapely.point_on_surface(metal)
    areas = np.array([_area(c) for c in cutting], dtype=object)
    lines = np.array([c.curve.line(CHORD_MM) for c in cutting], dtype=object)
    rows, parts = shapely.STRtree(metal).query(lines, predicate="dwithin", distance=reach_mm)
    found: dict[tuple[str, str], Burnt] = {}
    for k, p in sorted(zip(rows.tolist(), parts.tolist(), strict=True)):
        contour, part = cutting[k], beside[p]
        if part.id == contour.part:
            continue
        if shapely.intersects(areas[k], inside[p]) != (contour.kind == "hole"):
            continue  # the part lies on the side that the kerf does not burn
        gap_mm = float(shapely.distance(lines[k], metal[p]))
        other = min(
            (c for c in (part.outer, *part.holes)),
            key=lambda c: round(float(shapely.distance(lines[k], c.curve.line(CHORD_MM))), 6),
        )
        one, two = sorted((contour.id, other.id), key=nest.index.__getitem__)
        middle = shapely.shortest_line(lines[k], metal[p]).centroid
        known = found.get((one, two))
        if known is None or gap_mm < known.gap_mm:
            found[one, two] = Burnt((one, two), gap_mm, (middle.x, middle.y))
    return sorted(found.values(), key=lambda b: tuple(nest.index[name] for name in b.contours))


def _nearly(nest: Nest, cutting: Sequence[Contour], reach_mm: float) -> tuple[list[Contour], list[Part]]:
    """The contours, and the parts of other contours, that are within reach in coarse chords; all where these cross."""
    metal = np.array([part.polygon for part in nest.parts], dtype=object)
    if not shapely.is_valid(metal).all():
        return list(cutting), list(nest.parts)
    lines = np.array([contour.line for contour in cutting], dtype=object)
    rows, parts = shapely.STRtree(metal).query(lines, predicate="dwithin", distance=reach_mm)
    number = {part.id: k for k, part in enumerate(nest.parts)}
    others = parts != np.array([number[contour.part] for contour in cutting])[rows]
    near, beside = np.unique(rows[others]).tolist(), np.unique(parts[others]).tolist()
    return [cutting[k] for k in near], [nest.parts[k] for k in beside]


def metal_of(part: Part) -> shapely.Geometry:
    """The metal of a part, whether shapely calls its rings valid or not."""
    holes = [_area(hole) for hole in part.holes]
    whole = _area(part.outer)
    return shapely.difference(whole, shapely.union_all(holes)) if holes else whole


def _area(contour: Contour) -> shapely.Geometry:
    area = contour.curve.polygon(CHORD_MM)
    return area if shapely.is_valid(area) else shapely.make_valid(area)
