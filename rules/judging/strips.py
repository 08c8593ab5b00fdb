"""Narrow strips and islands of uncut metal, by plain geometry, while a sheet is cut: the whole of no-narrow-strips.

Everything is looked at near the part just cut out: whether a part lies in a strip depends on nothing farther than the
strip is wide, and an island is a piece of metal that is closed within a few strips.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest

from .metal import QUADRANT, Around, Metal
from .placement import host_holes, places

ISLAND_STRIPS = 10.0
"""A piece of metal wider than so many strips is a plate of its own, not an island."""
IN_STRIP = 0.5
"""A part lies in vanished metal if this share of its area does."""
SPECK_MM2 = 1.0
CLOSE_STRIPS = (2.0, 5.0)
"""How far around a part close looks for islands go, in strips, before all is looked at that an island may be on."""


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


class Uncut:
    """What is left of the metal of one place while its parts are cut."""

    def __init__(self, metal: Metal) -> None:
        self.metal = metal
        self.out = np.zeros(len(metal.parts), dtype=bool)
        self.told = np.zeros(len(metal.parts), dtype=bool)
        self.core: dict[int, Any] = {}
        self.barred = np.zeros(metal.sights.count, dtype=bool)
        self.gone: Any = np.full(len(metal.fields.boxes), shapely.Polygon(), dtype=object)

    def cut(self, p: int) -> Iterator[tuple[str, list[int], list[int]]]:
        """Take part `p` out; what lies badly then, as (kind, out, left) in numbers of this place.

        The first of `left` lies badly. A part that was told is not told again, and not looked at for strips again.
        """
        self.out[p] = True
        self.barred[self.metal.sights.barred_by[p]] = True
        field = self.metal.fields.of[p]
        self.gone[field] = shapely.union(self.gone[field], self.metal.grown[p])
        for look in (self._strips, self._islands):
            for kind, out, left in look(p):
                if not self.told[left[0]]:
                    self.told[left[0]] = True
                    yield kind, out, left

    def _strips(self, p: int) -> Iterator[tuple[str, list[int], list[int]]]:
        """Looks at every part whose metal, as far as it matters, part `p` takes some of."""
        metal = self.metal
        x0, y0, x1, y1 = shapely.bounds(metal.swept[p]).tolist()
        r = metal.strip_mm / 2
        near = metal.tree.query(shapely.box(x0 - r, y0 - r, x1 + r, y1 + r))
        near = np.sort(near[~self.out[near] & ~self.told[near]])
        around = {q: of for q in near.tolist() if p in (of := metal.around(q)).parts}
        cores = np.array([self.core.get(q, of.stiff) for q, of in around.items()], dtype=object)
        self.core.update(zip(around, shapely.difference(cores, metal.swept[p]), strict=True))
        out = {q: np.flatnonzero(self.out[of.parts]) for q, of in around.items()}
        asked = [q for q, of in around.items() if self._on_both_sides(of, out[q])]
        if asked:
            cores = np.array([self.core[q] for q in asked], dtype=object)
            for q in np.array(asked)[self._vanished(np.array(asked), cores)].tolist():
                yield "strip", self._fewest(q, around[q], out[q]), [q]

    @staticmethod
    def _on_both_sides(around: Around, out: Ints) -> bool:
        """Whether parts that take metal from the part lie in directions more than a right angle apart."""
        towards = around.towards[out[around.takes[out]]]
        return bool((towards @ towards.T < 0).any())

    def _vanished(self, parts: Ints, cores: Any) -> Bools:
        """Whether most of each part lies in metal that opening by half a strip leaves nothing of.

        `cores` is that metal less what parts that are out take of it, each grown by half a strip and half a web.
        """
        areas = self.metal.areas[parts]
        opened = shapely.buffer(cores, self.metal.strip_mm / 2, quad_segs=QUADRANT)
        return np.asarray(shapely.area(shapely.difference(areas, opened)) > IN_STRIP * self.metal.size[parts])

    def _would_vanish(self, q: int, around: Around, out: Ints) -> bool:
        """Whether part `q` would lie in vanished metal, were only these parts out."""
        core = around.stiff
        for k in around.parts[out]:  # the nearest take most, often all there is
            if core.is_empty:
                return True
            core = shapely.difference(core, self.metal.swept[k])
        return bool(self._vanished(np.array([q]), np.array([core], dtype=object))[0])

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
        metal = self.metal
        reach = ISLAND_STRIPS * metal.strip_mm
        window = _wider(metal.grown[p], reach)
        near = metal.tree.query(shapely.box(*window))
        gone, left = near[self.out[near]], near[~self.out[near]]
        if self._all_go_on(left.tolist()):
            return
        touching = gone[shapely.intersects(metal.grown[gone], metal.grown[p])]
        if len(left) == 0 or not self._divides(p, [int(k) for k in touching if k != p]):
            return
        pieces = self._closed_off(p, window, left)
        px0, py0, px1, py1 = shapely.bounds(pieces).reshape(-1, 4).T
        close = np.maximum(px1 - px0, py1 - py0) <= reach
        for piece in pieces[close]:
            if shapely.area(piece) <= SPECK_MM2 or not shapely.dwithin(metal.grown[p], piece, 1e-6):
                continue
            on_it = left[shapely.intersects(piece, metal.inner[left])]
            if len(on_it) and (elsewhere := np.setdiff1d(np.flatnonzero(~self.out), on_it)).size:
                border = gone[shapely.dwithin(metal.grown[gone], piece, 1e-6)]
                fewer, more = sorted((on_it, elsewhere), key=len)
                away_mm = shapely.distance(metal.areas[more], metal.areas[p])
                other = int(more[np.lexsort((more, away_mm))[0]])
                yield "island", sorted(border.tolist()), [int(fewer.min()), other]

    def _closed_off(self, p: int, window: Box, left: Ints) -> Any:
        """Pieces of the metal in a window: all that may be islands beside part `p`.

        A close look does where each piece by the part ends within it, or is seen to be too large for an island.
        """
        grown, inner = self.metal.grown[p], self.metal.inner[left]
        for strips in CLOSE_STRIPS:
            near = _wider(grown, strips * self.metal.strip_mm)
            pieces = self._pieces(near)
            pieces = pieces[shapely.dwithin(grown, pieces, 1e-6)]
            px0, py0, px1, py1 = shapely.bounds(pieces).reshape(-1, 4).T
            ends = (px0 > near[0]) & (py0 > near[1]) & (px1 < near[2]) & (py1 < near[3])
            islands = [piece for piece in pieces[ends] if shapely.intersects(piece, inner).any()]
            if len(islands) < 2 and all(self._large(piece, left) for piece in pieces[~ends]):
                return np.array(islands, dtype=object)
        return self._pieces(window)

    def _large(self, piece: Any, left: Ints) -> bool:
        """Whether parts that are still in show that a piece of metal goes on farther than islands do."""
        on_it = left[shapely.intersects(piece, self.metal.inner[left])].tolist()
        return self.metal.sights.going_on(on_it, self.barred, self._island_mm) is not None

    def _all_go_on(self, left: Sequence[int]) -> bool:
        """Whether the metal of every part still in is seen to go on farther than islands do."""
        large: set[int] = set()
        for q in left:
            if q not in large:
                seen = self.metal.sights.going_on([q], self.barred, self._island_mm, large)
                if seen is None:
                    return False
                large |= seen
        return True

    @property
    def _island_mm(self) -> float:
        """Wider than this is no island."""
        return ISLAND_STRIPS * self.metal.strip_mm + 1e-6

    def _pieces(self, window: Box) -> Any:
        """The pieces of metal that is left in a window."""
        gone = self.gone[self.metal.fields.tree.query(shapely.box(*window))]
        gone = shapely.union_all(shapely.clip_by_rect(gone, *window))
        return shapely.get_parts(shapely.difference(shapely.clip_by_rect(self.metal.ground, *window), gone))

    def _divides(self, p: int, touching: Sequence[int]) -> bool:
        """Whether the metal around part `p` is in more than one piece, so that taking it out may divide the rest."""
        grown = self.metal.grown
        rim = shapely.intersection(grown[p].exterior, self.metal.ground)
        free = shapely.line_merge(shapely.difference(rim, shapely.union_all(grown[list(touching)])))
        arcs = [arc for arc in shapely.get_parts(free) if arc.length > 0]
        ends = sum(not arc.is_closed for arc in arcs)
        return ends > 1


def _wider(area: Any, by_mm: float) -> Box:
    x0, y0, x1, y1 = shapely.bounds(area).tolist()
    return x0 - by_mm, y0 - by_mm, x1 + by_mm, y1 + by_mm


def strips_and_islands(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    """What lies badly after each cut of an order of contour ids, told once a part; numbers are those of parts.

    Kept for the last few orders, with the nest as drawn: the plan that is found is looked at again as a plan, and as a
    program.
    """
    return _told(_as_drawn(nest), order, strip_mm, web_mm)


def _as_drawn(nest: Nest) -> Nest:
    """The nest as drawn, where its parts have the same outlines on the same sheet, and lie in the same holes."""
    drawn = nest.drawn
    if drawn is None or drawn.sheet is not nest.sheet or len(drawn.parts) != len(nest.parts):
        return nest
    same = all(
        one.id == other.id and one.outer.curve is other.outer.curve
        for one, other in zip(nest.parts, drawn.parts, strict=True)
    )
    return drawn if same and places(drawn, host_holes(drawn)) == places(nest, host_holes(nest)) else nest


@kept_with_nest(most=4)
def _told(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    return tuple(_badly(nest, order, strip_mm, web_mm))


def _badly(nest: Nest, order: Sequence[str], strip_mm: float, web_mm: float) -> Iterator[Cutting]:
    number = {part.outer.id: k for k, part in enumerate(nest.parts)}
    grounds, where = _grounds(nest, strip_mm, web_mm)
    in_place = {part: p for ground in grounds.values() for p, part in enumerate(ground.parts)}
    uncut = {place: Uncut(ground) for place, ground in grounds.items()}
    for k, contour in enumerate(order, 1):
        if contour not in number:
            continue
        ground = uncut[where[number[contour]]]
        parts = ground.metal.parts
        for kind, out, left in ground.cut(in_place[number[contour]]):
            yield Cutting(k, kind, tuple(parts[m] for m in out), tuple(parts[m] for m in left))


@kept_with_nest(most=2)
def _grounds(nest: Nest, strip_mm: float, web_mm: float) -> tuple[dict[str, Metal], list[str]]:
    """The metal of each place by the id of its hole ("" for the sheet), and the place of each part."""
    hosts = host_holes(nest)
    at = places(nest, hosts)
    where = [at[part.id] for part in nest.parts]
    holes = {hole.id: hole.polygon for hole in hosts.values()}
    grounds = {}
    lying: dict[str, list[int]] = defaultdict(list)
    for k, of in enumerate(where):
        lying[of].append(k)
    for place, own in sorted(lying.items()):
        ground = shapely.make_valid(holes[place] if place else nest.sheet.polygon)
        areas = shapely.make_valid(np.array([nest.parts[k].outer.polygon for k in own], dtype=object))
        grounds[place] = Metal(ground, own, areas, strip_mm, web_mm)
    return grounds, where
