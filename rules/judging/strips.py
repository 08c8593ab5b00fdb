"""Narrow strips and islands of uncut metal, by plain geometry, while a sheet is cut: the whole of no-narrow-strips.

Everything is looked at near the part just cut out: whether a part lies in a strip depends on nothing farther than the
strip is wide, and an island is a piece of metal that is closed within a few strips.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest

from .placement import host_holes, places

ISLAND_STRIPS = 10.0
"""A piece of metal wider than so many strips is a plate of its own, not an island."""
QUADRANT = 4
"""Segments of a quarter round the corners of buffers: coarse, about a tenth of a millimetre at 12 mm."""
IN_STRIP = 0.5
"""A part lies in vanished metal if this share of its area does."""
SPECK_MM2 = 1.0


@dataclass(frozen=True, slots=True)
class Cutting:
    """After cut `k` (counted from 1 in the order given) the parts `left` lie badly, because the parts `out` are out.

    `kind` "strip": `left` is one part, in metal narrower than a strip between parts that are out. "island": `left` are
    a part on a piece of metal closed off by parts that are out, and one elsewhere.
    """

    k: int
    kind: str
    out: tuple[int, ...]
    left: tuple[int, ...]


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
    """The uncut metal of one place: the sheet, or the hole of a host, with the parts that lie straight in it."""

    def __init__(self, ground: Any, parts: Sequence[int], areas: Sequence[Any], strip_mm: float, web_mm: float) -> None:
        self.ground, self.parts, self.strip_mm = ground, list(parts), strip_mm
        self.areas: Any = np.array(areas, dtype=object)
        self.grown: Any = shapely.buffer(self.areas, web_mm / 2, quad_segs=QUADRANT)
        self.swept: Any = shapely.buffer(self.areas, (web_mm + strip_mm) / 2, quad_segs=QUADRANT)
        self.stiff = shapely.buffer(ground, -strip_mm / 2, quad_segs=QUADRANT)
        self.inner: Any = shapely.point_on_surface(self.areas)
        self.tree = shapely.STRtree(self.areas)
        self.size: Any = shapely.area(self.areas)
        self.around: dict[int, Around] = {}
        self.core: dict[int, Any] = {}
        self.out = np.zeros(len(self.parts), dtype=bool)
        self.told = np.zeros(len(self.parts), dtype=bool)
        shapely.prepare(self.swept)

    def cut(self, p: int) -> Iterator[tuple[str, list[int], list[int]]]:
        """Take part `p` out; what lies badly then, as (kind, out, left) in numbers of this place.

        The first of `left` lies badly. A part that was told is not told again, and not looked at for strips again.
        """
        self.out[p] = True
        for look in (self._strips, self._islands):
            for kind, out, left in look(p):
                if not self.told[left[0]]:
                    self.told[left[0]] = True
                    yield kind, out, left

    def _strips(self, p: int) -> Iterator[tuple[str, list[int], list[int]]]:
        """Looks at every part whose metal, as far as it matters, part `p` takes some of."""
        x0, y0, x1, y1 = self.swept[p].bounds
        r = self.strip_mm / 2
        near = self.tree.query(shapely.box(x0 - r, y0 - r, x1 + r, y1 + r))
        for q in sorted(near[~self.out[near] & ~self.told[near]].tolist()):
            around = self._around(q)
            if p in around.parts:
                self.core[q] = shapely.difference(self.core.get(q, around.stiff), self.swept[p])
                out = np.flatnonzero(self.out[around.parts])
                if self._on_both_sides(around, out) and self._vanished(q, self.core[q]):
                    yield "strip", self._fewest(q, around, out), [q]

    def _around(self, q: int) -> Around:
        """What may take metal from around part `q`: the same for every order, so that it is looked up once."""
        if q not in self.around:
            x0, y0, x1, y1 = self.areas[q].bounds
            r = self.strip_mm / 2
            window = (x0 - r, y0 - r, x1 + r, y1 + r)  # farther metal holds none of half a strip around the part
            reach = shapely.box(*shapely.bounds(shapely.buffer(shapely.box(x0, y0, x1, y1), 3 * r)))
            near = self.tree.query(reach)
            near = near[(near != q) & shapely.intersects(self.swept[near], shapely.box(*window))]
            near = near[np.lexsort((near, shapely.distance(self.areas[near], self.areas[q])))]
            lines = shapely.shortest_line(shapely.centroid(self.areas[q]), self.areas[near])
            ends = shapely.get_coordinates(lines).reshape(-1, 2, 2)
            takes = shapely.intersects(self.swept[near], self.areas[q])
            self.around[q] = Around(near, takes, ends[:, 1] - ends[:, 0], shapely.clip_by_rect(self.stiff, *window))
        return self.around[q]

    @staticmethod
    def _on_both_sides(around: Around, out: Ints) -> bool:
        """Whether parts that take metal from the part lie in directions more than a right angle apart."""
        towards = around.towards[out[around.takes[out]]]
        return bool((towards @ towards.T < 0).any())

    def _vanished(self, q: int, core: Any) -> bool:
        """Whether most of part `q` lies in metal that opening by half a strip leaves nothing of; `core` is that metal
        less what parts that are out take of it, each grown by half a strip and half a web.
        """
        opened = shapely.buffer(core, self.strip_mm / 2, quad_segs=QUADRANT)
        return bool(shapely.area(shapely.difference(self.areas[q], opened)) > IN_STRIP * self.size[q])

    def _would_vanish(self, q: int, around: Around, out: Ints) -> bool:
        """Whether it would, were only these parts out."""
        core = around.stiff
        for k in around.parts[out]:  # the nearest take most, often all there is
            if core.is_empty:
                return True
            core = shapely.difference(core, self.swept[k])
        return self._vanished(q, core)

    def _fewest(self, q: int, around: Around, out: Ints) -> list[int]:
        """The parts without any of which part `q` would not be in a strip, tried from the farthest.

        More parts out never widen a strip, so that many are left out at once where the rest still makes one.
        """
        needed: list[int] = []
        stretches = [(0, len(out))]
        while stretches:
            begin, end = stretches.pop()
            without = np.concatenate([out[:begin], np.array(needed[::-1], dtype=np.int64)])
            if self._on_both_sides(around, without) and self._would_vanish(q, around, without):
                continue
            if end - begin == 1:
                needed.append(int(out[begin]))
            else:
                middle = (begin + end) // 2
                stretches += [(begin, middle), (middle, end)]
        return sorted(around.parts[needed].tolist())

    def _islands(self, p: int) -> Iterator[tuple[str, list[int], list[int]]]:
        """Pieces that taking out `p` closes off from the rest, with a part on it and one elsewhere.

        The first of the two is on the side with fewer parts: that is the one left behind.
        """
        x0, y0, x1, y1 = self.grown[p].bounds
        reach = ISLAND_STRIPS * self.strip_mm
        window = (x0 - reach, y0 - reach, x1 + reach, y1 + reach)
        near = self.tree.query(shapely.box(*window))
        gone, left = near[self.out[near]], near[~self.out[near]]
        touching = gone[shapely.intersects(self.grown[gone], self.grown[p])]
        if len(left) == 0 or not self._divides(p, [int(k) for k in touching if k != p]):
            return
        metal = shapely.difference(shapely.clip_by_rect(self.ground, *window), shapely.union_all(self.grown[gone]))
        pieces = [piece for piece in shapely.get_parts(metal) if piece.area > SPECK_MM2]
        for piece in pieces:
            px0, py0, px1, py1 = piece.bounds
            if max(px1 - px0, py1 - py0) > reach or not shapely.dwithin(piece, self.grown[p], 1e-6):
                continue
            on_it = left[shapely.intersects(piece, self.inner[left])]
            if len(on_it) and (elsewhere := np.setdiff1d(np.flatnonzero(~self.out), on_it)).size:
                border = gone[shapely.dwithin(self.grown[gone], piece, 1e-6)]
                fewer, more = sorted((on_it, elsewhere), key=len)
                other = min(more.tolist(), key=lambda k: (self.areas[k].distance(self.areas[p]), k))
                yield "island", sorted(border.tolist()), [int(fewer.min()), other]

    def _divides(self, p: int, touching: Sequence[int]) -> bool:
        """Whether the metal around part `p` is in more than one piece, so that taking it out may divide the rest."""
        rim = shapely.intersection(self.grown[p].exterior, self.ground)
        free = shapely.line_merge(shapely.difference(rim, shapely.union_all(self.grown[list(touching)])))
        arcs = [arc for arc in shapely.get_parts(free) if arc.length > 0]
        ends = sum(not arc.is_closed for arc in arcs)
        return ends > 1


@kept_with_nest(most=4)
def strips_and_islands(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    """What lies badly after each cut of an order of contour ids, told once a part; numbers are those of parts.

    Kept for the last few orders: the plan that is found is looked at again as a plan, and as a program.
    """
    return tuple(_badly(nest, order, strip_mm, web_mm))


def _badly(nest: Nest, order: Sequence[str], strip_mm: float, web_mm: float) -> Iterator[Cutting]:
    number = {part.outer.id: k for k, part in enumerate(nest.parts)}
    grounds, where = _grounds(nest, strip_mm, web_mm)
    in_place = {part: p for ground in grounds.values() for p, part in enumerate(ground.parts)}
    for k, contour in enumerate(order, 1):
        if contour not in number:
            continue
        ground = grounds[where[number[contour]]]
        for kind, out, left in ground.cut(in_place[number[contour]]):
            yield Cutting(k, kind, tuple(ground.parts[m] for m in out), tuple(ground.parts[m] for m in left))


def _grounds(nest: Nest, strip_mm: float, web_mm: float) -> tuple[dict[str, Metal], list[str]]:
    """The metal of each place by the id of its hole ("" for the sheet), and the place of each part."""
    hosts = host_holes(nest)
    at = places(nest, hosts)
    where = [at[part.id] for part in nest.parts]
    holes = {hole.id: hole.polygon for hole in hosts.values()}
    grounds = {}
    for place in sorted(set(where)):
        own = [k for k, of in enumerate(where) if of == place]
        ground = shapely.make_valid(holes[place] if place else nest.sheet.polygon)
        areas = [shapely.make_valid(nest.parts[k].outer.polygon) for k in own]
        grounds[place] = Metal(ground, own, areas, strip_mm, web_mm)
    return grounds, where
