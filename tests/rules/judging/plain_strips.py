"""Narrow strips and islands, cut by cut, each from all that is out by then: slow, and simple enough to judge others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import shapely

from kerfwise import Nest

SIDES, SPECK_MM2, ISLAND = 4, 1.0, 10.0
Told = tuple[int, str, int]
"""The cut, "strip" or "island", and the part that lies badly."""


def told_plainly(nest: Nest, order: Sequence[str], strip_mm: float, web_mm: float) -> list[Told]:
    """What lies badly on a sheet of parts that host no others, told once a part."""
    areas = np.array([part.outer.polygon for part in nest.parts], dtype=object)
    number = {part.outer.id: k for k, part in enumerate(nest.parts)}
    ground, out, told, found = nest.sheet.polygon, list[int](), set[int](), list[Told]()
    for k, name in enumerate(order, 1):
        out.append(number[name])
        left = [q for q in range(len(areas)) if q not in out]
        wrong = [
            *_in_strips(areas, ground, out, left, strip_mm, web_mm),
            *_on_islands(areas, ground, out, left, strip_mm, web_mm),
        ]
        for kind, q in wrong:
            if q not in told:
                told.add(q)
                found.append((k, kind, q))
    return found


def _in_strips(
    areas: Any, ground: Any, out: Sequence[int], left: Sequence[int], strip_mm: float, web_mm: float
) -> Iterator[tuple[str, int]]:
    swept = shapely.buffer(areas[out], (strip_mm + web_mm) / 2, quad_segs=SIDES)
    wide = shapely.buffer(ground, -strip_mm / 2, quad_segs=SIDES).difference(shapely.union_all(swept))
    opened = shapely.buffer(wide, strip_mm / 2, quad_segs=SIDES)
    for q in left:
        takers = [p for p, taken in zip(out, swept, strict=True) if taken.intersects(areas[q])]
        ways = [_way(areas[q].centroid, areas[p]) for p in takers]
        on_two_sides = any(one @ other < 0 for one, other in combinations(ways, 2))
        if on_two_sides and areas[q].difference(opened).area > areas[q].area / 2:
            yield "strip", q


def _way(middle: Any, area: Any) -> Any:
    begin, end = shapely.get_coordinates(shapely.shortest_line(middle, area))
    return end - begin


def _on_islands(
    areas: Any, ground: Any, out: Sequence[int], left: Sequence[int], strip_mm: float, web_mm: float
) -> Iterator[tuple[str, int]]:
    grown = shapely.buffer(areas[out], web_mm / 2, quad_segs=SIDES)
    rim = grown[-1].exterior.intersection(ground).difference(shapely.union_all(grown[:-1]))
    arcs = shapely.get_parts(shapely.line_merge(rim))
    if sum(arc.length > 0 and not arc.is_closed for arc in arcs) < 2:  # the cut divides nothing
        return
    for piece in shapely.get_parts(ground.difference(shapely.union_all(grown))):
        x0, y0, x1, y1 = piece.bounds
        if max(x1 - x0, y1 - y0) > ISLAND * strip_mm or piece.area <= SPECK_MM2 or not piece.dwithin(grown[-1], 1e-6):
            continue
        on_it = [q for q in left if piece.intersects(areas[q].point_on_surface())]
        elsewhere = [q for q in left if q not in on_it]
        if on_it and elsewhere:
            yield "island", min(elsewhere if len(elsewhere) < len(on_it) else on_it)
