"""Islands: pieces of metal with parts on them that parts that are out close off from the rest.

An island is closed within a few strips: everything is looked at near the part just cut out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.geometry.segment import Box

from .metal import Badly, Island, Metal

SPECK_MM2 = 1.0
CLOSE_STRIPS = (2.0, 5.0)
"""How far around a part close looks for islands go, in strips, before all is looked at that an island may be on."""


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
                away_mm = shapely.distance(metal.areas[more], metal.areas[p])
                other = int(more[np.lexsort((more, away_mm))[0]])
                yield "island", sorted(border.tolist()), [int(fewer.min()), other]

    def _closed_by(self, p: int) -> list[Island]:
        """The islands beside part `p` now that it is out.

        They depend on nothing but which parts in reach are out, so the answer for the order before is kept.
        """
        near = self.metal.in_reach(p)
        out = self.out[near]
        asked, known = out.tobytes(), self.metal.islands.get(p)
        if known is None or known[0] != asked:
            known = self.metal.islands[p] = asked, list(self._looked_for(p, near[out], near[~out]))
        return known[1]

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
