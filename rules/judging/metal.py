"""The metal of one place with the parts that lie in it: what strips and islands are looked for in, whatever the order.

It is looked up once: which parts may take metal from around which, and which see each other over metal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints

QUADRANT = 4
"""Segments of a quarter round the corners of buffers: coarse, about a tenth of a millimetre at 12 mm."""
FIELD_STRIPS = 5.0
"""The side of a field, in strips."""
SIGHT_STRIPS = 1.0
"""Parts see each other over no more strips than this."""


@dataclass(frozen=True, eq=False, slots=True)
class Around:
    """What may take metal from around a part: `parts` (k,) near it, the nearest first, whoever is out.

    Those that take some of the part itself are marked in `takes` (k,), and lie `towards` (k, 2) its middle; `stiff` is
    the metal that is wide enough with every part still in, as far as it matters.
    """

    parts: Ints
    takes: Bools
    towards: Floats
    stiff: Any


class Metal:
    """The metal of one place: the sheet, or the hole of a host, with the parts that lie straight in it.

    It is the same for every order; `Uncut` is what is left of it while one is cut.
    """

    def __init__(self, ground: Any, parts: Sequence[int], areas: Sequence[Any], strip_mm: float, web_mm: float) -> None:
        self.ground, self.parts, self.strip_mm = ground, list(parts), strip_mm
        self.areas: Any = np.array(areas, dtype=object)
        self.grown: Any = shapely.buffer(self.areas, web_mm / 2, quad_segs=QUADRANT)
        self.swept: Any = shapely.buffer(self.areas, (web_mm + strip_mm) / 2, quad_segs=QUADRANT)
        self.stiff = shapely.buffer(ground, -strip_mm / 2, quad_segs=QUADRANT)
        self.inner: Any = shapely.point_on_surface(self.areas)
        self.middle: Any = shapely.centroid(self.areas)
        self.tree = shapely.STRtree(self.areas)
        self.size: Any = shapely.area(self.areas)
        self.fields = fields_of(self.grown, FIELD_STRIPS * strip_mm)
        self._around: dict[int, Around] = {}
        shapely.prepare(self.swept)
        shapely.prepare(self.grown)

    @cached_property
    def sights(self) -> Sights:
        """Which parts see each other over metal, as long as certain others are in."""
        return sights_of(self.areas, self.inner, self.grown, self.ground, SIGHT_STRIPS * self.strip_mm)

    def around(self, q: int) -> Around:
        """What may take metal from around part `q`: looked up once."""
        if q not in self._around:
            x0, y0, x1, y1 = shapely.bounds(self.areas[q]).tolist()
            r = self.strip_mm / 2
            window = (x0 - r, y0 - r, x1 + r, y1 + r)  # farther metal holds none of half a strip around the part
            reach = shapely.box(x0 - 3 * r, y0 - 3 * r, x1 + 3 * r, y1 + 3 * r)
            near = self.tree.query(reach)
            near = near[(near != q) & shapely.intersects(self.swept[near], shapely.box(*window))]
            near = near[np.lexsort((near, shapely.distance(self.areas[near], self.areas[q])))]
            lines = shapely.shortest_line(self.middle[q], self.areas[near])
            ends = shapely.get_coordinates(lines).reshape(-1, 2, 2)
            takes = shapely.intersects(self.swept[near], self.areas[q])
            self._around[q] = Around(near, takes, ends[:, 1] - ends[:, 0], shapely.clip_by_rect(self.stiff, *window))
        return self._around[q]


@dataclass(frozen=True, eq=False, slots=True)
class Fields:
    """The parts of a place in squares: what is gone of neighbours is put together once, not for each look.

    `of` (parts,) is the field of each part, by its middle; `boxes` (fields,) has all of their parts, in a `tree`.
    """

    of: Ints
    boxes: Any
    tree: shapely.STRtree


def fields_of(grown: Any, side_mm: float) -> Fields:
    """The fields of parts that are grown already."""
    bounds = shapely.bounds(grown).reshape(-1, 4)
    squares = np.floor((bounds[:, :2] + bounds[:, 2:]) / 2 / side_mm).astype(np.int64)
    names, of = np.unique(squares, axis=0, return_inverse=True)
    of = of.reshape(-1)
    low = np.full((len(names), 2), np.inf)
    high = np.full((len(names), 2), -np.inf)
    np.minimum.at(low, of, bounds[:, :2])
    np.maximum.at(high, of, bounds[:, 2:])
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    return Fields(of, boxes, shapely.STRtree(boxes))


@dataclass(frozen=True, eq=False, slots=True)
class Sights:
    """Straight lines from part to part that are metal all along until some other part is out.

    `of[q]` are pairs (number of a line, part that it leads to); the lines `barred_by[q]` cross what part q takes with
    it, those to the part itself included. `inner` is where the lines of each part begin.
    """

    count: int
    of: list[list[tuple[int, int]]]
    barred_by: list[Ints]
    inner: list[tuple[float, float]]

    def going_on(
        self, parts: Sequence[int], barred: Bools, far_mm: float, known: Set[int] = frozenset()
    ) -> set[int] | None:
        """Parts on the metal of some parts, where lines that are not `barred` show that it is wider than `far_mm`.

        They are those that were seen before that showed. It shows, too, where one of them is `known` to be on such
        metal. None where it does not.
        """
        reached, seen = list(parts), set(parts)
        low_x = low_y = math.inf
        high_x = high_y = -math.inf
        for q in reached:
            x, y = self.inner[q]
            low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
            if q in known or high_x - low_x > far_mm or high_y - low_y > far_mm:
                return seen
            for sight, other in self.of[q]:
                if other not in seen and not barred[sight]:
                    seen.add(other)
                    reached.append(other)
        return None


def sights_of(areas: Any, inner: Any, grown: Any, ground: Any, far_mm: float) -> Sights:
    """Lines between parts that are no farther than `far_mm` from each other."""
    one, other = shapely.STRtree(areas).query(areas, predicate="dwithin", distance=far_mm)
    one, other = one[one < other], other[one < other]
    xy = shapely.get_coordinates(inner)
    lines = shapely.linestrings(np.stack([xy[one], xy[other]], axis=1))
    shapely.prepare(ground)
    held = shapely.contains_properly(ground, lines)
    one, other, lines = one[held], other[held], lines[held]
    of: list[list[tuple[int, int]]] = [[] for _ in areas]
    for k, (a, b) in enumerate(zip(one.tolist(), other.tolist(), strict=True)):
        of[a].append((k, b))
        of[b].append((k, a))
    line, by = shapely.STRtree(grown).query(lines, predicate="intersects")
    order = np.argsort(by, kind="stable")
    barred_by = np.split(line[order], np.searchsorted(by[order], np.arange(1, len(areas))))
    return Sights(len(lines), of, barred_by, [(x, y) for x, y in xy.tolist()])
