"""Zones: groups of parts cut one group after the other, so that what is left keeps its stiffness.

Petunin 2009, fig. 4: what remains uncut after each zone shall come as close to a square as the sheet allows. Strips
of about `zone_contours` contours are taken off the bounding rectangle of the parts that remain: off the start side
at first and while the rectangle's sides differ by more than `square_ratio`, then off whichever admissible side leaves
it most square. Then zones are raised until no respected order points backwards.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from ..cut import Side
from ..errors import InputError
from ..nest import Nest
from .containment import outermost_of
from .facts import FactOptions, Floats, Ints
from .outlines import ROUNDING_MM, Outlines
from .ranges import laid_out
from .sides import AWAY, AXIS


@dataclass(frozen=True, eq=False, slots=True)
class Blocks:
    """What shares a zone: a part straight on the sheet with everything nested in it.

    `of` (n,) is the block of each contour; `contours` how many it has, `centroid` and `bounds_mm` those of its outer
    contour. Rows (before, after) of `pairs` say which block must not be in a later zone than which.
    """

    of: Ints
    contours: Ints
    centroid: Floats
    bounds_mm: Floats
    pairs: Ints


def zones_of(
    nest: Nest, outlines: Outlines, parent: Ints, start_side: Side, respected: Ints, options: FactOptions
) -> Ints:
    """Array (n,): the zone of each contour, 1…m without holes.

    `respected` (k, 2) are pairs of contours (before, after). A part in `options.zone_fixed` stays where it is put,
    what must go before it is brought forward with it, and closing up empty zones may lower its number. Where two
    fixed parts contradict a pair, the fixed zones stand.

    Raises
    ------
    InputError
        If `zone_pairs` or `zone_fixed` name an unknown contour or part, a zone below 1, or two zones for one part.
    """
    if not outlines.n:
        return np.empty(0, dtype=np.int64)
    tops, of = np.unique(outermost_of(parent), return_inverse=True)
    locked = np.array([[_contour(nest, a), _contour(nest, b)] for a, b in options.zone_pairs], dtype=np.int64)
    before, after = of[np.concatenate([respected, locked.reshape(-1, 2)])].T
    pairs = np.column_stack([before, after])[before != after]
    blocks = Blocks(of, np.bincount(of), outlines.centroid[tops], outlines.bounds_mm[tops], pairs)
    strips = _raised(_strips(blocks, start_side, options), pairs)
    return _closed_up(_with_fixed(_closed_up(strips), pairs, _fixed(nest, of, options)))[of]


def _contour(nest: Nest, contour_id: str) -> int:
    if contour_id not in nest.index:
        raise InputError(f"zone_pairs names contour {contour_id!r}, which the nest does not have")
    return nest.index[contour_id]


def _fixed(nest: Nest, block_of: Ints, options: FactOptions) -> Mapping[int, int]:
    """Block → the zone it is fixed in."""
    fixed: dict[int, int] = {}
    for part_id, zone in options.zone_fixed:
        if part_id not in nest.part_of:
            raise InputError(f"zone_fixed names part {part_id!r}, which the nest does not have")
        if zone < 1:
            raise InputError(f"zone_fixed puts part {part_id!r} in zone {zone}; zones count from 1")
        block = int(block_of[nest.index[nest.part_of[part_id].outer.id]])
        if fixed.setdefault(block, zone) != zone:
            raise InputError(
                f"zone_fixed puts part {part_id!r} in zone {zone} and itself, or a part that shares its zone as its "
                f"host or guest, in zone {fixed[block]}; give them one zone"
            )
    return fixed


def _strips(blocks: Blocks, start_side: Side, options: FactOptions) -> Ints:
    """Zones by geometry alone, 1…m: one strip after the other off the rectangle around what remains."""
    count = len(blocks.contours)
    across: tuple[Side, Side] = ("bottom", "top") if AXIS[start_side] == 0 else ("left", "right")
    sides: tuple[Side, ...] = (start_side, *across)  # the side opposite the start stays to the end
    # Rounded, so that parts on one line keep their order in the nest.
    depth = {s: AWAY[s] * np.round(blocks.centroid[:, AXIS[s]] / ROUNDING_MM) for s in sides}
    order = {s: np.argsort(depth[s], kind="stable") for s in sides}
    before, first = _predecessors(blocks.pairs, count)
    zone, number = np.zeros(count, dtype=np.int64), 0
    while len(remaining := order[start_side][zone[order[start_side]] == 0]):
        square = number > 0 and _side_ratio(blocks.bounds_mm[remaining]) <= options.square_ratio
        choices = []
        for side in sides if square else sides[:1]:
            remaining = order[side][zone[order[side]] == 0]
            strip = _strip(remaining, depth[side], blocks.contours, options.zone_contours)
            if side == start_side or not _must_wait(strip, zone, before, first):
                choices.append((_side_ratio(blocks.bounds_mm[remaining[len(strip) :]]), strip))
        number += 1
        zone[min(choices, key=itemgetter(0))[1]] = number
    return zone


def _strip(order: Ints, place: Floats, contours: Ints, about: int) -> Ints:
    """The first blocks in order with about as many contours as asked; all of them when too few would be left over.

    Of the strips that miss the number by a quarter at most, the one that ends at the widest gap between centroids
    is taken, so that a row or column of parts stays whole; where none does, the one that comes closest.
    """
    if contours[order].sum() < 1.5 * about:
        return order
    first = order[: 2 * about]
    missed = np.abs(np.cumsum(contours[first]) - about)
    gap = np.diff(place[order[: len(first) + 1]], append=np.inf)[: len(first)]
    gap[missed > about / 4] = 0.0
    return order[: int(np.lexsort((missed, -gap))[0]) + 1]


def _side_ratio(bounds_mm: Floats) -> float:
    """Long side by short side of the rectangle around these bounds, 1 for none; rounded, so that equal is equal."""
    if not len(bounds_mm):
        return 1.0
    size = bounds_mm[:, 2:].max(axis=0) - bounds_mm[:, :2].min(axis=0)
    return round(float(size.max() / size.min()), 9)


def _predecessors(pairs: Ints, count: int) -> tuple[Ints, Ints]:
    """Blocks before each block, end to end, and where those of each block begin."""
    by_after = pairs[np.argsort(pairs[:, 1], kind="stable")]
    return by_after[:, 0], np.searchsorted(by_after[:, 1], np.arange(count + 1))


def _must_wait(strip: Ints, zone: Ints, before: Ints, first: Ints) -> bool:
    """Whether something that would remain must go before a block of the strip: then its side is not admissible."""
    ahead = before[laid_out(first[strip], first[strip + 1] - first[strip])]
    remains = zone == 0
    remains[strip] = False
    return bool(remains[ahead].any())


def _raised(zone: Ints, pairs: Ints, kept: Ints | None = None) -> Ints:
    """Raise zones until no pair points backwards; blocks in `kept` stay where they are."""
    while True:
        raised = zone.copy()
        np.maximum.at(raised, pairs[:, 1], zone[pairs[:, 0]])
        if kept is not None:
            raised[kept] = zone[kept]
        if np.array_equal(raised, zone):
            return zone
        zone = raised


def _with_fixed(zone: Ints, pairs: Ints, fixed: Mapping[int, int]) -> Ints:
    """Put the fixed blocks in their zones, bring forward what must go before them, raise what must go after."""
    if not fixed:
        return zone
    kept = np.array(list(fixed), dtype=np.int64)
    zone = zone.copy()
    zone[kept] = list(fixed.values())
    # Seen from the end, lowering a zone is raising its negative along the pairs turned round.
    latest = np.full(len(zone), np.iinfo(np.int64).max)
    latest[kept] = zone[kept]
    latest = -_raised(-latest, pairs[:, ::-1])
    movable = np.setdiff1d(np.arange(len(zone)), kept)
    zone[movable] = np.minimum(zone, latest)[movable]
    return _raised(zone, pairs, kept)


def _closed_up(zone: Ints) -> Ints:
    """The same order of zones numbered 1…m without holes."""
    numbers: Ints = np.unique(zone, return_inverse=True)[1] + 1
    return numbers
