"""Where the parts of a nest lie, and the metal around them: what strips and islands are looked for in."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints, concat_ranges
from kerfwise.encoder.nest import Contour, Nest, cached_with_nest

# It is looked up once: which parts may take metal from around which, and which see each other over metal.

QUADRANT = 4
"""Segments of a quarter round the corners of buffers: coarse, about a tenth of a millimetre at 12 mm."""
FIELD_STRIPS = 5.0
"""The side of a field, in strips."""
SIGHT_STRIPS = 1.0
"""Parts see each other over no more strips than this."""

ISLAND_STRIPS = 10.0
"""A piece of metal wider than so many strips is a plate of its own, not an island."""
IN_STRIP = 0.5
"""A part lies in vanished metal if this share of its area does."""
SURE, SPECK_MM = 0.95, 1e-3
"""What corners of buffers, and rounding, may take of what boxes show, and of a box."""
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
    `islands` has, for each part, the islands that were beside it once it was out, by which of those in reach were out;
    `fewest`, for each that was in a strip, those without any of which it would not be, by which of those around were.
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
        self.islands: dict[int, dict[bytes, list[Island]]] = defaultdict(dict)
        self.fewest: dict[int, dict[bytes, list[int]]] = defaultdict(dict)
        self.reach_mm = ISLAND_STRIPS * strip_mm
        self._around: dict[int, Around] = {}
        shapely.prepare(self.swept)
        shapely.prepare(self.grown)
        shapely.prepare(self.stiff)

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
            self.look_around(np.array([q]))
        return self._around[q]

    def look_around(self, parts: Ints) -> None:
        """Look up what may take metal from around these parts, for all at once; what is known is not asked again."""
        parts = np.array([q for q in parts.tolist() if q not in self._around], dtype=np.int64)
        pairs, begin = self.pairs, self.pairs.begin
        q = np.repeat(parts, begin[parts + 1] - begin[parts])
        near = pairs.part[concat_ranges(begin[parts], begin[parts + 1] - begin[parts])]
        order = np.lexsort((near, shapely.distance(self.areas[near], self.areas[q]), q))
        q, near = q[order], near[order]
        ends = shapely.get_coordinates(shapely.shortest_line(self.middle[q], self.areas[near])).reshape(-1, 2, 2)
        takes, towards = shapely.intersects(self.swept[near], self.areas[q]), ends[:, 1] - ends[:, 0]
        for part in parts.tolist():
            of = slice(*np.searchsorted(q, [part, part + 1]).tolist())
            window = self._windows[part].tolist()  # farther metal holds none of half a strip around the part
            self._around[part] = Around(near[of], takes[of], towards[of], shapely.clip_by_rect(self.stiff, *window))

    @cached_property
    def pairs(self) -> Pairs:
        """What may take metal from around every part, and how the boxes of both lie."""
        boxes = shapely.box(*(self._bounds + 1.5 * self.strip_mm * np.array([-1, -1, 1, 1])).T)
        q, near = self.tree.query(boxes)
        q, near = q[q != near], near[q != near]
        meets = shapely.intersects(self.swept[near], shapely.box(*self._windows.T)[q])
        q, near = q[meets], near[meets]
        order = np.lexsort((near, q))
        q, near = q[order], near[order]
        window, taken = self._windows[q], shapely.bounds(self.swept)[near]
        beyond, far = taken[:, [2, 3, 0, 1]], window[:, [2, 3, 0, 1]]
        side = ((far - beyond) / (far - window)).argmax(axis=1)
        return Pairs(np.searchsorted(q, np.arange(len(self.areas) + 1)), q, near, side, beyond[np.arange(len(q)), side])

    def surely_wide(self, out: Bools) -> Bools:
        """Parts that are in no strip with the second of these pairs (pairs,) out, as boxes show.

        Of half a strip around each, what is taken by those that are out lies beside a box; that box is stiff, and wide
        with half a strip around it.
        """
        first, last = self._stiff_boxes[:, :2].copy(), self._stiff_boxes[:, 2:].copy()
        for axis in (0, 1):
            low, high = (np.flatnonzero(out & (self.pairs.side == side)) for side in (axis, axis + 2))
            np.maximum.at(first[:, axis], self.pairs.of[low], self.pairs.beyond[low])
            np.minimum.at(last[:, axis], self.pairs.of[high], self.pairs.beyond[high])
        part, corner_mm = self._bounds, SURE * self.strip_mm / 2 * math.sqrt(0.5)
        held = np.minimum(last + corner_mm, part[:, 2:]) - np.maximum(first - corner_mm, part[:, :2])
        lost = (part[:, 2:] - part[:, :2]).prod(axis=1) - np.maximum(held, 0.0).prod(axis=1)
        wide = (last - first > SPECK_MM).all(axis=1) & (lost < SURE * IN_STRIP * self.size)
        wide[wide] = shapely.covers(self.stiff, shapely.box(*first[wide].T, *last[wide].T))
        return np.asarray(wide)

    @cached_property
    def _stiff_boxes(self) -> Floats:
        """Of half a strip around each part, what the metal with every part in may be stiff in."""
        stiff = shapely.bounds(self.stiff)
        return np.hstack([np.fmax(self._windows[:, :2], stiff[:2]), np.fmin(self._windows[:, 2:], stiff[2:])])

    def nearest(self, p: int, parts: Ints) -> int:
        """Of some parts the one that lies nearest to part `p`, the first of those that lie equally near."""
        own, boxes = self._bounds[p], self._bounds[parts]
        apart = np.maximum(np.maximum(boxes[:, :2] - own[2:], own[:2] - boxes[:, 2:]), 0.0)
        least_mm = np.hypot(*apart.T)
        most_mm = shapely.distance(self.areas[parts[least_mm.argmin()]], self.areas[p])
        some = np.sort(parts[least_mm <= most_mm + SPECK_MM])
        return int(some[shapely.distance(self.areas[some], self.areas[p]).argmin()])

    @cached_property
    def _bounds(self) -> Floats:
        return np.asarray(shapely.bounds(self.areas)).reshape(-1, 4)

    @cached_property
    def _windows(self) -> Floats:
        """Half a strip around each part."""
        return self._bounds + self.strip_mm / 2 * np.array([-1, -1, 1, 1])


@dataclass(frozen=True, eq=False, slots=True)
class Pairs:
    """Parts (pairs,), and one `part` of each that may take metal from around it: those of q from `begin[q]` on.

    Most is left of the metal around it from where that one ends `beyond` it, mm: on `side` 0 and 1 at greater x and y,
    on 2 and 3 at less.
    """

    begin: Ints
    of: Ints
    part: Ints
    side: Ints
    beyond: Floats


class Wide:
    """Parts that are in no strip while certain parts around them are out, as looks at one order have found."""

    def __init__(self) -> None:
        self._known: dict[int, list[int]] = defaultdict(list)

    def known(self, q: int, out: Bools) -> bool:
        """Whether part `q` was seen to be in none with these of the parts around it out, or more."""
        bits = _bits(out)
        return any(bits & ~seen == 0 for seen in self._known.get(q, ()))

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


# Straight lines from part to part over metal: they show that metal goes on, without its pieces being looked for.


@dataclass(frozen=True, eq=False, slots=True)
class Sights:
    """Straight lines from part to part that are metal all along until some other part is out.

    `ends` (lines, 2) are the parts that a line leads from and to; `of[q]` are pairs (number of a line, part that it
    leads to). What part `bars[k, 1]` takes with it crosses line `bars[k, 0]`, as it does that of each line to the part
    itself; the lines `barred_by[q]` are those of part q. `inner` (parts, 2) is where the lines of each part begin.
    """

    ends: Ints
    of: list[list[tuple[int, int]]]
    bars: Ints
    barred_by: list[Ints]
    inner: Floats

    @property
    def count(self) -> int:
        """How many lines there are."""
        return len(self.ends)

    def goes_on(self, parts: Sequence[int], barred: Bools, far_mm: float) -> bool:
        """Whether lines that are not `barred` show that the metal of some parts is wider than `far_mm`."""
        reached, seen = list(parts), set(parts)
        low_x = low_y = math.inf
        high_x = high_y = -math.inf
        for q in reached:
            x, y = self.inner[q].tolist()
            low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
            if high_x - low_x > far_mm or high_y - low_y > far_mm:
                return True
            for sight, other in self.of[q]:
                if other not in seen and not barred[sight]:
                    seen.add(other)
                    reached.append(other)
        return False

    def goes_on_until(self, at: Ints, far_mm: float) -> Ints:
        """For each part the cut from which on lines no longer show that its metal is wider than `far_mm`, 0 for never.

        `at` is the cut that takes each part out. What lines join is put together from the last cut to the first.
        """
        barred_at = np.full(self.count, at.max(initial=0) + 1)
        np.minimum.at(barred_at, self.bars[:, 0], at[self.bars[:, 1]])
        last_first = np.argsort(-barred_at, kind="stable")
        until = [0] * len(at)
        group = list(range(len(at)))
        members = [[q] for q in group]
        boxes = [(x, y, x, y) for x, y in self.inner.tolist()]
        large = [False] * len(at)
        rows = zip(self.ends[last_first].tolist(), barred_at[last_first].tolist(), strict=True)
        for (a, b), cut in rows:
            one, other = group[a], group[b]
            if one == other:
                continue
            if len(members[one]) < len(members[other]):
                one, other = other, one
            (x0, y0, x1, y1), (u0, v0, u1, v1) = boxes[one], boxes[other]
            boxes[one] = x0, y0, x1, y1 = min(x0, u0), min(y0, v0), max(x1, u1), max(y1, v1)
            new: list[int] = []
            if large[one] or large[other] or x1 - x0 > far_mm or y1 - y0 > far_mm:
                new = [q for k in (one, other) if not large[k] for q in members[k]]
                large[one] = True
            for q in new:
                until[q] = cut
            for q in members[other]:
                group[q] = one
            members[one] += members[other]
        return np.array(until, dtype=np.int64)


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
    return Sights(np.column_stack([one, other]), of, np.column_stack([line, by]), barred_by, xy)


# Where the parts of a nest lie, as the judging of rules sees it.
#
# Plain shapely on purpose, and nothing from the facts that models are built on: a wrong fact must not hide here too.


@cached_with_nest(most=2)
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
