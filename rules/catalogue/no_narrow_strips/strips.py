"""Narrow strips and islands of uncut metal, by plain geometry, while a sheet is cut: the whole of no-narrow-strips.

Everything is looked at near the part just cut out: `strips` and `islands` say how far.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from typing import Any, TypeVar

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints, in_parallel
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Nest, cached_with_nest
from kerfwise.rules.judging.metal import IN_STRIP, QUADRANT, Around, Badly, Island, Metal, host_holes, places

# Islands: pieces of metal with parts on them that parts that are out close off from the rest.
#
# An island is closed within a few strips: everything is looked at near the part just cut out.

Found = TypeVar("Found")

SPECK_MM2 = 1.0
CLOSE_STRIPS = (2.0, 5.0)
"""How far around a part close looks for islands go, in strips, before all is looked at that an island may be on."""
KEPT_OF_A_PART = 32
"""Answers that are kept of one part: orders that are looked at differ by a contour or two, and come back."""


def _kept(known: dict[bytes, list[Found]], out: Bools | Ints, look: Callable[[], list[Found]]) -> list[Found]:
    """What is known of a part where these others are out; looked for, and kept, where it is not."""
    if (asked := out.tobytes()) not in known:
        if len(known) == KEPT_OF_A_PART:
            known.clear()
        known[asked] = look()
    return known[asked]


class Islands:
    """The islands that form in the metal of one place while its parts are cut, each when `at` (parts,) says."""

    def __init__(self, metal: Metal, at: Ints) -> None:
        self.metal, self.at = metal, at
        self.out = np.zeros(len(metal.parts), dtype=bool)
        self.barred = np.zeros(metal.sights.count, dtype=bool)
        self.gone: Any = np.full(len(metal.fields.boxes), shapely.Polygon(), dtype=object)
        self._not_gone: list[list[int]] = [[] for _ in metal.fields.boxes]
        self._seen_to_go_on = self._where_all_go_on()

    def take_out(self, p: int) -> Iterator[Badly]:
        """Take part `p` out; pieces that this closes off from the rest: see `Badly`.

        The first two that are left are a part on such a piece and one elsewhere; the first is on the side with fewer
        parts: that is the one left behind.
        """
        metal = self.metal
        self.out[p] = True
        self.barred[metal.sights.barred_by[p]] = True
        self._not_gone[metal.fields.of[p]].append(p)
        if self._all_go_on(p):
            return
        for on_it, border in self._closed_by(p):
            if (elsewhere := np.setdiff1d(np.flatnonzero(~self.out), on_it)).size:
                fewer, more = sorted((on_it, elsewhere), key=len)
                yield "island", sorted(border.tolist()), [int(fewer.min()), metal.nearest(p, more)]

    def _closed_by(self, p: int) -> list[Island]:
        """The islands beside part `p` now that it is out.

        They depend on nothing but which parts in reach are out, so the answers for orders before are kept.
        """
        near = self.metal.in_reach(p)
        out = self.out[near]
        return _kept(self.metal.islands[p], out, lambda: list(self._looked_for(p, near[out], near[~out])))

    def _looked_for(self, p: int, gone: Ints, left: Ints) -> Iterator[Island]:
        """The islands beside part `p`, where these parts in reach are out, and these are left."""
        grown, reach_mm = self.metal.grown, self.metal.reach_mm
        touching = gone[shapely.intersects(grown[gone], grown[p])]
        if len(left) == 0 or not self._divides(p, [int(k) for k in touching if k != p]):
            return
        pieces = self._closed_off(p, _wider(grown[p], reach_mm), left)
        px0, py0, px1, py1 = shapely.bounds(pieces).reshape(-1, 4).T
        close = np.maximum(px1 - px0, py1 - py0) <= reach_mm
        for piece in pieces[close]:
            if shapely.area(piece) <= SPECK_MM2 or not shapely.dwithin(grown[p], piece, 1e-6):
                continue
            on_it = left[shapely.intersects(piece, self.metal.inner[left])]
            if len(on_it):
                yield on_it, gone[shapely.dwithin(grown[gone], piece, 1e-6)]

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
        return self.metal.sights.goes_on(on_it, self.barred, self._island_mm)

    def _all_go_on(self, p: int) -> bool:
        """Whether the metal of every part still in around part `p` is seen to go on farther than islands do."""
        return bool(self._seen_to_go_on[p])

    def _where_all_go_on(self) -> Bools:
        """See `_all_go_on`, of every part once it is out."""
        p, near = self.metal.reach
        until = self.metal.sights.goes_on_until(self.at, self._island_mm)
        ends = (self.at[near] > self.at[p]) & (until[near] <= self.at[p])
        seen = np.ones(len(self.out), dtype=bool)
        seen[p[ends]] = False
        return seen

    @property
    def _island_mm(self) -> float:
        """Wider than this is no island."""
        return self.metal.reach_mm + 1e-6

    def _pieces(self, window: Box) -> Any:
        """The pieces of metal that is left in a window."""
        fields = self.metal.fields.tree.query(shapely.box(*window))
        for field in fields.tolist():
            for p in self._not_gone[field]:
                self.gone[field] = shapely.union(self.gone[field], self.metal.grown[p])
            self._not_gone[field].clear()
        gone = shapely.union_all(shapely.clip_by_rect(self.gone[fields], *window))
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


# Strips: parts that lie in metal narrower than a strip between parts that are out.
#
# Whether a part lies in one depends on nothing farther than the strip is wide.


class Strips:
    """The strips that form in the metal of one place while its parts are cut, each when `at` (parts,) says."""

    def __init__(self, metal: Metal, at: Ints) -> None:
        self.metal, self.at = metal, at
        self._in_strips = self._strips_begin()

    def take_out(self, p: int) -> Iterator[Badly]:
        """The parts that are in a strip once part `p` is out: see `Badly`."""
        for q in self._in_strips.get(p, ()):
            around = self.metal.around(q)
            out = np.flatnonzero(self.at[around.parts] <= self.at[p])
            yield "strip", list(_kept(self.metal.fewest[q], out, partial(self._fewest, q, around, out))), [q]

    def _strips_begin(self) -> dict[int, list[int]]:
        """Part → the parts that are in a strip from when it is out.

        More parts out never widen a strip: what is in none just before it is cut itself was in none before.
        """
        metal, pairs = self.metal, self.metal.pairs
        before = self.at[pairs.part] < self.at[pairs.of]
        some = np.flatnonzero((np.bincount(pairs.of[before], minlength=len(self.at)) > 1) & ~metal.surely_wide(before))
        metal.look_around(some)
        out = {q: self.at[metal.around(q).parts] < self.at[q] for q in some.tolist()}
        both_sides = [q for q, gone in out.items() if self._on_both_sides(metal.around(q), np.flatnonzero(gone))]
        both_sides = [q for q in both_sides if not metal.wide.known(q, out[q])]
        found: dict[int, list[int]] = defaultdict(list)
        in_turn = {}
        for q in both_sides:
            parts = metal.around(q).parts[out[q]]
            in_turn[q] = parts[np.argsort(self.at[parts])]
        cores = np.array([metal.around(q).stiff for q in both_sides], dtype=object)
        for k in range(max(map(len, in_turn.values()), default=0)):
            some = np.array([m for m, q in enumerate(both_sides) if k < len(in_turn[q])])
            less = metal.swept[[in_turn[both_sides[m]][k] for m in some.tolist()]]
            cores[some] = shapely.difference(cores[some], less)
        vanished = self._vanished(np.array(both_sides, dtype=np.int64), cores) if both_sides else ()
        for q, lies_in_strip in zip(both_sides, vanished, strict=True):
            if lies_in_strip:
                found[self._first(q, in_turn[q])].append(q)
            else:
                metal.wide.note(q, out[q])
        return found

    def _first(self, q: int, parts: Ints) -> int:
        """The first of parts, cut one after the other, that leaves part `q` in a strip; the last one does."""
        around = self.metal.around(q)
        core, place = around.stiff, {part: k for k, part in enumerate(around.parts.tolist())}
        before, last = parts[:-1].tolist(), int(parts[-1])
        for k, p in enumerate(before, 1):
            core = shapely.difference(core, self.metal.swept[p])
            if self._on_both_sides(around, np.array([place[m] for m in before[:k]])) and bool(
                self._vanished(np.array([q]), np.array([core], dtype=object))[0]
            ):
                return int(p)
        return last

    @staticmethod
    def _on_both_sides(around: Around, out: Ints) -> bool:
        """Whether parts that take metal from the part lie in directions more than a right angle apart."""
        return _two_sides(around.towards[out[around.takes[out]]])

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


def _two_sides(towards: Floats) -> bool:
    """Whether directions (k, 2) are more than a right angle apart."""
    return len(towards) > 1 and bool((towards @ towards.T < 0).any())


MANY_PARTS = 200
"""With fewer, a second thread gains nothing."""


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


def lying_badly(metal: Metal, order: Sequence[int], at: Ints) -> dict[int, list[Badly]]:
    """What lies badly in one place after each part of an order, told once a part, in the numbers of the place.

    `at` (parts,) says when each is cut; for parts that never are it has a number that is larger than all. Strips and
    islands have nothing to do with each other, so they are looked for side by side.
    """
    strips, islands = in_parallel(
        lambda: _found(Strips(metal, at), order), lambda: _found(Islands(metal, at), order), len(order) >= MANY_PARTS
    )
    reported: set[int] = set()
    found: dict[int, list[Badly]] = {}
    for p in order:
        for badly in chain(strips[p], islands[p]):
            if (left := badly[2][0]) not in reported:
                reported.add(left)
                found.setdefault(p, []).append(badly)
    return found


def _found(looks: Strips | Islands, order: Sequence[int]) -> dict[int, list[Badly]]:
    return {p: list(looks.take_out(p)) for p in order}


def strips_and_islands(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    """What lies badly after each cut of an order of contour ids, told once a part; numbers are those of parts.

    Kept for the last few orders, and for none, with the nest as drawn: the plan that is found is looked at again as a
    plan, and as a program.
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


