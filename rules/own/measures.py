"""The facts that own rules select by, measured from a nest with plain shapely.

The check judges by these alone; the facts that models are built on are not looked at here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.placement import host_holes, places

from .criterion import ROUNDING_MM


@dataclass(frozen=True, eq=False, slots=True)
class MeasuredNest:
    """What values are measured from: a nest, the zones that its cuts state, and two thresholds."""

    nest: Nest
    zones: Mapping[str, int]
    long_ratio: float
    web_mm: float


def measured(nest: Nest, cuts: CutSequence | None, long_ratio: float, web_mm: float) -> MeasuredNest:
    """What there is to measure; without cuts no zone is known."""
    return MeasuredNest(nest, {cut.contour: cut.zone for cut in cuts or () if cut.zone}, long_ratio, web_mm)


def areas_mm2(nest: Nest) -> list[float]:
    """Area inside every contour, 0 for a mark or a slit."""
    return [float(c.polygon.area) if c.encloses else 0.0 for c in nest.contours]


def lengths_mm(nest: Nest) -> list[float]:
    """Length of every contour."""
    return [c.curve.length_mm for c in nest.contours]


def sizes_mm(nest: Nest, axis: int) -> list[float]:
    """Extent of every contour along x (axis 0) or y (axis 1)."""
    bounds = _bounds_mm(nest)
    return _listed(bounds[:, axis + 2] - bounds[:, axis])


def rectangle_sides_mm(nest: Nest, longer: bool) -> list[float]:
    """The longer or the shorter side of the smallest rectangle, at any angle, around every contour."""
    sides = _rectangles_mm(nest)
    return _listed(sides.max(axis=1) if longer else sides.min(axis=1))


def is_long(m: MeasuredNest) -> list[bool]:
    """Outer contours whose smallest rectangle has one side at least `long_ratio` times the other (Petunin 2009)."""
    sides = _rectangles_mm(m.nest)
    slim = sides.max(axis=1) >= m.long_ratio * sides.min(axis=1) * (1 - 1e-9)
    return [bool(s) and c.kind == "outer" for s, c in zip(slim, m.nest.contours, strict=True)]


def edge_gaps_mm(nest: Nest, side: str) -> list[float]:
    """Distance of every contour from a side of the sheet, from the nearest of the four where side is `edge`."""
    xmin, ymin, xmax, ymax = nest.sheet.bounds
    bounds = _bounds_mm(nest)
    gaps = {
        "left": bounds[:, 0] - xmin,
        "right": xmax - bounds[:, 2],
        "bottom": bounds[:, 1] - ymin,
        "top": ymax - bounds[:, 3],
    }
    return _listed(np.min(list(gaps.values()), axis=0) if side == "edge" else gaps[side])


def hosts(m: MeasuredNest) -> list[str]:
    """Id of the part in whose hole a contour's part lies, "" for none."""
    of_part = host_holes(m.nest)
    return [of_part[c.part].part if c.part in of_part else "" for c in m.nest.contours]


def depths(m: MeasuredNest) -> list[int]:
    """How many contours lie around every contour."""
    host = host_holes(m.nest)

    def of_part(part: str) -> int:
        depth = 0
        while part in host:
            part, depth = host[part].part, depth + 2
        return depth

    return [of_part(c.part) + (c.kind not in ("outer", "scrap")) for c in m.nest.contours]


def neighbour_counts(m: MeasuredNest) -> list[int]:
    """How many other parts in the same place come as near as `web_mm` to each outer contour; 0 for holes and marks."""
    at = places(m.nest, host_holes(m.nest))
    return count_near(m.nest, [at[part.id] for part in m.nest.parts], m.web_mm)


def count_near(nest: Nest, place: Sequence[object], web_mm: float) -> list[int]:
    """For every contour the number of other parts of the same place within `web_mm`; `place` is given part by part."""
    lines = [part.outer.line for part in nest.parts]
    a, b = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=web_mm + ROUNDING_MM)
    count = [0] * len(nest.contours)
    for first, second in zip(a.tolist(), b.tolist(), strict=True):
        if first != second and place[first] == place[second]:
            count[nest.index[nest.parts[first].outer.id]] += 1
    return count


def zones(m: MeasuredNest) -> list[int | None]:
    """The zone that the cut of every contour states, None where it states none."""
    return [m.zones.get(c.id) for c in m.nest.contours]


def attributes(nest: Nest, name: str) -> list[Any]:
    """What the nest's file says of every contour's part under that name, None where it says nothing."""
    return [nest.part_of[c.part].attributes.get(name) if c.part else None for c in nest.contours]


def _bounds_mm(nest: Nest) -> Floats:
    return np.asarray(shapely.bounds([c.line for c in nest.contours]), dtype=np.float64).reshape(-1, 4)


def _rectangles_mm(nest: Nest) -> Floats:
    """Two sides (n, 2) of the smallest rectangle around every contour."""
    lines = np.array([c.line for c in nest.contours], dtype=object)
    hulls = shapely.convex_hull(lines)
    flat = shapely.get_dimensions(hulls) < 2
    sides = np.zeros((len(lines), 2))
    corners = shapely.get_coordinates(shapely.oriented_envelope(lines[~flat])).reshape(-1, 5, 2)
    for k in (0, 1):
        sides[~flat, k] = np.hypot(*(corners[:, k + 1] - corners[:, k]).T)
    sides[flat, 0] = shapely.length(hulls[flat])
    return sides


def _listed(values: Floats) -> list[float]:
    return [float(v) for v in values]
