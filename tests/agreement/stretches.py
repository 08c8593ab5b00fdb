"""Ways along a stretch of a contour, as geometry sees them: what they burn, and what others have left of the ring."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import shapely

from kerfwise import Nest
from kerfwise.encoder.torch_path import compensated
from kerfwise.rule_kit import Contour, Cut

NEAR_MM = 0.06
"""A path covers what of a ring lies so near it: the check's tolerance, and the chords of rounds."""
SHORT_KERFS = 4.0
"""Less than so many kerfs is no stretch: rounds at corners, and where three parts meet in a T."""


def along_mm(cut: Cut, contour: Contour, kerf_mm: float) -> float:
    """How far the torch follows the contour's ring: its span, or once round."""
    ring = compensated(contour, kerf_mm)
    if cut.span is None:
        return ring.length_mm
    begin, end = (ring.project(point)[0] for point in (cut.span.begin, cut.span.end))
    onwards = (cut.direction == "ccw") == ring.is_ccw
    return float((end - begin if onwards else begin - end) % ring.length_mm)


class Stretches:
    """Which ways of each contour leave nothing of its ring, and burn nothing again, once some contours are out."""

    def __init__(self, nest: Nest, ways: Sequence[Sequence[Cut]], kerf_mm: float) -> None:
        self.ways, self.short_mm = ways, SHORT_KERFS * kerf_mm
        self.rings = [compensated(c, kerf_mm) if c.encloses else None for c in nest.contours]
        self.lines = [None if ring is None else shapely.LineString(ring.line()) for ring in self.rings]
        self.known: dict[tuple[int, int, frozenset[int]], bool] = {}

    @cached_property
    def beside(self) -> list[frozenset[int]]:
        """The contours whose ring runs along that of each."""
        near = [None if line is None else line.buffer(NEAR_MM) for line in self.lines]
        return [
            frozenset(
                j
                for j, area in enumerate(near)
                if j != i and line is not None and area is not None and line.intersection(area).length > self.short_mm
            )
            for i, line in enumerate(self.lines)
        ]

    def open(self, contour: int, way: int, out: Sequence[int]) -> bool:
        """Whether a way suits what is out."""
        key = contour, way, self.beside[contour].intersection(out)
        if key not in self.known:
            self.known[key] = self._suits(*key)
        return self.known[key]

    def _suits(self, contour: int, way: int, out: frozenset[int]) -> bool:
        ring, line, cut = self.rings[contour], self.lines[contour], self.ways[contour][way]
        if ring is None or line is None:
            return True
        if cut.span is None:
            return not out
        begin, end = (ring.project(point)[0] for point in (cut.span.begin, cut.span.end))
        if (cut.direction == "ccw") != ring.is_ccw:
            begin, end = end, begin
        followed = ring.between(begin, (end - begin) % ring.length_mm).line()
        older = shapely.union_all([self.lines[k] for k in sorted(out)]).buffer(NEAR_MM)
        left = line.difference(shapely.union(older, followed.buffer(NEAR_MM)))
        return followed.intersection(older).length <= self.short_mm and left.length <= self.short_mm