@cached_with_nest(most=5)
def _told(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    return tuple(_badly(nest, order, strip_mm, web_mm))


def _badly(nest: Nest, order: Sequence[str], strip_mm: float, web_mm: float) -> Iterator[Cutting]:
    number = {part.outer.id: k for k, part in enumerate(nest.parts)}
    grounds, where = _grounds(nest, strip_mm, web_mm)
    in_place = {part: p for ground in grounds.values() for p, part in enumerate(ground.parts)}
    first: dict[int, int] = {}
    for k, contour in enumerate(order, 1):
        if contour in number:
            first.setdefault(number[contour], k)
    in_turn: dict[str, list[int]] = {place: [] for place in grounds}
    for part in first:
        if part in in_place:
            in_turn[where[part]].append(in_place[part])
    found = {
        place: lying_badly(ground, in_turn[place], np.array([first.get(q, len(order) + 1) for q in ground.parts]))
        for place, ground in grounds.items()
    }
    for part, k in first.items():
        if part in in_place:
            ground = grounds[where[part]]
            for kind, out, left in found[where[part]].get(in_place[part], ()):
                yield Cutting(k, kind, tuple(ground.parts[m] for m in out), tuple(ground.parts[m] for m in left))


@cached_with_nest(most=2)
def _grounds(nest: Nest, strip_mm: float, web_mm: float) -> tuple[dict[str, Metal], list[str]]:
    """The metal of each place with several parts by the id of its hole ("" for the sheet); the place of each part."""
    hosts = host_holes(nest)
    at = places(nest, hosts)
    where = [at[part.id] for part in nest.parts]
    holes = {hole.id: hole.polygon for hole in hosts.values()}
    grounds = {}
    lying: dict[str, list[int]] = defaultdict(list)
    for k, of in enumerate(where):
        lying[of].append(k)
    for place, own in sorted((place, own) for place, own in lying.items() if len(own) > 1):
        ground = shapely.make_valid(holes[place] if place else nest.sheet.polygon)
        areas = shapely.make_valid(np.array([nest.parts[k].outer.polygon for k in own], dtype=object))
        grounds[place] = Metal(ground, own, areas, strip_mm, web_mm)
    return grounds, where
