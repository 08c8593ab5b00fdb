"""Each torch-on path as what it burns: which contour it follows, and which of it are leads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.tests.metal.arcs import Floats, Point
from kerfwise.tests.metal.drawing import Drawing, Meant
from kerfwise.tests.metal.program import Path
from kerfwise.tests.metal.tolerances import RING_MM

_ROUND = 0.9
"""A path that is on so much of a contour's own path goes round it."""


@dataclass(frozen=True, eq=False)
class Burn:
    """One torch-on path: `line` of its centre, the contour it follows (if any), and its leads.

    `on_ring_mm` of it run on the contour's own path, which is `ring_mm` long. `lead_in` ends and `lead_out`
    begins where it joins that; `strays` are stretches off it in between. Of a path that goes round several contours
    each is a burn of its own; a `linked` one is not pierced: its lead-in is the link from the one before, or it is lit
    again behind a tab.
    """

    path: Path
    line: shapely.Geometry
    contour: Meant | None
    lead_in: shapely.LineString | None
    lead_out: shapely.LineString | None
    strays: tuple[shapely.LineString, ...]
    on_ring_mm: float
    ring_mm: float
    linked: bool = False

    @property
    def cut(self) -> int:
        """Its number in the program."""
        return self.path.order

    @property
    def name(self) -> str:
        """The contour it follows, else what the program calls it."""
        return self.contour.id if self.contour else self.path.label or f"path {self.path.order}"

    @property
    def pierce(self) -> Point:
        """Where the torch comes on."""
        return float(self.path.points[0, 0]), float(self.path.points[0, 1])

    @property
    def off_ring(self) -> shapely.Geometry:
        """Its leads and strays."""
        leads = (self.lead_in, self.lead_out, *self.strays)
        return shapely.MultiLineString([lead for lead in leads if lead is not None])

    def kerf(self, half_mm: float) -> shapely.Geometry:
        """What is burnt within `half_mm` of the centre."""
        return self.line.buffer(half_mm, quad_segs=16)


class Followed:
    """Which contour a path follows: the one on whose own path it stays the longest."""

    def __init__(self, drawing: Drawing, kerf_mm: float) -> None:
        self.contours = (*drawing.closed, *drawing.scrap)
        self.lines = [c.path(kerf_mm) for c in self.contours]
        shapely.prepare(self.lines)
        self.tree = shapely.STRtree(self.lines)

    def burns(self, path: Path) -> list[Burn]:
        """The burns that a path makes: one for each contour that it goes round, in order, or one in all."""
        ends = sorted(self._ends(path)) if len(path.points) > 1 else []
        if len(ends) < 2:
            return [self.burn(path)]
        cuts = [0, *ends[:-1], len(path.points) - 1]
        rows = [self.burn(replace(path, points=path.points[a : b + 1])) for a, b in pairwise(cuts)]
        return [rows[0], *(replace(burn, linked=True) for burn in rows[1:])]

    def _ends(self, path: Path) -> Iterator[int]:
        """The last vertices of a path on each contour that it goes nearly all round."""
        lengths = np.hypot(*np.diff(path.points, axis=0).T)
        line = shapely.LineString(path.points)
        for k in self.tree.query(line, predicate="dwithin", distance=RING_MM).tolist():
            on_vertex, on_segment = _on(self.lines[k], path.points)
            if lengths[on_segment].sum() > _ROUND * self.lines[k].length:
                yield len(path.points) - 1 - int(np.argmax(on_vertex[::-1]))

    def burn(self, path: Path) -> Burn:
        """The burn of a path that follows one contour."""
        points = path.points
        if len(points) == 1:
            return Burn(path, shapely.Point(points[0]), None, None, None, (), 0.0, 0.0)
        line = shapely.LineString(points)
        lengths = np.hypot(*np.diff(points, axis=0).T)
        best, vertices, segments, longest, ring_mm = None, None, None, 0.0, 0.0
        for k in sorted(self.tree.query(line, predicate="dwithin", distance=RING_MM).tolist()):
            on_vertex, on_segment = _on(self.lines[k], points)
            if (length := float(lengths[on_segment].sum())) > longest:
                best, vertices, segments, longest = self.contours[k], on_vertex, on_segment, length
                ring_mm = float(self.lines[k].length)
        if best is None or vertices is None or segments is None:
            return Burn(path, line, None, None, None, (line,), 0.0, 0.0)
        first, last = int(np.argmax(vertices)), len(points) - 1 - int(np.argmax(vertices[::-1]))
        strays = tuple(_line(points[a : b + 1]) for a, b in _runs(~segments, first, last))
        lead_in = _line(points[: first + 1]) if first else None
        lead_out = _line(points[last:]) if last < len(points) - 1 else None
        return Burn(path, line, best, lead_in, lead_out, strays, longest, ring_mm)


def _on(ring: shapely.Geometry, points: Floats) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which vertices, and which segments between them, lie on the ring."""
    on = shapely.dwithin(ring, shapely.points(points), RING_MM)
    halfway = shapely.dwithin(ring, shapely.points((points[1:] + points[:-1]) / 2), RING_MM)
    return on, on[1:] & on[:-1] & halfway


def _runs(off: NDArray[np.bool_], first: int, last: int) -> list[tuple[int, int]]:
    """Stretches of segments that are off the ring, as first and last vertex."""
    found: list[tuple[int, int]] = []
    for k in range(first, last):
        if off[k]:
            if found and found[-1][1] == k:
                found[-1] = (found[-1][0], k + 1)
            else:
                found.append((k, k + 1))
    return found


def _line(points: Floats) -> shapely.LineString:
    return shapely.LineString(points)


def burns_of(paths: Sequence[Path], drawing: Drawing, kerf_mm: float) -> list[Burn]:
    """The burns of the paths with the torch on, in order; marks burn nothing."""
    followed = Followed(drawing, kerf_mm)
    return [
        replace(burn, linked=burn.linked or path.goes_on)
        for path in paths
        if path.burns
        for burn in followed.burns(path)
    ]
