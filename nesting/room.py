"""The room that is left on one sheet: where each part type may still lie, in each pose."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.nest import Sheet

from .nofit import SLIVER_MM2, allowed
from .outline import LOOSE_MM
from .pose import Placed
from .shapes import Key, Shapes
from .wanted import Spacing

_NEAR_MM = 3e-3
"""Distances may be less by this: outlines are a little smaller, and places are rounded to a thousandth."""


def usable(sheet: Sheet, spacing: Spacing) -> shapely.Geometry:
    """What of a sheet parts may take, half the gap around them included."""
    within_mm = spacing.edge_mm - spacing.gap_mm / 2 - LOOSE_MM
    return sheet.polygon.buffer(-within_mm, join_style="mitre")


class Room:
    """One sheet while it is filled: what lies on it, and for each type and pose where one more may lie.

    Where a type has no room once, it has none later: parts do not leave.
    """

    def __init__(self, shapes: Shapes, sheet: Sheet, spacing: Spacing) -> None:
        self.shapes, self.sheet, self.spacing = shapes, sheet, spacing
        self.ground = usable(sheet, spacing)
        self._whole = sheet.polygon.buffer(_NEAR_MM - spacing.edge_mm, join_style="mitre")
        shapely.prepare(self._whole)
        self.placed: list[Placed] = []
        self._metal: list[shapely.Geometry] = []
        self._free: dict[Key, shapely.Geometry] = {}
        self._seen: dict[Key, int] = {}

    def places(self, key: Key) -> Floats:
        """Array (n, 2) of shifts at the corners of where a part may lie; none where there is no room."""
        points: Floats = shapely.get_coordinates(self._where(key))
        return points

    def put(self, key: Key, shift: Iterable[float]) -> tuple[Placed, ...]:
        """Lay a part or a pair there, and say how; nothing where it would come too near to others, and is not laid."""
        dx, dy = (round(float(by), 3) + 0.0 for by in shift)
        laid = tuple(self.shapes.members(key, dx, dy))
        before = len(self._metal)
        for lying in laid:
            metal = lying.area(self.shapes.types[lying.kind].part.polygon)
            if not self._fits(metal):
                del self._metal[before:]
                return ()
            self._metal.append(metal)
        self.placed += laid
        return laid

    def _fits(self, metal: shapely.Geometry) -> bool:
        if not self._whole.covers(metal):
            return False
        others = np.array(self._metal, dtype=object)
        if self.spacing.gap_mm < _NEAR_MM:
            return not (shapely.area(shapely.intersection(others, metal)) > _NEAR_MM * 10).any()
        return not (shapely.distance(others, metal) < self.spacing.gap_mm - _NEAR_MM).any()

    def bar(self, key: Key, shift: Floats) -> None:
        """Never offer this place again."""
        self._free[key] = self._where(key).difference(shapely.Point(shift).buffer(0.05))

    def lay(self, others: Iterable[Placed]) -> None:
        """Take over parts that lie there already."""
        for lying in others:
            self.placed.append(lying)
            self._metal.append(lying.area(self.shapes.types[lying.kind].part.polygon))

    def _where(self, key: Key) -> shapely.Geometry:
        if key not in self._free:
            self._free[key] = allowed(self.ground, self.shapes.shape(key).taken)
            self._seen[key] = 0
        free, seen = self._free[key], self._seen[key]
        if seen < len(self.placed):
            self._seen[key] = len(self.placed)
            if not free.is_empty:
                left = shapely.get_parts(free.difference(self._barred(key, self.placed[seen:], free)))
                self._free[key] = free = shapely.multipolygons(left[shapely.area(left) > SLIVER_MM2])
        return free

    def _barred(self, key: Key, news: list[Placed], free: shapely.Geometry) -> shapely.Geometry:
        """Where the part may not lie because of those that came since."""
        x0, y0, x1, y1 = free.bounds
        barred = []
        for lying in news:
            shifts = self.shapes.forbidden((lying.kind, lying.pose), key)
            a0, b0, a1, b1 = shifts.bounds
            dx, dy = lying.dx_mm, lying.dy_mm
            if a0 + dx <= x1 and a1 + dx >= x0 and b0 + dy <= y1 and b1 + dy >= y0:
                barred.append(shapely.transform(shifts, lambda points, by=(dx, dy): points + by))
        return shapely.union_all(barred)
