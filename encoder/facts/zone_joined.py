"""Zones that follow each other made one, as long as the sets of contours that may be out in it are few enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kerfwise.arrays import Floats, Ints

from .zone_borders import Bears
from .zone_sets import Units, sets_within


def joined(zone: Ints, units: Units, most_sets: float, heat_kj: Floats, budget_kj: float | None = None) -> Ints:
    """The zones 1…m of contours (n,) after as many of those that follow each other are made one as have so few sets.

    No more than a budget of heat, or of whatever else adds up, is joined; `heat_kj` (m,) is that of every zone. Zones
    that have too much of either stay as they are.

    Examples
    --------
    Two parts in one go, each a zone of its own, are one zone of four sets.

    >>> two = Units(np.array([0, 1]), np.array([0, 0]), np.empty((0, 2), dtype=np.int64))
    >>> joined(np.array([1, 2]), two, 4.0, np.zeros(2)), joined(np.array([1, 2]), two, 3.0, np.zeros(2))
    (array([1, 1]), array([1, 2]))
    """
    return joined_while(Bearing(zone, units, most_sets, heat_kj, budget_kj), zone, len(heat_kj))


def joined_while(bears: Bears, zone: Ints, count: int) -> Ints:
    """The zones 1…count of contours (n,) after those that follow each other are made one while the answer is yes."""
    number = np.ones(count + 1, dtype=np.int64)
    begin = 0
    for end in range(2, count + 1):
        if not bears(begin, end):
            begin = end - 1
        number[end] = number[end - 1] + (begin == end - 1)
    return number[zone]


class Bearing:
    """Whether zones that follow each other may be one, as `joined` makes them."""

    def __init__(
        self, zone: Ints, units: Units, most_sets: float, heat_kj: Floats, budget_kj: float | None = None
    ) -> None:
        cut = units.of >= 0
        of_unit = np.zeros(len(units.inner), dtype=np.int64)
        of_unit[units.of[cut]] = zone[cut]
        self._by_zone = np.argsort(of_unit, kind="stable")
        ends = np.arange(1, len(heat_kj) + 2)
        self._first = np.searchsorted(of_unit[self._by_zone], ends)
        self._pairs = units.pairs[np.argsort(of_unit[units.pairs[:, 0]], kind="stable")]
        self._pairs_from = np.searchsorted(of_unit[self._pairs[:, 0]], ends)
        self._units, self._most_sets = units, most_sets
        self._heat_kj, self._most_kj = heat_kj, np.inf if budget_kj is None else budget_kj

    def __call__(self, begin: int, end: int) -> bool:
        """Whether the zones begin + 1 … end may be one."""
        if float(self._heat_kj[begin:end].sum()) > self._most_kj:
            return False
        within = replace(self._units, pairs=self._pairs[self._pairs_from[begin] : self._pairs_from[end]])
        members = self._by_zone[self._first[begin] : self._first[end]]
        return sets_within(members, within, self._most_sets) <= self._most_sets
