"""The last sheet laid anew, so that a larger rectangle is left of it."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import replace

import shapely

from .allot import Layout, Sheetful
from .fill import Going, Taste, by_size, fill
from .left_over import largest_rectangle
from .pose import Placed
from .room import Room, usable
from .shapes import Shapes

_ACROSS = (Taste(), Taste(blocks=True), Taste(reach=False))
_UP = (Taste(0.01, 1.0), Taste(0.01, 1.0, blocks=True), Taste(0.01, 1.0, reach=False))
_MORE_MM = 0.5
"""A rectangle has to become so much deeper."""


def squeezed(layout: Layout, shapes: Shapes, tries: int, seed: int, going: Going = lambda: True) -> Layout:
    """The layout with its last sheet laid so that the largest rectangle along a side is left that was found.

    Each try lays all its parts in less room than they have now, from the left or from below, in another order. The
    sheet is a rectangle, else the layout stays as it is.
    """
    if not layout.sheets:
        return layout
    chance, last = random.Random(seed), layout.sheets[-1]
    for number in range(tries):
        if not going():
            break
        last = _tried(layout, last, shapes, chance, number, going) or last
    return layout if last is layout.sheets[-1] else replace(layout, sheets=(*layout.sheets[:-1], last))


def _tried(
    layout: Layout, last: Sheetful, shapes: Shapes, chance: random.Random, number: int, going: Going
) -> Sheetful | None:
    x0, y0, x1, y1 = last.stock.sheet.bounds
    gap_mm = layout.spacing.gap_mm
    a, b, c, d = largest_rectangle(last.stock.sheet, layout.metal_of(last), gap_mm)
    area_mm2 = (c - a) * (d - b)
    if area_mm2 <= 0:
        return None
    across = number % 2 == 0
    right = x1 - gap_mm - area_mm2 / (y1 - y0) - _MORE_MM if across else x1
    top = y1 if across else y1 - gap_mm - area_mm2 / (x1 - x0) - _MORE_MM
    ground = usable(last.stock.sheet, layout.spacing).intersection(
        shapely.box(x0, y0, right + gap_mm / 2, top + gap_mm / 2)
    )
    placed = _all_in(Room(shapes, last.stock.sheet, layout.spacing, ground), last, chance, number, going)
    return None if placed is None else replace(last, placed=tuple(placed))


def _all_in(room: Room, last: Sheetful, chance: random.Random, number: int, going: Going) -> list[Placed] | None:
    """All parts of the sheet in that room, or None."""
    left = Counter(one.kind for one in last.placed)
    order = by_size(room.shapes, sorted(left))
    if number >= 2 * len(_ACROSS):
        weight = {k: (room.shapes.types[k].area_mm2 ** 0.5) * chance.uniform(0.6, 1.4) for k in order}
        order.sort(key=lambda k: -weight[k])
    tastes = _ACROSS if number % 2 == 0 else _UP
    placed = fill(room, order, left, tastes[number // 2 % len(tastes)], going, every=True)
    return placed if len(placed) == len(last.placed) else None
