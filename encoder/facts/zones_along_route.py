"""Zones along an order that is known to be short: runs of it, where they do what zones are for.

Borders that geometry draws cut across the ways that a torch would take. An order that was found without them goes over
the sheet in much the same way, and runs of it make zones that cost next to nothing. They are zones in the sense of the
rule as long as they are no more than geometry has made, or than a proof bears, what is left of the sheet stays about as
square as after those, each lies as much together as they do, and the first is at the start side.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

from .facts import Facts
from .outlines import AWAY, AXIS, outlines_of
from .zone_strips import Blocks, blocks_of, locked_pairs, side_ratio
from .zones import (
    Bearing,
    Bears,
    Units,
    divisions,
    merge_zones_while,
    raise_zones,
    respected_orders,
    set_limit,
    units_of,
)

MOST_CONTOURS = 60, 45
"""Contours in a zone, about: with more of them some order that was dropped, and does not hold, makes many sets. Larger
zones are made first, and then smaller ones, of which there may be more."""
LESS_SQUARE, LESS_TOGETHER = 1.05, 1.5
"""How many times as long and narrow what is left may be, on an average, and how many times as large the rectangles
around all zones, as they are with zones made by geometry."""

MIDDLES = 2500
"""Contours in an order up to which a block that is gone back to lies in the middle of its contours."""

SQUARENESS = 0.9, 0.5
"""How much the one weighs and how much the other, where zones are made; the first goes first."""


def movable(facts: Facts) -> bool:
    """Whether geometry alone has made the zones: no number, lock of a zone or budget of the plant has, nothing is cut
    yet, and no lines cut up the skeleton, whose zone is the last. A locked place in the order is kept by the route that
    zones are drawn along."""
    return not facts.options.zones_decided and facts.past is None and not facts.nest.scrap and not facts.nest.stretches


def zones_along(facts: Facts, order: Sequence[int], *, any_shape: bool = False) -> Iterator[Ints]:
    """Zones of all contours (n,) as runs of an order (n,) of them that keeps the hard orders, but for those of zones.

    Large zones come first. Of those that are about as large, first come those that join runs one after the other while
    a proof bears them, then those that do best what zones are for, the fewest first. Each does what zones are for, or,
    with `any_shape`, may be as long, as narrow and as far off the start side as the order has it: of these only those
    come that join runs one after the other.
    """
    found = list[Ints]()
    for contours in MOST_CONTOURS:
        for zone in _zones_of(facts, order, contours, any_shape):
            if not any(np.array_equal(zone, other) for other in found):
                found.append(zone)
                yield zone


def _zones_of(facts: Facts, order: Sequence[int], most_contours: int, any_shape: bool) -> Iterator[Ints]:
    """The same where a zone has no more than so many contours, unless they cannot be divided."""
    outlines, options = outlines_of(facts.nest), facts.options
    respected = respected_orders(facts.contains, facts.level_ahead, facts.in_hull, options)
    blocks = blocks_of(facts.nest, outlines, facts.parent, respected, options, np.zeros(facts.n))
    place = np.empty(facts.n, dtype=np.int64)
    place[list(order)] = np.arange(facts.n)
    orders = np.concatenate([respected, locked_pairs(facts.nest, options)])
    kept = orders[place[orders[:, 0]] < place[orders[:, 1]]]  # the others were dropped, as they go round in a circle
    units = units_of(outlines.own_outer, outlines.is_mark, kept, options.parts_in_one_go)
    cut = np.array([k for k in order if not outlines.is_mark[k]], dtype=np.int64)  # marks are made before all
    small = _whole_block_runs(blocks.of, cut)
    bears, count = _bearing(small, cut, units, most_contours)
    too_large = [k for k in range(1, count + 1) if not bears(k - 1, k)]
    if too_large:
        small = _taken_apart(small, np.isin(small, too_large), cut, blocks.of, kept)
        bears, count = _bearing(small, cut, units, most_contours)
    one_by_one = merge_zones_while(bears, small, count)
    if any_shape:
        yield one_by_one
        return
    zones = _by_block(facts.zone, blocks)
    square = options.square_ratio
    most = LESS_SQUARE * _ratio(zones, blocks, square), LESS_TOGETHER * _around_mm2(zones, blocks)
    if _do_what_zones_do(one_by_one, facts, blocks, most):
        yield one_by_one
    found = np.unique([zone[small - 1] for zone in _drawn(small, blocks, facts, bears, most)], axis=0)
    for zone in sorted(found[(found != one_by_one).any(axis=1)], key=lambda zone: int(zone.max())):
        if _do_what_zones_do(zone, facts, blocks, most):
            yield zone


def _bearing(small: Ints, order: Ints, units: Units, most: int) -> tuple[Bears, int]:
    """Whether runs that follow each other may be one zone, and how many runs there are."""
    sizes = np.bincount(small[order] - 1).astype(np.float64)  # joined zones must not pass a number of contours here
    return cache(Bearing(small, units, set_limit(len(small)), sizes, most)), len(sizes)


def _taken_apart(small: Ints, chosen: Bools, order: Ints, block: Ints, before: Ints) -> Ints:
    """The runs `small` (n,) with those `chosen` (n,) by block (n,): each where `_places` says that it lies.

    A block that goes before another by the orders `before` (k, 2) of contours comes no later than it.
    """
    rank = raise_zones(np.unique(_places(order, block), return_inverse=True)[1], block[before])
    apart = np.column_stack([small, np.where(chosen, rank[block], -1)])
    number: Ints = np.unique(apart, axis=0, return_inverse=True)[1].ravel() + 1
    return number


def _places(order: Ints, block: Ints) -> Floats:
    """Where in an order blocks (n,) lie: where their contours do on an average, or in large nests the last of them.

    What lies between two visits of a block is long there, and its middle may be far off on the sheet.
    """
    at = np.arange(len(order), dtype=np.float64)
    if len(order) <= MIDDLES:
        return np.bincount(block[order], at) / np.bincount(block[order])
    last = np.zeros(int(block.max()) + 1)
    np.maximum.at(last, block[order], at)
    return last


def _drawn(small: Ints, blocks: Blocks, facts: Facts, bears: Bears, most: tuple[float, float]) -> Iterator[Ints]:
    """Zones of the runs `small`, (n,) from 1, by the prices of what is asked of zones: the zone of every run.

    `most` are the ratio and the area, mm², that zones may have.
    """
    count = int(small.max(initial=0))
    of_run = [np.unique(blocks.of[small == k + 1]) for k in range(count)]
    runs = _Runs(np.array([_around(blocks.bounds_mm[chosen]) for chosen in of_run]))
    share = np.array([blocks.contours[chosen].sum() for chosen in of_run]) / max(1, blocks.contours.sum())
    up_to = np.append(0.0, np.cumsum(share))
    most_ratio, most_mm2 = most
    for square in SQUARENESS:

        def price(begins: Ints, end: int, square: float = square) -> Floats:
            apart = runs.around_mm2(begins, end) / most_mm2
            narrow: Floats = (up_to[end] - up_to[begins]) * runs.ratio(end) / most_ratio
            return (1 - square) * apart + square * narrow

        yield from divisions(count, price, bears, int(facts.zone.max()))


class _Runs:
    """Pieces of an order, with the bounds of each, (k, 4)."""

    def __init__(self, bounds_mm: Floats) -> None:
        self._bounds_mm = bounds_mm
        behind = bounds_mm[::-1]
        low, high = np.minimum.accumulate(behind[:, :2])[::-1], np.maximum.accumulate(behind[:, 2:])[::-1]
        self._left_mm = np.hstack([low, high])

    def around_mm2(self, begins: Ints, end: int) -> Floats:
        """The areas of the rectangles around the pieces begin + 1 … end, of begins that follow each other up to it."""
        back = self._bounds_mm[begins[0] : end][::-1]
        low, high = np.minimum.accumulate(back[:, :2])[::-1], np.maximum.accumulate(back[:, 2:])[::-1]
        area: Floats = (high - low).prod(axis=1)
        return area

    def ratio(self, end: int) -> float:
        """Long side by short side of the rectangle around the pieces after `end`."""
        return side_ratio(self._left_mm[end : end + 1])


def _around(bounds_mm: Floats) -> Floats:
    """The bounds of some, (4,)."""
    return np.append(bounds_mm[:, :2].min(axis=0), bounds_mm[:, 2:].max(axis=0))


def _whole_block_runs(block: Ints, order: Ints) -> Ints:
    """The shortest runs of an order in which blocks (n,) are whole: the number of each contour's, from 1.

    Of every block there is one contour in the order, at the least.
    """
    last = np.zeros(int(block.max(initial=0)) + 1, dtype=np.int64)
    at = np.arange(len(order))
    np.maximum.at(last, block[order], at)
    ends = np.maximum.accumulate(last[block[order]]) == at
    number = np.empty(len(last), dtype=np.int64)
    number[block[order]] = np.append(0, np.cumsum(ends)[:-1]) + 1
    return number[block]


def _do_what_zones_do(zone: Ints, facts: Facts, blocks: Blocks, most: tuple[float, float]) -> bool:
    found, (most_ratio, most_mm2) = _by_block(zone, blocks), most
    axis, away = AXIS[facts.start_side], AWAY[facts.start_side]
    depth_mm = away * blocks.centroid[:, axis]
    near_mm = depth_mm.min() + (depth_mm.max() - depth_mm.min()) / 2
    return bool(
        _ratio(found, blocks, facts.options.square_ratio) <= most_ratio
        and _around_mm2(found, blocks) <= most_mm2
        and depth_mm[found == 1].mean() <= near_mm
    )


def _by_block(zone: Ints, blocks: Blocks) -> Ints:
    of_block = np.zeros(len(blocks.contours), dtype=np.int64)
    of_block[blocks.of] = zone
    return of_block


def _ratio(zone: Ints, blocks: Blocks, square: float) -> float:
    """Long side by short side of the rectangle around what is left after each zone, on an average over the contours.

    What is left is as good as square up to the ratio `square`.
    """
    sizes = np.bincount(zone, blocks.contours)[1:]
    ratios = [max(square, side_ratio(blocks.bounds_mm[zone > k])) for k in range(1, len(sizes) + 1)]
    return float(np.average(ratios, weights=np.maximum(sizes, 1e-9)))


def _around_mm2(zone: Ints, blocks: Blocks) -> float:
    """The area of the rectangles around all zones: more than that of the sheet, as far as zones reach into others."""
    boxes = (_around(blocks.bounds_mm[zone == k]) for k in range(1, int(zone.max(initial=0)) + 1))
    return sum(float((box[2:] - box[:2]).prod()) for box in boxes)
