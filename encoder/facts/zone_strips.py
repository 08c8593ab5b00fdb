"""Zones by geometry alone: strips off the rectangle of what remains, divided again where they take up too much heat."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints, concat_ranges
from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.graphs import strong_components
from kerfwise.encoder.nest import Nest

from .facts import SIDES, FactOptions
from .outlines import AWAY, AXIS, ROUNDING_MM, SAME_SHARE, Outlines
from .relations import outermost_of

# Zones by geometry alone: one strip after the other off the rectangle around the parts that remain.
#
# Thin strips have few parts, far apart. So wide ones may be taken instead, and divided along their length into pieces
# that are about square. Those are cut one after the other, from the end where the strip before ended.

_GAP_MM = 2 * ROUNDING_MM
"""Gaps between two lines of parts that differ by less are equal: either line may be off by rounding."""


def strips_of(blocks: Blocks, start_side: Side, options: FactOptions, size: int, in_pieces: bool = False) -> list[Ints]:
    """The blocks of each strip of about `size` contours, those at the side that it comes off first.

    Or of each of the pieces of so many contours that wide strips are divided into, those that come first along it.
    """
    count = len(blocks.contours)
    across: tuple[Side, Side] = ("bottom", "top") if AXIS[start_side] == 0 else ("left", "right")
    sides: tuple[Side, ...] = (start_side, *across)  # the side opposite the start stays to the end
    depth = {s: _in_lines(AWAY[s] * blocks.centroid[:, AXIS[s]]) for s in SIDES}
    order = {s: np.argsort(depth[s], kind="stable") for s in sides}
    before, first = _predecessors(blocks.pairs, count)
    strips, left = list[Ints](), np.ones(count, dtype=np.bool_)
    while left.any():
        square = bool(strips) and side_ratio(blocks.bounds_mm[left]) <= options.square_ratio * (1 + SAME_SHARE)
        choices = []
        for side in sides if square else sides[:1]:
            about = size * (_pieces_along(side, blocks, left, size) if in_pieces else 1)
            remaining = order[side][left[order[side]]]
            strip = _strip(remaining, depth[side], blocks, options.zone_heat_kj, about)
            remains = left.copy()
            remains[strip] = False
            ahead = before[concat_ranges(first[strip], first[strip + 1] - first[strip])]
            # A side is not admissible where something that would remain must go before a block of the strip.
            if side == start_side or not remains[ahead].any():
                choices.append((side_ratio(blocks.bounds_mm[remains]), strip, side))
        squarest = min(ratio for ratio, _, _ in choices)
        strip, side = next((strip, side) for ratio, strip, side in choices if ratio <= squarest * (1 + SAME_SHARE))
        left[strip] = False
        strips += _divided(strip, side, strips[-1:], depth, blocks, size) if in_pieces else [strip]
    return strips


def _pieces_along(side: Side, blocks: Blocks, left: Bools, size: int) -> int:
    """How many square pieces of so many contours fit along a strip off this side of what is left."""
    box_mm = blocks.bounds_mm[left, 2:].max(axis=0) - blocks.bounds_mm[left, :2].min(axis=0)
    piece_mm = float(np.sqrt(box_mm.prod() * size / max(1, int(blocks.contours[left].sum()))))
    return max(1, round(float(box_mm[1 - AXIS[side]]) / piece_mm))


def _divided(
    strip: Ints, side: Side, last: Sequence[Ints], depth: Mapping[Side, Floats], blocks: Blocks, size: int
) -> list[Ints]:
    """A strip off a side in pieces along its length, from the end that is nearest to the piece cut `last`."""
    axis = 1 - AXIS[side]
    low, high = (s for s in SIDES if AXIS[s] == axis)
    along = blocks.centroid[strip, axis]
    from_low = True
    if last:
        came_mm = float(blocks.centroid[last[0], axis].mean())
        from_low = abs(came_mm - float(along.min())) <= abs(came_mm - float(along.max())) + ROUNDING_MM
    place = depth[low if from_low else high]
    remaining, pieces = strip[np.argsort(place[strip], kind="stable")], list[Ints]()
    while len(remaining):
        pieces.append(_strip(remaining, place, blocks, None, size))
        remaining = remaining[len(pieces[-1]) :]
    return pieces


def _in_lines(depth_mm: Floats) -> Floats:
    """The depths, those that follow each other within rounding made equal: parts on one line keep their order.

    Examples
    --------
    >>> _in_lines(np.array([7.0, 1 / 3, 7.0 + 1e-9])).tolist()
    [7.0, 0.3333333333333333, 7.0]
    """
    by_depth = np.argsort(depth_mm, kind="stable")
    ranked = depth_mm[by_depth]
    new = np.diff(ranked, prepend=-np.inf) > ROUNDING_MM
    in_lines = np.empty_like(ranked)
    in_lines[by_depth] = ranked[new][np.cumsum(new) - 1]
    return in_lines


def _strip(order: Ints, place: Floats, blocks: Blocks, budget_kj: float | None, about: int) -> Ints:
    """The first blocks in order with about as many contours as asked; all of them when too few would be left over.

    It ends before its heat passes the budget. Of the strips that miss the number by a quarter at most (fewer, where the
    budget leaves room for fewer), the one that ends at the widest gap between centroids is taken, so that a row or
    column of parts stays whole; where none does, the one that comes closest. Of gaps that are equal, all but rounding,
    the one is taken that comes closest to the number, then the first.
    """
    room = len(order) if budget_kj is None else fitting(blocks.heat_kj[order], budget_kj)
    if room == len(order) and blocks.contours[order].sum() < 1.5 * about:
        return order
    first = order[: min(2 * about, room)]
    so_far = np.cumsum(blocks.contours[first])
    wanted = min(about, int(so_far[-1]))
    missed = np.abs(so_far - wanted)
    gap = np.diff(place[order[: len(first) + 1]], append=np.inf)[: len(first)]
    gap[missed > wanted / 4] = 0.0
    widest = np.flatnonzero(gap >= gap.max() - _GAP_MM)
    return order[: int(widest[missed[widest].argmin()]) + 1]


def side_ratio(bounds_mm: Floats) -> float:
    """Long side by short side of the rectangle around these bounds, 1 for none."""
    if not len(bounds_mm):
        return 1.0
    size = bounds_mm[:, 2:].max(axis=0) - bounds_mm[:, :2].min(axis=0)
    return float(size.max() / size.min())


def _predecessors(pairs: Ints, count: int) -> tuple[Ints, Ints]:
    """Blocks before each block, end to end, and where those of each block begin."""
    by_after = pairs[np.argsort(pairs[:, 1], kind="stable")]
    return by_after[:, 0], np.searchsorted(by_after[:, 1], np.arange(count + 1))


@dataclass(frozen=True, eq=False, slots=True)
class Blocks:
    """What shares a zone: a part straight on the sheet with everything nested in it.

    `of` (n,) is the block of each contour; `contours` how many it has that are cut through (marks are not), `heat_kj`
    what cutting them leaves in the sheet (0 where nobody knows), `centroid` and `bounds_mm` those of its outer
    contour. Rows (before, after) of `pairs` say which block must not be in a later zone than which.
    """

    of: Ints
    contours: Ints
    heat_kj: Floats
    centroid: Floats
    bounds_mm: Floats
    pairs: Ints


def blocks_of(
    nest: Nest, outlines: Outlines, parent: Ints, respected: Ints, options: FactOptions, heat_kj: Floats
) -> Blocks:
    """The blocks of a nest; `respected` (k, 2) are pairs of contours, (n,) `heat_kj` may be nan.

    Raises InputError if `zone_pairs` name an unknown contour.
    """
    tops, of = np.unique(outermost_of(parent), return_inverse=True)
    before, after = of[np.concatenate([respected, locked_pairs(nest, options)])].T
    return Blocks(
        of,
        np.bincount(of[~outlines.is_mark], minlength=len(tops)),
        np.bincount(of, np.nan_to_num(heat_kj)).astype(np.float64),
        outlines.centroid[tops],
        outlines.bounds_mm[tops],
        np.column_stack([before, after])[before != after],
    )


def locked_pairs(nest: Nest, options: FactOptions) -> Ints:
    """The pairs (before, after) of contours that `zone_pairs` name, (k, 2).

    Raises InputError if they name an unknown contour.
    """
    pairs = [[_contour(nest, a), _contour(nest, b)] for a, b in options.zone_pairs]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _contour(nest: Nest, contour_id: str) -> int:
    if contour_id not in nest.index:
        raise InputError(f"zone_pairs names contour {contour_id!r}, which the nest does not have")
    return nest.index[contour_id]


# A zone's budget of heat: zones that take up more are divided once more, in an order that the rules allow.
#
# Strips already end before their heat passes the budget (see `zone_strips`), but orders may raise parts from one zone
# into another. Only what cannot be divided, a part with everything nested in it, may then pass the budget, alone.

_ROUNDING = 1e-9


def fitting(heat_kj: Floats, budget_kj: float) -> int:
    """How many of the first, at least one, stay within the budget together.

    Examples
    --------
    >>> fitting(np.array([2.0, 3.0, 1.0]), 5.0), fitting(np.array([9.0, 1.0]), 5.0)
    (2, 1)
    """
    return max(1, int(np.searchsorted(np.cumsum(heat_kj), budget_kj * (1 + _ROUNDING), side="right")))


def divide_zone(zone: Ints, rank: Ints, blocks: Blocks, budget_kj: float) -> Ints:
    """Zones of blocks, (k,), where none takes up more than the budget but with a single block.

    Those over it are taken apart in the order of `rank`, (k,), as far as `pairs` let it. Blocks that pairs hold
    together, because they go round in a circle, stay together where the budget has room for them.
    """
    heat_kj = np.bincount(zone, blocks.heat_kj)
    share = np.zeros(len(zone), dtype=np.int64)
    for over in np.flatnonzero(heat_kj > budget_kj * (1 + _ROUNDING)).tolist():
        number, spent_kj = -1, np.inf
        for unit in _in_turn(np.flatnonzero(zone == over), rank, blocks, budget_kj):
            more_kj = float(blocks.heat_kj[unit].sum())
            if spent_kj + more_kj > budget_kj * (1 + _ROUNDING):
                number, spent_kj = number + 1, 0.0
            share[unit] = number
            spent_kj += more_kj
    return zone * (int(share.max(initial=0)) + 1) + share


def _in_turn(members: Ints, rank: Ints, blocks: Blocks, budget_kj: float) -> list[Ints]:
    """Blocks of one zone as units that may be cut one after the other: a block, or some that must stay together."""
    number = np.full(len(rank), -1, dtype=np.int64)
    number[members] = np.arange(len(members))
    within = number[blocks.pairs]
    within = np.unique(within[(within >= 0).all(axis=1)], axis=0)
    unit = strong_components(len(members), within)
    too_hot = np.bincount(unit, blocks.heat_kj[members]) > budget_kj * (1 + _ROUNDING)
    alone = np.flatnonzero(too_hot[unit])  # a circle that is too hot is broken: its blocks go one by one
    within = within[~((unit[within[:, 0]] == unit[within[:, 1]]) & too_hot[unit[within[:, 0]]])]
    unit[alone] = len(members) + np.arange(len(alone))
    names, unit = np.unique(unit, return_inverse=True)
    in_rank = np.argsort(rank[members], kind="stable")
    held = [in_rank[unit[in_rank] == k] for k in range(len(names))]
    return [members[held[k]] for k in _topological(unit[within], rank[members][[of[0] for of in held]])]


def _topological(pairs: Ints, rank: Ints) -> list[int]:
    """Units so that no pair (before, after) points backwards, of several that may come next the lowest in rank."""
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    waits = np.bincount(pairs[:, 1], minlength=len(rank))
    following: list[list[int]] = [[] for _ in rank]
    for before, after in pairs.tolist():
        following[before].append(after)
    ready = [(int(rank[k]), k) for k in np.flatnonzero(waits == 0).tolist()]
    heapify(ready)
    order = []
    while ready:
        _, k = heappop(ready)
        order.append(k)
        for after in following[k]:
            waits[after] -= 1
            if waits[after] == 0:
                heappush(ready, (int(rank[after]), after))
    return order
