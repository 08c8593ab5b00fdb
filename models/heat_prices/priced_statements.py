"""Prices of heat as soft statements, which every engine reads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About, AtLeast, Before, Forbid, Precede

from .prices import HeatPrices

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
