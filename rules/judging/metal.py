"""The metal of one place with the parts that lie in it: what strips and islands are looked for in, whatever the order.

It is looked up once: which parts may take metal from around which, and which see each other over metal.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints

from .sights import Sights, sights_of

QUADRANT = 4
"""Segments of a quarter round the corners of buffers: coarse, about a tenth of a millimetre at 12 mm."""
FIELD_STRIPS = 5.0
"""The side of a field, in strips."""
SIGHT_STRIPS = 1.0
"""Parts see each other over no more strips than this."""

ISLAND_STRIPS = 10.0
"""A piece of metal wider than so many strips is a plate of its own, not an island."""
KEPT = 8
"""So many sets of parts out are kept for each part that is in no strip with them."""

Badly = tuple[str, list[int], list[int]]
"""What lies badly once a part is out: "strip" or "island", the parts because of which, and the parts left behind."""
Island = tuple[Ints, Ints]
"""The parts that are on a piece of metal, and those around it."""


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

    It is the same for every order; `Uncut` is what is left of it while one is cut. Strips and islands are looked for
    side by side: `swept` is for strips alone and `grown` for islands, as GEOS bears no two threads at what is prepared.
    `islands` has, for each part, which of those in reach were out when it was cut last, and the islands beside it then.
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
        self.wide = Wide()
        self.islands: dict[int, tuple[bytes, list[Island]]] = {}
        self.reach_mm = ISLAND_STRIPS * strip_mm
        self._around: dict[int, Around] = {}
        shapely.prepare(self.swept)
        shapely.prepare(self.grown)

    @cached_property
    def sights(self) -> Sights:
        """Which parts see each other over metal, as long as certain others are in."""
        return sights_of(self.areas, self.inner, self.grown, self.ground, SIGHT_STRIPS * self.strip_mm)

    @cached_property
    def reach(self) -> tuple[Ints, Ints]:
        """Pairs (pairs,) of a part, and another or itself that lies near enough for an island between them."""
        x0, y0, x1, y1 = shapely.bounds(self.grown).reshape(-1, 4).T
        far = self.reach_mm
        of, near = self.tree.query(shapely.box(x0 - far, y0 - far, x1 + far, y1 + far))
        return np.asarray(of), np.asarray(near)

    @cached_property
    def _reach_begin(self) -> Ints:
        return np.searchsorted(self.reach[0], np.arange(len(self.areas) + 1))

    def in_reach(self, p: int) -> Ints:
        """The parts near enough to part `p` for an island between them, itself among them."""
        return self.reach[1][self._reach_begin[p] : self._reach_begin[p + 1]]

    def around(self, q: int) -> Around:
        """What may take metal from around part `q`."""
        if q not in self._around:
            window = self._windows[q].tolist()  # farther metal holds none of half a strip around the part
            of = slice(*self.near.begin[q : q + 2].tolist())
            stiff = shapely.clip_by_rect(self.stiff, *window)
            self._around[q] = Around(self.near.part[of], self.near.takes[of], self.near.towards[of], stiff)
        return self._around[q]

    @cached_property
    def near(self) -> Near:
        """What may take metal from around every part: looked up for all at once."""
        boxes = shapely.box(*(self._bounds + 1.5 * self.strip_mm * np.array([-1, -1, 1, 1])).T)
        q, near = self.tree.query(boxes)
        q, near = q[q != near], near[q != near]
        meets = shapely.intersects(self.swept[near], shapely.box(*self._windows.T)[q])
        q, near = q[meets], near[meets]
        order = np.lexsort((near, shapely.distance(self.areas[near], self.areas[q]), q))
        q, near = q[order], near[order]
        ends = shapely.get_coordinates(shapely.shortest_line(self.middle[q], self.areas[near])).reshape(-1, 2, 2)
        takes = shapely.intersects(self.swept[near], self.areas[q])
        begin = np.searchsorted(q, np.arange(len(self.areas) + 1))
        return Near(begin, q, near, takes, ends[:, 1] - ends[:, 0])

    @cached_property
    def _bounds(self) -> Floats:
        return np.asarray(shapely.bounds(self.areas)).reshape(-1, 4)

    @cached_property
    def _windows(self) -> Floats:
        """Half a strip around each part."""
        return self._bounds + self.strip_mm / 2 * np.array([-1, -1, 1, 1])


@dataclass(frozen=True, eq=False, slots=True)
class Near:
    """What `Around` has, of all parts: that of part q is from `begin[q]` to `begin[q + 1]`; `of` is q."""

    begin: Ints
    of: Ints
    part: Ints
    takes: Bools
    towards: Floats


class Wide:
    """Parts that are in no strip while certain parts around them are out, as looks at one order have found."""

    def __init__(self) -> None:
        self._known: dict[int, list[int]] = defaultdict(list)

    def known(self, q: int, out: Bools) -> bool:
        """Whether part `q` was seen to be in none with these of the parts around it out, or more."""
        asked = _bits(out)
        return any(asked & ~seen == 0 for seen in self._known.get(q, ()))

    def note(self, q: int, out: Bools) -> None:
        """Part `q` is in none with these of the parts around it out; the last few of such sets are kept."""
        self._known[q] = [*self._known[q][1 - KEPT :], _bits(out)]


def _bits(marked: Bools) -> int:
    return int.from_bytes(np.packbits(marked).tobytes(), "big")


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
