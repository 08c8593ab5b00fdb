"""What an order and its entries cost in overheats: fitted to simulations of the same nest.

Heat meets where cuts lie side by side, and a kerf that is already there holds the heat of the next cut back. What
matters most is which near contours are out when a contour is cut, and where it is pierced; the pauses between the cuts
matter little. So the overheats near each contour are taken as a constant, plus a price for every term about its own cut
(see `HeatTerms`). Ridge regression finds the prices contour by contour. Each contour has few terms, so that few
simulations are enough, however large the nest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints

from .terms import HeatTerms

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
            known, asked = fold != k, fold == k
            prices = _fit(terms, rows[known], hot[known], weights[known], penalty)
            middle = weights[known] / weights[known].sum()
            told = middle @ total[known] + (rows[asked] - middle @ rows[known]) @ prices
            wrong += float(weights[asked] @ (total[asked] - told) ** 2)
        return wrong

    return min(PENALTIES, key=error)


def _ridge(rows: Floats, found: Floats, weights: Floats, penalty: float) -> Floats:
    middle = weights / weights.sum()
    centred = rows - middle @ rows
    inner = (centred.T * weights) @ centred + penalty * np.eye(rows.shape[1])
    return np.asarray(np.linalg.solve(inner, (centred.T * weights) @ (found - middle @ found)))
