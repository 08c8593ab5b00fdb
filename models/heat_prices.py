"""Prices of overheats: what orders and entries cost, fitted to simulations, as soft statements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat.timed_path import hot_contours
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.rules.statements import About, AtLeast, Before, Forbid, Precede

# What an order and its entries cost in overheats: fitted to simulations of the same nest.
#
# Heat meets where cuts lie side by side, and a kerf that is already there holds the heat of the next cut back. What
# matters most is which near contours are out when a contour is cut, and where it is pierced; the pauses between the
# cuts matter little. So the overheats near each contour are taken as a constant, plus a price for every term about
# its own cut (see `HeatTerms`). Ridge regression finds the prices contour by contour. Each contour has few terms, so
# that few simulations are enough, however large the nest.

PENALTIES = (1.0, 3.0, 10.0, 30.0, 100.0)
FOLDS = 5


@dataclass(frozen=True, eq=False, slots=True)
class HeatPrices:
    """What each term makes more (or fewer), in overheats."""

    terms: HeatTerms
    overheats: Floats

    def of(self, route: Sequence[int]) -> float:
        """What a route (sites) is expected to have, up to a constant that is the same for all routes."""
        return float(self.terms.rows([route])[0] @ self.overheats)

    def of_entries(self) -> tuple[Floats, Floats]:
        """What each site costs, (m,), and how much more for each contour that is already out, (m, n)."""
        terms = self.terms
        _, sites, entered, _ = terms.split(self.overheats)
        more = np.zeros((len(sites), len(terms.around)))
        more[terms.entered[:, 0], terms.entered[:, 1]] = entered
        return sites, more


def fit_prices(terms: HeatTerms, routes: Sequence[Sequence[int]], hot: Floats | Ints, weights: Floats) -> HeatPrices:
    """Prices that explain best what was hot on these routes (sites).

    Parameters
    ----------
    terms
        What may have a price.
    routes
        k lawful routes.
    hot
        Overheats near each contour, (k, n).
    weights
        How much each route counts, (k,).
    """
    rows, found = terms.rows(routes), np.asarray(hot, dtype=np.float64)
    penalty = _best_penalty(terms, rows, found, weights)
    return HeatPrices(terms, _fit(terms, rows, found, weights, penalty))


def _fit(terms: HeatTerms, rows: Floats, hot: Floats, weights: Floats, penalty: float) -> Floats:
    prices = np.zeros(rows.shape[1])
    for contour, columns in enumerate(terms.around):
        if len(columns) and hot[:, contour].any():
            prices[columns] += _ridge(rows[:, columns], hot[:, contour], weights, penalty)
    return prices


def _best_penalty(terms: HeatTerms, rows: Floats, hot: Floats, weights: Floats) -> float:
    """The penalty that predicts routes best that the fit has not seen (cross-validation)."""
    if len(rows) < 2 * FOLDS:
        return PENALTIES[-1]
    fold = np.arange(len(rows)) % FOLDS
    total = hot.sum(axis=1)

    def error(penalty: float) -> float:
        wrong = 0.0
        for k in range(FOLDS):
            known, held_out = fold != k, fold == k
            prices = _fit(terms, rows[known], hot[known], weights[known], penalty)
            middle = weights[known] / weights[known].sum()
            residual = middle @ total[known] + (rows[held_out] - middle @ rows[known]) @ prices
            wrong += float(weights[held_out] @ (total[held_out] - residual) ** 2)
        return wrong

    return min(PENALTIES, key=error)


def _ridge(rows: Floats, found: Floats, weights: Floats, penalty: float) -> Floats:
    middle = weights / weights.sum()
    centred = rows - middle @ rows
    inner = (centred.T * weights) @ centred + penalty * np.eye(rows.shape[1])
    return np.asarray(np.linalg.solve(inner, (centred.T * weights) @ (found - middle @ found)))


# What of a route may have a price in overheats: orders of near pairs, entries, and what goes with what.

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


# Which contours heat each other: those are the pairs whose order has a price in overheats.

NEAR_BANDS = 6.0
"""Contours nearer than so many bands of the kerf heat each other."""


def near_pairs(nest: Nest, heat: Heat) -> tuple[Ints, Ints]:
    """Contours that heat each other, each pair once; marks heat nothing."""
    hot = hot_contours(nest)
    if not len(hot):
        return hot, hot
    lines = [nest.contours[k].line for k in hot]
    within_mm = NEAR_BANDS * max(heat.kerf_band_mm, heat.grid_mm)
    a, b = shapely.STRtree(lines).query(lines, "dwithin", distance=within_mm)
    pairs = np.unique(np.column_stack([a, b])[a < b], axis=0)
    return hot[pairs[:, 0]], hot[pairs[:, 1]]


# Prices of heat as soft statements, which every engine reads.

PricedStatement = Precede | Forbid | AtLeast

HEAT = "objective.heat"
"""What prices of heat are told by, in place of a rule."""
LEAST = 0.1
"""Prices under so many overheats are noise."""


def priced_statements(
    facts: Facts, problem: Problem, prices: HeatPrices, price_mm: float
) -> tuple[PricedStatement, ...]:
    """The prices where an overheat costs `price_mm` of idle travel.

    A term that saves overheats is the same as a cost where it does not hold: only a constant differs.
    """
    return tuple(_Speaker(facts, problem, prices, price_mm).all())


class _Speaker:
    def __init__(self, facts: Facts, problem: Problem, prices: HeatPrices, price_mm: float) -> None:
        self._facts, self._problem = facts, problem
        self._names = [contour.id for contour in facts.nest.contours]
        self._terms, self._price_mm = prices.terms, price_mm
        self._values = prices.terms.split(prices.overheats)
        self._candidates: list[list[int]] = [[] for _ in range(problem.m)]
        for candidate, site in enumerate(problem.candidate_site.tolist()):
            if site >= 0:
                self._candidates[site].append(candidate)

    def all(self) -> Iterator[PricedStatement]:
        yield from self._pairs()
        yield from self._entries()
        yield from self._both()

    def _about(self, contours: tuple[int, ...], sentence: str, more: float, where: str = "") -> About:
        names = tuple(self._names[k] for k in contours)
        return About(HEAT, names, f"{sentence.format(*names)}{where}, or {abs(more):.2g} more points overheat")

    def _at(self, site: int) -> str:
        candidate = self._facts.candidates[int(self._problem.site_candidate[site])]
        x, y = candidate.entry
        return f" at ({x:.1f}, {y:.1f}) {candidate.direction}"

    def _pairs(self) -> Iterator[Precede]:
        for (i, j), more in zip(self._terms.pairs.tolist(), self._values[0].tolist(), strict=True):
            if abs(more) >= LEAST:
                pair = (j, i) if more > 0 else (i, j)
                yield Precede(*pair, self._about(pair, "{} is cut before {}", more), abs(more) * self._price_mm)

    def _entries(self) -> Iterator[Forbid | AtLeast]:
        terms, (_, sites, entered, _) = self._terms, self._values
        costs = sites.copy()
        for (site, out), more in zip(terms.entered.tolist(), entered.tolist(), strict=True):
            if abs(more) < LEAST:
                continue
            costs[site] += min(more, 0.0)
            mine = int(terms.site_contour[site])
            pair = (mine, out) if more > 0 else (out, mine)
            about = self._about(
                pair, "{} is cut before {}", more, f" where {self._names[mine]} is entered{self._at(site)}"
            )
            for candidate in self._candidates[site]:
                yield AtLeast(
                    (Before(*pair),), (1,), 1, about, when=candidate, weight=abs(more) * self._price_mm
                )  # fmt: skip
        for site, more in enumerate(_above_least(costs, terms.site_contour).tolist()):
            if more >= LEAST:
                about = self._about(
                    (int(terms.site_contour[site]),), "{} is entered elsewhere than", more, self._at(site)
                )
                for candidate in self._candidates[site]:
                    yield Forbid(candidate, about, more * self._price_mm)

    def _both(self) -> Iterator[AtLeast]:
        for (a, b, last), more in zip(self._terms.both.tolist(), self._values[3].tolist(), strict=True):
            if abs(more) < LEAST:
                continue
            weight = abs(more) * self._price_mm
            if more > 0:
                about = self._about((last, a, b), "{} is cut before {} or {}", more)
                yield AtLeast((Before(last, a), Before(last, b)), (1, 1), 1, about, weight=weight)
            else:
                about = self._about((a, b, last), "{} and {} are cut before {}", more)
                yield AtLeast((Before(a, last), Before(b, last)), (1, 1), 2, about, weight=weight)


def _above_least(costs: NDArray[np.float64], of: NDArray[np.int64]) -> NDArray[np.float64]:
    """What each site costs more than the cheapest of its contour."""
    least = np.full(int(of.max(initial=-1)) + 1, np.inf)
    np.minimum.at(least, of, costs)
    return np.asarray(costs - least[of])
