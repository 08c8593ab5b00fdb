"""Where the parts of a nest lie, as the judging of rules sees it.

Plain shapely on purpose, and nothing from the facts that models are built on: a wrong fact must not hide here too.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Contour, Nest


@kept_with_nest(most=2)
def host_holes(nest: Nest) -> Mapping[str, Contour]:
    """Part id → the hole of another part that it lies in, for every part that lies in one (the smallest, if nested).

    A part may touch the hole it lies in: a point well inside the part decides. Kept with the nest.
    """
    holes = [hole for part in nest.parts for hole in part.holes]
    if not holes:
        return {}
    areas = shapely.area([hole.polygon for hole in holes])
    inner = [part.outer.polygon for part in nest.parts]
    which, hole = shapely.STRtree([h.polygon for h in holes]).query(shapely.point_on_surface(inner), "intersects")
    found: dict[str, int] = {}
    for k, h in sorted(zip(which.tolist(), hole.tolist(), strict=True)):
        part = nest.parts[k]
        if areas[h] > inner[k].area and (part.id not in found or areas[h] < areas[found[part.id]]):
            found[part.id] = h
    return {part_id: holes[h] for part_id, h in found.items()}


def places(nest: Nest, host: Mapping[str, Contour]) -> dict[str, str]:
    """Part id → id of the hole it lies in, "" for a part straight on the sheet."""
    return {part.id: host[part.id].id if part.id in host else "" for part in nest.parts}


def same_place(nest: Nest, first: Ints, second: Ints) -> tuple[Ints, Ints]:
    """The pairs of different parts that lie in the same place, as sorted numbers in the nest."""
    at = places(nest, host_holes(nest))
    number = {name: k for k, name in enumerate(dict.fromkeys(at.values()))}
    place = np.array([number[at[part.id]] for part in nest.parts], dtype=np.int64)
    same = (first != second) & (place[first] == place[second])
    order = np.lexsort((second[same], first[same]))
    return first[same][order], second[same][order]


def well_within(nest: Nest, points: Any, parts: Ints, off_mm: float) -> Bools:
    """Whether points (k,) lie within the outer contours of parts (k,), given by number, and farther than that off."""
    areas = np.array([part.outer.polygon for part in nest.parts], dtype=object)
    lines = np.array([part.outer.line for part in nest.parts], dtype=object)
    within = shapely.contains(areas[parts], points) & ~shapely.dwithin(lines[parts], points, off_mm)
    return np.asarray(within)
