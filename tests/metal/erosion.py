"""Burns that reach into a part's metal."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from kerfwise.tests.metal.burns import Burn
from kerfwise.tests.metal.drawing import Drawing
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.slots import Slots
from kerfwise.tests.metal.tolerances import RING_MM


class PartMetal:
    """The metal of every part, that no burn may reach into by more than the allowance."""

    def __init__(self, drawing: Drawing, kerf_mm: float, touching: bool = False, slots: Slots | None = None) -> None:
        self.slots = slots or Slots(drawing, kerf_mm, opened=False)
        self.drawing, self.kerf_mm, self.touching = drawing, kerf_mm, touching
        self.ids = list(drawing.parts)
        self.areas = np.array(list(drawing.parts.values()), dtype=object)
        shapely.prepare(self.areas)
        self.tree = shapely.STRtree(self.areas)

    def judge(self, burn: Burn) -> Iterator[Finding]:
        """Parts that a burn takes metal from, and one that it pierces."""
        within = self.kerf_mm / 2 - RING_MM
        if within <= 0:
            return
        for k in sorted(self.tree.query(burn.line, predicate="dwithin", distance=within).tolist()):
            line = burn.line
            if self.touching and burn.contour is not None and burn.contour.part != self.ids[k]:
                line = burn.off_ring
            if shapely.dwithin(self.areas[k], line, within - self.slots.allowance(burn, self.ids[k])):
                yield from self._eroded(burn, line, k)

    def _eroded(self, burn: Burn, line: shapely.Geometry, k: int) -> Iterator[Finding]:
        part, pierce = self.areas[k], shapely.Point(burn.pierce)
        lost = part.intersection(line.buffer(self.kerf_mm / 2, quad_segs=16))
        corners = shapely.get_coordinates(shapely.segmentize(lost, self.kerf_mm / 2))
        depths = shapely.distance(part.boundary, shapely.points(corners))
        deepest = int(np.argmax(depths))
        x, y = (float(v) for v in corners[deepest])
        text = f"{lost.area:.1f} mm² of the part are burnt away, to a depth of"
        names = (burn.name, self._nearest(self.ids[k], x, y))
        yield Finding("part-eroded", burn.cut, names, (x, y), float(depths[deepest]), "mm", text)
        if not burn.linked and part.contains(pierce):
            depth = float(pierce.distance(part.boundary))
            yield Finding("pierce-in-part", burn.cut, names, burn.pierce, depth, "mm", "the torch pierces the part by")

    def _nearest(self, part: str, x: float, y: float) -> str:
        own = [c for c in self.drawing.closed if c.part == part]
        return min(own, key=lambda c: c.line.distance(shapely.Point(x, y))).id
