"""One sheet filled: part after part to the place that a taste likes best, among all corners of where it may lie."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats

from .pose import Placed
from .room import Room
from .shapes import Key, Shapes

Going = Callable[[], bool]
"""Whether to go on; asked before each part."""


@dataclass(frozen=True, slots=True)
class Taste:
    """What makes one place better than another: `along` weighs how far the part reaches from the left, `up` from below.

    `reach` counts to the part's far side, else to its near side. With `pairs` two of a type are laid at once, side by
    side in their least rectangle, as long as pairs have room.
    """

    along: float = 1.0
    up: float = 0.01
    reach: bool = True
    pairs: bool = False

    def of(self, shifts: Floats, box: tuple[float, float, float, float]) -> Floats:
        """Array (n,), the less the better."""
        x = shifts[:, 0] + (box[2] if self.reach else box[0])
        y = shifts[:, 1] + (box[3] if self.reach else box[1])
        liked: Floats = np.round(self.along * x + self.up * y, 3)
        return liked


LEFT = Taste()
TASTES = (
    LEFT,
    Taste(pairs=True),
    Taste(reach=False),
    Taste(1.0, 0.3, pairs=True),
    Taste(0.01, 1.0),
    Taste(1.0, 1.0, pairs=True),
)
_TRIES = 4


def fill(
    room: Room, order: Sequence[int], left: Mapping[int, int], taste: Taste, going: Going = lambda: True
) -> list[Placed]:
    """Lay parts as long as any of them has room: `order` are part types, `left` how many there are of each.

    Returns
    -------
    What was laid, in that order.
    """
    laid: list[Placed] = []
    for kind in order:
        wanted = left[kind]
        for number in (kind + len(room.shapes.types), kind) if taste.pairs else (kind,):
            size = 1 if number == kind else 2
            while wanted >= size:
                if not going():
                    return laid
                news = put_best(room, number, taste)
                if not news:
                    break
                laid += news
                wanted -= size
    return laid


def put_best(room: Room, kind: int, taste: Taste) -> tuple[Placed, ...]:
    """Lay one part of a type, or one pair, at its best place; nothing where there is no room."""
    for _ in range(_TRIES):
        best: tuple[float, float, float, int] | None = None
        where: tuple[Key, Floats] | None = None
        for number, pose in enumerate(room.shapes.poses(kind)):
            key = (kind, pose)
            places = room.places(key)
            if not len(places):
                continue
            liked = taste.of(places, room.shapes.shape(key).taken.bounds)
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
