"""Lines that cut up the skeleton, with their kerf: that of none may come near a part, and none may sever another."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap.whole import carrying, skeleton, where_severed
from kerfwise.encoder.tolerance import tolerance_mm


def scrap_problems(nest: Nest, kerf_mm: float) -> list[str]:
    """A sentence for each scrap line and part that are less than the kerf apart, and for each line that others sever.

    One kerf from the part is where the part's own kerf ends; a line that ends there meets that kerf.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> square = part("A", rect(50, 50, 50, 50))
    >>> scrap_problems(nest(200, 150, square, scrap=[[(0, 75), (48.5, 75)]]), 1.5)
    []
    >>> print(*scrap_problems(nest(200, 150, square, scrap=[[(0, 75), (49, 75)]]), 1.5))
    scrap1 comes within 1.000 mm of A.outer at (50.0, 75.0), less than the kerf of 1.5 mm: keep it a kerf away
    >>> crossed = nest(200, 150, scrap=[[(90, 0), (90, 150)], [(0, 60), (90, 60)], [(90, 60), (200, 60)]])
    >>> print(*scrap_problems(crossed, 1.5))
    scrap1 is cut in two by the lines that end on it at (90.0, 60.0): draw it as two lines that meet there
    """
    return [*_near_parts(nest, kerf_mm), *_severed(nest, kerf_mm)]


def _severed(nest: Nest, kerf_mm: float) -> list[str]:
    lines = [c.line for c in nest.scrap]
    if len(lines) < 2:  # nothing else ends on it
        return []
    metal = carrying(skeleton(nest.sheet.polygon, [part.outer.polygon for part in nest.parts], kerf_mm), kerf_mm)
    found = []
    for k, places_mm in where_severed(lines, metal, kerf_mm).items():
        points = shapely.get_coordinates(shapely.line_interpolate_point(lines[k], places_mm)).tolist()
        places = " and ".join(f"({x:z.1f}, {y:z.1f})" for x, y in points)
        told = f"{nest.scrap[k].id} is cut in two by the lines that end on it at {places}"
        found.append(f"{told}: draw it as {'two' if len(points) == 1 else len(points) + 1} lines that meet there")
    return found


def _near_parts(nest: Nest, kerf_mm: float) -> list[str]:
    if not nest.scrap or not nest.parts:
        return []
    lines = np.array([c.line for c in nest.scrap], dtype=object)
    outers = np.array([part.outer.line for part in nest.parts], dtype=object)
    least_mm = kerf_mm - tolerance_mm(kerf_mm)
    row, other = shapely.STRtree(outers).query(lines, predicate="dwithin", distance=least_mm)
    found = []
    for k, p in sorted(zip(row.tolist(), other.tolist(), strict=True)):
        gap_mm = float(shapely.distance(lines[k], outers[p]))
        x, y = shapely.get_coordinates(shapely.shortest_line(lines[k], outers[p]))[-1].tolist()
        found.append(
            f"{nest.scrap[k].id} comes within {gap_mm:.3f} mm of {nest.parts[p].outer.id} at ({x:z.1f}, {y:z.1f}), "
            f"less than the kerf of {kerf_mm:g} mm: keep it a kerf away"
        )
    return found
