"""One sheet filled: part after part to the place that a taste likes best, and the room that is left."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Sheet

from .demand import Demand, Spacing
from .nofit import SLIVER_MM2, Placed, allowed
from .shapes import LOOSE_MM, Key, Shapes

Going = Callable[[], bool]
"""Whether to go on; asked before each part."""


@dataclass(frozen=True, slots=True)
class Taste:
    """What makes one place better than another: `along` weighs how far the part reaches from the left, `up` from below.

    `reach` counts to the part's far side, else to its near side. With `blocks` several of a type are laid at once, side
    by side in their least rectangle, as long as blocks have room. With `around` the rectangle around all that lies
    there, and around the part, is to be the least (Pavlov 1999, formula 4).
    """

    along: float = 1.0
    up: float = 0.01
    reach: bool = True
    blocks: bool = False
    around: bool = False

    def of(self, shifts: Floats, box: Box, lying: Box | None = None) -> Floats:
        """Array (n,), the less the better: of a part with that box at each shift, beside what lies in the other box."""
        if self.around and lying is not None:
            wide = np.maximum(shifts[:, 0] + box[2], lying[2]) - np.minimum(shifts[:, 0] + box[0], lying[0])
            high = np.maximum(shifts[:, 1] + box[3], lying[3]) - np.minimum(shifts[:, 1] + box[1], lying[1])
            return np.round(np.asarray(wide * high), 3)
        x = shifts[:, 0] + (box[2] if self.reach else box[0])
        y = shifts[:, 1] + (box[3] if self.reach else box[1])
        liked: Floats = np.round(self.along * x + self.up * y, 3)
        return liked


LEFT = Taste()
TASTES = (
    LEFT,
    Taste(blocks=True),
    Taste(reach=False),
    Taste(1.0, 0.3, blocks=True),
    Taste(0.01, 1.0),
    Taste(1.0, 1.0, blocks=True),
)
PAVLOV = (
    Taste(blocks=True, around=True),
    Taste(around=True),
    Taste(blocks=True),
)
"""Pavlov's: the least rectangle around all that lies there; the last fills what such rectangles leave."""
_TRIES = 4


def fill(
    room: Room,
    order: Sequence[int],
    left: Mapping[int, int],
    taste: Taste,
    going: Going = lambda: True,
    every: bool = False,
) -> list[Placed]:
    """Lay parts as long as any of them has room: `order` are part types, `left` how many there are of each.

    With `every` it ends at the first that has none.

    Returns
    -------
    What was laid, in that order.
    """
    laid: list[Placed] = []
    for kind in order:
        wanted = left[kind]
        for number, size in room.shapes.ways(kind, taste.blocks):
            while wanted >= size:
                if not going():
                    return laid
                news = put_best(room, number, taste)
                if not news:
                    break
                laid += news
                wanted -= size
        if every and wanted:
            return laid
    return laid


def put_best(room: Room, kind: int, taste: Taste) -> tuple[Placed, ...]:
    """Lay one part of a type, or one block, at its best place; nothing where there is no room."""
    for _ in range(_TRIES):
        best: tuple[float, float, float, int] | None = None
        where: tuple[Key, Floats] | None = None
        for number, pose in enumerate(room.shapes.poses(kind)):
            key = (kind, pose)
            places = room.places(key)
            if not len(places):
                continue
            liked = taste.of(places, room.shapes.shape(key).taken.bounds, room.box)
            k = int(np.lexsort((places[:, 0], places[:, 1], liked))[0])
            found = (float(liked[k]), float(places[k, 1]), float(places[k, 0]), number)
            if best is None or found < best:
                best, where = found, (key, places[k])
        if where is None:
            return ()
        if laid := room.put(*where):
            return laid
        room.bar(*where)
    return ()


def largest_first(shapes: Shapes, kinds: Sequence[int]) -> list[int]:
    """Part types in the order of their priority, and the largest first among those of one."""

    def size(kind: int) -> tuple[int, float, int]:
        return shapes.types[kind].priority, -shapes.types[kind].part.outer.polygon.area, kind

    return sorted(kinds, key=size)


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


# Parts that fit on no sheet at all, not even on an empty one.


def too_large(wanted: Demand, shapes: Shapes, spacing: Spacing) -> list[int]:
    """Numbers of the part types that fit on no empty sheet, however they are turned."""
    grounds = [usable(stock.sheet, spacing) for stock in wanted.stocks]
    return [
        kind
        for kind in range(len(wanted.types))
        if all(
            allowed(ground, shapes.shape((kind, pose)).taken).is_empty
            for ground in grounds
            for pose in shapes.poses(kind)
        )
    ]
