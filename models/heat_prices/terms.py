"""What of a route may have a price in overheats: orders of near pairs, entries, and what goes with what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.heat_section import Heat

from .near_pairs import near_pairs

MOST_NEAR = 6
"""How many of the nearest contours are looked at two by two, and with entries."""


@dataclass(frozen=True, eq=False, slots=True)
class HeatTerms:
    """Each term holds in a route or does not. They are counted on in this order:

    `pairs` (p, 2): the first contour is cut before the second. Every site, by its number: it is used. `entered` (q, 2):
    a site is used, and this contour is already out. `both` (r, 3): the first and the second are out before the third.
    `around[i]` are the terms that explain the overheats near contour i: those about its own cut.
    """

    pairs: Ints
    site_contour: Ints
    entered: Ints
    both: Ints
    around: tuple[Ints, ...]

    @classmethod
    def of(cls, facts: Facts, problem: Problem, heat: Heat) -> HeatTerms:
        """The terms of near contours."""
        contours, of = facts.nest.contours, problem.site_contour
        pairs = np.column_stack(near_pairs(facts.nest, heat))
        several = np.bincount(of, minlength=facts.n) > 1
        nearest = []
        for contour in range(facts.n):
            mine = np.flatnonzero((pairs == contour).any(axis=1))
            others = pairs[mine].sum(axis=1) - contour
            gaps = shapely.distance(contours[contour].line, [contours[k].line for k in others])
            nearest.append(sorted(others[np.argsort(gaps, kind="stable")[:MOST_NEAR]].tolist()))
        entered = [(s, j) for s, i in enumerate(of.tolist()) if several[i] for j in nearest[i]]
        both = [(a, b, i) for i in range(facts.n) for a, b in combinations(nearest[i], 2)]
        found = (pairs, of, _table(entered, 2), _table(both, 3))
        return cls(*found, _around(facts.n, several, *found))

    def rows(self, routes: Sequence[Sequence[int]]) -> Floats:
        """A row a route (sites): 1 for each term that holds in it."""
        rows = np.zeros((len(routes), sum(map(len, (self.pairs, self.site_contour, self.entered, self.both)))))
        (site, out), (one, other, last) = self.entered.T, self.both.T
        for row, route in zip(rows, routes, strict=True):
            sites = np.asarray(route, dtype=np.int64)
            place = np.empty(len(self.around), dtype=np.int64)
            place[self.site_contour[sites]] = np.arange(len(sites))
            used = np.zeros(len(self.site_contour), dtype=np.bool_)
            used[sites] = True
            row[:] = np.concatenate(
                [
                    place[self.pairs[:, 0]] < place[self.pairs[:, 1]],
                    used,
                    used[site] & (place[out] < place[self.site_contour[site]]),
                    np.maximum(place[one], place[other]) < place[last],
                ]
            )
        return rows

    def split(self, values: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """What belongs to pairs, sites, `entered` and `both`."""
        ends = np.cumsum([len(self.pairs), len(self.site_contour), len(self.entered)])
        pairs, sites, entered, both = np.split(values, ends)
        return pairs, sites, entered, both


def _table(rows: Sequence[tuple[int, ...]], columns: int) -> Ints:
    return np.array(rows, dtype=np.int64).reshape(-1, columns)


def _around(n: int, several: NDArray[np.bool_], pairs: Ints, of: Ints, entered: Ints, both: Ints) -> tuple[Ints, ...]:
    ends = np.cumsum([0, len(pairs), len(of), len(entered)])
    found = []
    for contour in range(n):
        mine = (
            (pairs == contour).any(axis=1),
            (of == contour) & several[contour],
            of[entered[:, 0]] == contour,
            both[:, 2] == contour,
        )
        found.append(np.concatenate([end + np.flatnonzero(k) for end, k in zip(ends, mine, strict=True)]))
    return tuple(found)
