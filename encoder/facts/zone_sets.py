"""How many sets of contours can be out while a zone is cut: what a proof of its best order has to go through.

The sets that orders allow are the ideals of a partial order, those of several unrelated parts of it a product. A
state's further burden, its last site, is left out: it is about the same for every zone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.components import strong_components, weak_components
from kerfwise.encoder.distinct import distinct, distinct_pairs

KEPT = 1 << 12
"""Answers about orders that are kept."""
MOST_UNITS = 63
"""Units in a zone that a machine word holds one bit each."""
Masks = NDArray[np.uint64]


@dataclass(frozen=True, eq=False, slots=True)
class Units:
    """What is cut without another between: a part with its holes, or a contour where parts are not cut in one go.

    `of` (n,) is the unit of each contour, -1 for marks; `inner` (units,) how many contours go before its last in any
    order; `pairs` (k, 2) say which unit is cut before which.
    """

    of: Ints
    inner: Ints
    pairs: Ints


def units_of(part: Ints, is_mark: Bools, pairs: Ints, in_one_go: bool) -> Units:
    """The units of contours of parts (n,), with `pairs` (k, 2) of contours (before, after)."""
    of = np.full(len(part), -1, dtype=np.int64)
    cut = ~is_mark
    of[cut] = np.unique(part[cut], return_inverse=True)[1] if in_one_go else np.arange(int(cut.sum()))
    ordered = of[pairs]
    ordered = distinct_pairs(ordered[(ordered >= 0).all(axis=1)])
    circle = strong_components(int(of.max(initial=-1)) + 1, ordered)  # orders that go round in one are no orders
    inner = np.bincount(of[cut]) - 1
    return Units(of, inner, ordered[circle[ordered[:, 0]] != circle[ordered[:, 1]]])


def sets_within(members: Ints, units: Units, most: float) -> float:
    """The sets that can be out while these units are cut, infinite if there are more than `most`.

    Examples
    --------
    Of two parts without an order each may be out alone; a hole more makes one set more before and after the other.

    >>> two = units_of(np.array([0, 1]), np.array([False, False]), np.empty((0, 2), dtype=np.int64), True)
    >>> sets_within(np.array([0, 1]), two, 100.0)
    4.0
    >>> holed = units_of(np.array([0, 0, 1]), np.zeros(3, dtype=bool), np.empty((0, 2), dtype=np.int64), True)
    >>> sets_within(np.array([0, 1]), holed, 100.0)
    6.0
    """
    number = np.full(len(units.inner), -1, dtype=np.int64)
    number[members] = np.arange(len(members))
    pairs = number[units.pairs]
    pairs = pairs[(pairs >= 0).all(axis=1)]
    part = weak_components(len(members), pairs)
    whole, begun = 1.0, 0.0  # sets of whole units, and those in which one more is begun
    with np.errstate(over="ignore"):
        half_done: Floats = np.exp2(units.inner[members].astype(np.float64)) - 1
    for k in range(int(part.max(initial=-1)) + 1):
        own = np.flatnonzero(part == k)
        place = np.full(len(members), -1, dtype=np.int64)
        place[own] = np.arange(len(own))
        if len(own) > MOST_UNITS:
            return float("inf")
        within = place[pairs[part[pairs[:, 0]] == k]]
        ideals, started = _ideals(len(own), within.tobytes(), half_done[own].tobytes(), most)
        if ideals + started > most:
            return float("inf")
        whole, begun = whole * ideals, whole * started + begun * ideals
        if whole + begun > most:
            return float("inf")
    return whole + begun


@lru_cache(maxsize=KEPT)
def _ideals(size: int, within: bytes, begun: bytes, most: float) -> tuple[float, float]:
    """Sets that have with every unit all that comes before it, and such with one more unit begun; both may end early,
    over `most`.

    Given are the bytes of the pairs (k, 2) of units and of what a unit adds that is begun, (size,). Zones grow piece
    by piece, so that the same is asked again and again.
    """
    pairs, half_done = np.frombuffer(within, dtype=np.int64).reshape(-1, 2), np.frombuffer(begun)
    bit = np.uint64(1) << np.arange(size, dtype=np.uint64)
    needs = np.zeros(size, dtype=np.uint64)
    np.bitwise_or.at(needs, pairs[:, 1], bit[pairs[:, 0]])
    layer: Masks = np.zeros(1, dtype=np.uint64)
    ideals, started = 0.0, 0.0
    while len(layer) and ideals + started <= most:
        ideals += len(layer)
        grown = []
        for k in range(size):
            next_ = layer[((layer & needs[k]) == needs[k]) & ((layer & bit[k]) == 0)]
            started += len(next_) * float(half_done[k])
            grown.append(next_ | bit[k])
        layer = distinct(np.concatenate(grown))
    return ideals, started
