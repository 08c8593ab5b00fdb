"""Which points of a contour to offer as entries: corners first, then middles of edges, well apart."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays

from .joints import Outline

CORNER_RAD = math.radians(30)
"""A contour that turns by no more has no corner there."""
TIED_MM, TIED_RAD = 1e-6, 1e-9
"""What differs by less is equal: where a drawing lies on the sheet must not tell which entry is better."""

CORNER, MIDDLE, ANYWHERE = 0, 1, 2
Ranks = NDArray[np.int64]


def places(outlines: Sequence[Outline], count: int) -> tuple[Floats, Ranks, Ints]:
    """Path lengths along contours that could be entries, the rank of each, and the number of its outline, ascending.

    Corners that stick out into the waste, where a scar matters least, rank before the middles of straight edges, and
    those before `4 * count` points spread evenly.
    """
    if not outlines:
        return np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int64)
    drawn = SegmentArrays.joined([outline.drawn for outline in outlines])
    each, around_mm = np.arange(len(outlines)), drawn.lengths_mm
    of = np.repeat(each, np.diff(drawn.first))
    k = np.arange(len(drawn)) + of
    right = np.array([outline.right for outline in outlines])[of]
    corners = np.flatnonzero(drawn.turn_rad * right > CORNER_RAD + TIED_RAD)
    length_mm = drawn.starts_mm[k + 1] - drawn.starts_mm[k]
    edges = np.flatnonzero((drawn.bulge == 0) & (length_mm > around_mm[of] / (8 * count) + TIED_MM))
    groups = [
        drawn.starts_mm[k[corners] + 1] % around_mm[of[corners]],
        drawn.starts_mm[k[edges]] + length_mm[edges] / 2,
        (around_mm[:, None] * (np.arange(4 * count) + 0.5) / (4 * count)).ravel(),
    ]
    whose = np.concatenate([of[corners], of[edges], np.repeat(each, 4 * count)])
    order = np.argsort(whose, kind="stable")
    ranks = np.repeat([CORNER, MIDDLE, ANYWHERE], [len(g) for g in groups])
    return np.concatenate(groups)[order], ranks[order], whose[order]


def choose(at_mm: Floats, ranks: Ranks, around_mm: float, count: int, taken_mm: Floats) -> list[int]:
    """See `choose_each`, of one contour, as many as it can have.

    Examples
    --------
    >>> choose(np.array([0.0, 1.0, 50.0, 55.0]), np.array([0, 0, 1, 2]), 100.0, 3, np.zeros(0))
    [0, 2]
    """
    one, both = np.zeros(len(at_mm), np.int64), np.zeros(len(taken_mm), np.int64)
    found = choose_each(at_mm, ranks, one, np.array([around_mm]), count, np.array([count]), taken_mm, both)
    return [int(k) for k in found]


def choose_each(
    at_mm: Floats,
    ranks: Ranks,
    of: Ints,
    around_mm: Floats,
    count: int,
    wanting: Ints,
    taken_mm: Floats,
    taken_of: Ints,
) -> Ints:
    """Places on contours, for each up to as many as it is `wanting` of `count`, contour after contour.

    Best rank first and each as far as can be from those before it and those taken. Places no farther than a quarter of
    an even share of the way round from another are passed over; of places that are equally far, the first is taken.
    `of`, ascending, numbers the contour of each place, of `taken_of` that of those that are taken; `around_mm` is the
    way round each contour. All contours are gone through at a time, a place each.
    """
    apart_mm = np.full(len(at_mm), np.inf)
    order = np.argsort(taken_of, kind="stable")
    first, last = (np.searchsorted(taken_of[order], of, side) for side in ("left", "right"))
    while len(more := np.flatnonzero(first < last)):
        place_mm = taken_mm[order[first[more]]]
        apart_mm[more] = np.minimum(apart_mm[more], shorter_way_mm(at_mm[more], place_mm, around_mm[of[more]]))
        first[more] += 1
    least_mm = around_mm / (4 * count) + TIED_MM
    rank, left = np.zeros(len(around_mm), np.int64), wanting.copy()
    chosen = [np.zeros(0, np.int64)]
    rows = np.flatnonzero(left[of] > 0)
    while len(rows):
        best = rows[ranks[rows] == rank[of[rows]]]
        begins = np.flatnonzero(np.diff(of[best], prepend=-1))
        farthest_mm = np.full(len(around_mm), -np.inf)
        if len(begins):
            farthest_mm[of[best[begins]]] = np.maximum.reduceat(apart_mm[best], begins)
        found = farthest_mm > least_mm
        best = best[found[of[best]] & (apart_mm[best] >= farthest_mm[of[best]] - TIED_MM)]
        best = best[np.diff(of[best], prepend=-1) > 0]
        chosen.append(best)
        place_mm = np.zeros(len(around_mm))
        place_mm[of[best]] = at_mm[best]
        near = rows[found[of[rows]]]
        way_mm = shorter_way_mm(at_mm[near], place_mm[of[near]], around_mm[of[near]])
        apart_mm[near] = np.minimum(apart_mm[near], way_mm)
        left[found] -= 1
        rank[~found] += 1
        rows = rows[(left[of[rows]] > 0) & (rank[of[rows]] <= ANYWHERE)]
    every = np.concatenate(chosen)
    return every[np.argsort(of[every], kind="stable")]


def shorter_way_mm(at_mm: Floats, place_mm: Floats | float, around_mm: Floats | float) -> Floats:
    """Shorter way round from a place to others."""
    ahead_mm = np.abs(at_mm - place_mm) % around_mm
    return np.minimum(ahead_mm, around_mm - ahead_mm)
