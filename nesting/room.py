"""The room that is left on one sheet: where each part type may still lie, in each pose."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Sheet

from .nofit import SLIVER_MM2, allowed
from .outline import LOOSE_MM
from .pose import Placed
from .shapes import Key, Shapes
from .wanted import Spacing

_NEAR_MM = 3e-3
"""Distances may be less by this: outlines are a little smaller, and places are rounded to a thousandth."""

_SPECK_MM2 = 1e-4
"""Overlaps no larger are none; others are none where they are no thicker than rounding makes them."""


def usable(sheet: Sheet, spacing: Spacing) -> shapely.Geometry:
    """What of a sheet parts may take, half the gap around them included."""
    within_mm = spacing.edge_mm - spacing.gap_mm / 2 - LOOSE_MM
    return sheet.polygon.buffer(-within_mm, join_style="mitre")


class Room:
    """One sheet while it is filled: what lies on it, and for each type and pose where one more may lie.

    Where a type has no room once, it has none later: parts do not leave. `ground` is where parts may lie, half the gap
    around them included; all of the sheet that may be used, where it is not given.
    """

    def __init__(self, shapes: Shapes, sheet: Sheet, spacing: Spacing, ground: shapely.Geometry | None = None) -> None:
        self.shapes, self.sheet, self.spacing = shapes, sheet, spacing
        self.ground = usable(sheet, spacing) if ground is None else ground
        self._whole = sheet.polygon.buffer(_NEAR_MM - spacing.edge_mm, join_style="mitre")
        shapely.prepare(self._whole)
        self.placed: list[Placed] = []
        self._metal: list[shapely.Geometry] = []
        self._free: dict[Key, shapely.Geometry] = {}
        self._seen: dict[Key, int] = {}
        self._box: Box | None = None

    def places(self, key: Key) -> Floats:
        """Array (n, 2) of shifts at the corners of where a part may lie; none where there is no room."""
        points: Floats = shapely.get_coordinates(self._where(key))
        return points

    @property
    def box(self) -> Box | None:
        """The box around all that lies here, half the gap included; None where nothing does."""
        return self._box

    def put(self, key: Key, shift: Iterable[float]) -> tuple[Placed, ...]:
        """Lay a part or a block there, and say how; nothing where it would come too near to others, and is not laid."""
        dx, dy = (round(float(by), 3) + 0.0 for by in shift)
        laid = tuple(self.shapes.members(key, dx, dy))
        metal = [lying.area(self.shapes.types[lying.kind].part.polygon) for lying in laid]
        if not all(map(self._fits, metal)) or not self._fit_together(metal):
            return ()
        self._metal += metal
        self.placed += laid
        self._widen(key, dx, dy)
        return laid

    def _widen(self, key: Key, dx_mm: float, dy_mm: float) -> None:
        """Take what was laid into the box."""
        x0, y0, x1, y1 = self.shapes.shape(key).taken.bounds
        mine = (x0 + dx_mm, y0 + dy_mm, x1 + dx_mm, y1 + dy_mm)
        self._box = mine if self._box is None else _around(self._box, mine)

    def _fit_together(self, metal: list[shapely.Geometry]) -> bool:
        """Whether the parts of a block lie as far apart as those of blocks must."""
        common = self.shapes.common
        if len(metal) < 2 or common is None:
            return len(metal) < 2 or self._clear(metal[0], metal[1:])
        least_mm = min(common.apart_mm, self.spacing.gap_mm) - _NEAR_MM
        one, other = shapely.STRtree(metal).query(metal, "dwithin", distance=least_mm)
        return not (one != other).any()

    def _fits(self, metal: shapely.Geometry) -> bool:
        return bool(self._whole.covers(metal)) and self._clear(metal, self._metal)

    def _clear(self, metal: shapely.Geometry, lying: list[shapely.Geometry]) -> bool:
        """Whether a part is far enough from those."""
        others = np.array(lying, dtype=object)
        if self.spacing.gap_mm < _NEAR_MM:
            shared = shapely.intersection(others, metal)
            shared = shared[shapely.area(shared) > _SPECK_MM2]
            return bool(shapely.is_empty(shapely.buffer(shared, -_NEAR_MM)).all())
        return not (shapely.distance(others, metal) < self.spacing.gap_mm - _NEAR_MM).any()

    def bar(self, key: Key, shift: Floats) -> None:
        """Never offer this place again."""
        self._free[key] = self._where(key).difference(shapely.Point(shift).buffer(0.05))

    def take(self, others: Iterable[Placed]) -> None:
        """Take over parts that lie there already."""
        for lying in others:
            self.placed.append(lying)
            self._metal.append(lying.area(self.shapes.types[lying.kind].part.polygon))
            self._widen((lying.kind, lying.pose), lying.dx_mm, lying.dy_mm)

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


def _around(one: Box, other: Box) -> Box:
    return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])
