"""Pierces and leads over the kerfs of earlier cuts, where there is no metal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import shapely
from shapely.ops import substring

from kerfwise.tests.metal.arcs import Point
from kerfwise.tests.metal.burns import Burn
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.tolerances import NUMERIC_MM, RING_MM


class OlderKerfs:
    """The kerfs of a row of burns, in the order in which they come to be; `own` is the hole that a burn begins at."""

    def __init__(
        self,
        burns: list[Burn],
        sheet: shapely.Polygon,
        kerf_mm: float,
        splash_mm: float,
        own: Mapping[int, int] | None = None,
        kerf_starts: bool = False,
    ) -> None:
        self.own, self.kerf_starts = own or {}, kerf_starts
        self.burns, self.sheet, self.kerf_mm, self.splash_mm = burns, sheet, kerf_mm, splash_mm
        self.lines = np.array([b.line for b in burns], dtype=object)
        self.tree = shapely.STRtree(self.lines)

    def judge(self, k: int) -> Iterator[Finding]:
        """What is wrong with the pierce and the leads of burn `k`, all before it having been burnt.

        A scrap line goes from one void to another: it is asked for neither.
        """
        own = self.burns[k].contour
        if own is not None and own.kind == "scrap":
            return
        yield from self._pierce(k)
        for lead, of_link_mm in _leads(self.burns[k], self.kerf_mm / 2):
            yield from self._lead(k, lead, of_link_mm)

    def _older(self, k: int, what: shapely.Geometry, within_mm: float) -> list[int]:
        near = self.tree.query(what, predicate="dwithin", distance=within_mm)
        return sorted(j for j in near.tolist() if j < k and j != self.own.get(k))

    def _pierce(self, k: int) -> Iterator[Finding]:
        burn, point = self.burns[k], shapely.Point(self.burns[k].pierce)
        if burn.linked or not self.sheet.intersects(
            point
        ):  # no metal to pierce: that is another finding, or an edge start
            return
        older = self._older(k, point, self.kerf_mm + self.splash_mm - NUMERIC_MM)
        if not older:
            return
        if self.kerf_starts and any(point.distance(self.lines[j]) <= RING_MM for j in older):
            return  # it begins in the middle of an older kerf
        away = {j: float(point.distance(self.lines[j])) - self.kerf_mm / 2 for j in older}
        j = min(away, key=lambda j: away[j])
        text = f"the pierce is {away[j]:.2f} mm from the kerf of cut {self.burns[j].cut}; less than half a kerf by"
        lacking = self.kerf_mm / 2 + self.splash_mm - away[j]
        names = (burn.name, self.burns[j].name)
        yield Finding("pierce-over-void", burn.cut, names, burn.pierce, lacking, "mm", text)

    def _lead(self, k: int, lead: shapely.LineString, of_link_mm: float) -> Iterator[Finding]:
        """A lead over older kerfs; its first `of_link_mm` may lie in what the burn before it has burnt."""
        burn, half = self.burns[k], self.kerf_mm / 2 - NUMERIC_MM
        for j in self._older(k, lead, half):
            older, free = self.lines[j], lead
            if burn.linked and j == k - 1:
                free = substring(lead, of_link_mm, lead.length)
            if self.kerf_starts and lead.length - of_link_mm <= self.kerf_mm:
                continue  # from one kerf to another, straight on past a corner
            if burn.linked and j == k - 1 and not self.burns[j].linked:
                older = older.difference(self.burns[j].off_ring)  # a link may leave beside the lead, as a lead-out may
            if self._one_round(j, k):  # lit again behind a tab: it leaves its ring as a round without tabs does
                older = older.difference(self.burns[j].off_ring)
                free = _once_out(free, older.buffer(half, quad_segs=16))
            over = free.intersection(older.buffer(half, quad_segs=16))
            if over.length <= NUMERIC_MM:
                continue
            text = f"a lead crosses the kerf of cut {self.burns[j].cut} for"
            names = (burn.name, self.burns[j].name)
            yield Finding("lead-over-void", burn.cut, names, _place(over), float(over.length), "mm", text)

    def _one_round(self, j: int, k: int) -> bool:
        """Whether two burns are stretches of one round, between which nothing else is cut."""
        own = self.burns[k].contour
        stretches = self.burns[j : k + 1]
        return own is not None and all(b.contour is own for b in stretches) and all(b.linked for b in stretches[1:])


def _once_out(lead: shapely.Geometry, kerf: shapely.Geometry) -> shapely.Geometry:
    """What follows of a lead once it has left the kerf that it begins in."""
    begin = shapely.Point(lead.coords[0]) if isinstance(lead, shapely.LineString) and not lead.is_empty else None
    if begin is None or begin.distance(kerf) > NUMERIC_MM:
        return lead
    runs = [run for run in shapely.get_parts(lead.intersection(kerf)) if run.distance(begin) <= NUMERIC_MM]
    ends = [lead.project(shapely.Point(point)) for point in shapely.get_coordinates(runs)]
    return substring(lead, max(ends, default=0.0), lead.length)


def _leads(burn: Burn, end_mm: float) -> Iterator[tuple[shapely.LineString, float]]:
    """The leads and strays of a burn, each without its last half kerf at the burn's own ring.

    A link is without its first half kerf too. It may leave the ring that it comes from at 30° or more, and so be in
    that ring's kerf, and in no other, for another half: the number beside it.
    """
    begin_mm = end_mm if burn.linked else 0.0
    if burn.lead_in is not None and burn.lead_in.length > begin_mm + end_mm:
        yield substring(burn.lead_in, begin_mm, burn.lead_in.length - end_mm), begin_mm
    if burn.lead_out is not None and burn.lead_out.length > end_mm:
        yield substring(burn.lead_out, end_mm, burn.lead_out.length), 0.0
    for stray in burn.strays:
        if stray.length > 2 * end_mm:
            yield substring(stray, end_mm, stray.length - end_mm), 0.0


def _place(over: shapely.Geometry) -> Point:
    x, y = shapely.get_coordinates(over)[0]
    return float(x), float(y)
