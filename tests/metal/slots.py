"""Slots that a round torch cannot enter, and what one pass along their middle may take of a part.

A slot here is a pocket of the waste that is gone when the area of a contour is closed with a disc as wide as the kerf.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np
import shapely

from kerfwise.tests.metal.burns import Burn
from kerfwise.tests.metal.drawing import Drawing, Meant
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.tolerances import NUMERIC_MM, RING_MM

STEP_MM = 0.1
LEAST_MM2 = 1e-3
"""Smaller pockets are what chords make."""


class Slots:
    """The slots of a drawing for one kerf; with `opened` a pass along the middle of one may widen it to the kerf."""

    def __init__(self, drawing: Drawing, kerf_mm: float, opened: bool) -> None:
        self.drawing, self.kerf_mm, self.opened = drawing, kerf_mm, opened
        self._pockets = cache(self._found)

    def allowance(self, burn: Burn, part: str) -> float:
        """How deep a burn that follows no contour may reach into a part, mm: half of what its slot lacks of a kerf."""
        if not self.opened or burn.contour is not None or burn.line.geom_type != "LineString":
            return 0.0
        widths = [
            width
            for contour in self._of(part)
            for pocket in self._pockets(contour)
            if (width := self._narrowest(pocket, burn.line)) is not None
        ]
        return max(self.kerf_mm - min(widths), 0.0) / 2 if widths else 0.0

    def shut(self, burns: Sequence[Burn]) -> Iterator[Finding]:
        """Walls of slots that a pass has opened in part only: as much may be left as in a square corner."""
        within = self.kerf_mm / 2 * np.sqrt(2) + RING_MM
        for burn in (b for b in burns if self.opened and b.contour is None and b.line.geom_type == "LineString"):
            for contour in self.drawing.closed:
                for pocket in self._pockets(contour) if contour.line.dwithin(burn.line, self.kerf_mm) else ():
                    if self._narrowest(pocket, burn.line) is None:
                        continue
                    wall = contour.line.intersection(pocket.buffer(NUMERIC_MM))
                    near = [b.line.buffer(within, quad_segs=16) for b in burns if b.line.dwithin(pocket, self.kerf_mm)]
                    left = wall.difference(shapely.union_all(near))
                    if left.length > NUMERIC_MM:
                        x, y = shapely.get_coordinates(left)[0].tolist()
                        text = "a slot is not open to its end, wall not reached for"
                        yield Finding("feature-lost", burn.cut, (contour.id,), (x, y), float(left.length), "mm", text)

    def _of(self, part: str) -> list[Meant]:
        return [c for c in self.drawing.closed if c.part == part]

    def _found(self, contour: Meant) -> list[shapely.Polygon]:
        """The pockets of a contour's waste."""
        assert contour.area is not None
        r = self.kerf_mm / 2 if contour.kind == "outer" else -self.kerf_mm / 2
        round_ = contour.area.buffer(r, quad_segs=32).buffer(-r, quad_segs=32)
        lost = round_ - contour.area if contour.kind == "outer" else contour.area - round_
        return [p for p in shapely.get_parts(lost) if p.geom_type == "Polygon" and p.area > LEAST_MM2]

    def _narrowest(self, pocket: shapely.Polygon, line: shapely.LineString) -> float | None:
        """The narrowest place of a pocket across a burn that runs in it; None for one that does not."""
        (x0, y0), (x1, y1) = np.array(line.coords)[-2:]
        length = float(np.hypot(x1 - x0, y1 - y0))
        if length == 0 or not pocket.dwithin(line, self.kerf_mm / 2):
            return None
        along = np.array([x1 - x0, y1 - y0]) / length
        across = np.array([-along[1], along[0]]) * 2 * self.kerf_mm
        steps = np.linspace(0, length + self.kerf_mm / 2, max(int(length / STEP_MM), 40))
        widths: list[tuple[bool, float]] = []
        for step in steps.tolist():
            p = np.array([x0, y0]) + step * along
            if not pocket.contains(shapely.Point(p)):
                continue
            pieces = shapely.get_parts(pocket.intersection(shapely.LineString([p - across, p + across])))
            own = [piece for piece in pieces if piece.distance(shapely.Point(p)) < NUMERIC_MM]
            widths += [(step <= length, float(piece.length)) for piece in own]
        # the centre of a pass along a shallow slot stays before its mouth, the pocket is as wide as its mouth then
        on_pass = [width for within, width in widths if within]
        return min(on_pass) if on_pass else max((width for _, width in widths), default=None)
