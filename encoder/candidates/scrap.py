"""Lines that cut up the skeleton, held against the parts: the kerf of none may come near one."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.tolerance import tolerance_mm


def scrap_problems(nest: Nest, kerf_mm: float) -> list[str]:
    """A sentence for each scrap line and part that are less than the kerf apart, in the order of the lines.

    One kerf from the part is where the part's own kerf ends; a line that ends there meets that kerf.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> square = part("A", rect(50, 50, 50, 50))
    >>> scrap_problems(nest(200, 150, square, scrap=[[(0, 75), (48.5, 75)]]), 1.5)
    []
    >>> print(*scrap_problems(nest(200, 150, square, scrap=[[(0, 75), (49, 75)]]), 1.5))
    scrap1 comes within 1.000 mm of A.outer at (50.0, 75.0), less than the kerf of 1.5 mm: keep it a kerf away
    """
    lines = np.array([c.line for c in nest.scrap], dtype=object)
    outers = np.array([part.outer.line for part in nest.parts], dtype=object)
    if not len(lines) or not len(outers):
        return []
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
