"""Zones by geometry alone: one strip after the other off the rectangle around the parts that remain.

Thin strips have few parts, far apart. So wide ones may be taken instead, and divided along their length into pieces
that are about square. Those are cut one after the other, from the end where the strip before ended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Side
from kerfwise.encoder.ranges import laid_out

from .facts import SIDES, FactOptions
from .outlines import ROUNDING_MM, SAME_SHARE
from .sides import AWAY, AXIS
from .zone_blocks import Blocks
from .zone_heat import fitting

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
            ahead = before[laid_out(first[strip], first[strip + 1] - first[strip])]
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
