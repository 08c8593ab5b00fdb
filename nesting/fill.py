"""One sheet filled: part after part to the place that a taste likes best, among all corners of where it may lie."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.segment import Box

from .pose import Placed
from .room import Room
from .shapes import Key, Shapes

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


def by_size(shapes: Shapes, kinds: Sequence[int]) -> list[int]:
    """Part types in the order of their priority, and the largest first among those of one."""

    def size(kind: int) -> tuple[int, float, int]:
        return shapes.types[kind].priority, -shapes.types[kind].part.outer.polygon.area, kind

    return sorted(kinds, key=size)
