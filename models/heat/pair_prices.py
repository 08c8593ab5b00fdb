"""What it costs in overheats that one contour is cut before another: fitted to simulations of random lawful orders.

Heat meets where cuts lie side by side, and a kerf that is already there holds the heat of the next cut back. Which
contour of a pair comes first says most of it, the pause between them little; so the number of overheats of an order
is taken as a constant plus a price for every near pair that stands in one order rather than the other. The prices are
fitted to simulations of the very nest by ridge regression.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from ...encoder.nest import Nest
from ...rules.heat_section import Heat
from ...rules.statements import About, Precede

Floats = NDArray[np.float64]

HEAT = "objective.heat"
"""What these prices are told by, in place of a rule."""

ORDERS = 240
"""Random orders that the prices are fitted to."""
PENALTIES = (1.0, 3.0, 10.0, 30.0, 100.0)
FOLDS = 5
NEAR_BANDS = 6.0
"""Contours nearer than so many bands of the kerf heat each other."""
LEAST = 0.05
"""Prices under so many overheats are noise."""


@dataclass(frozen=True, eq=False, slots=True)
class PairPrices:
    """Cutting contour `first[k]` before `second[k]` (numbers) makes `overheats[k]` more (or fewer) than the reverse."""

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    overheats: Floats

    def of(self, order: Sequence[int]) -> float:
        """What an order (contour numbers) is expected to have, up to a constant that is the same for all orders."""
        return float(_stands(self.first, self.second, [order])[0] @ self.overheats)

    def statements(self, nest: Nest, price_mm: float) -> tuple[Precede, ...]:
        """The prices as soft orders; `price_mm` is what an overheat costs, mm of idle travel."""
        found = []
        for i, j, more in zip(self.first.tolist(), self.second.tolist(), self.overheats.tolist(), strict=True):
            if abs(more) >= LEAST:
                before, after = (j, i) if more > 0 else (i, j)
                names = nest.contours[before].id, nest.contours[after].id
                sentence = f"{names[0]} is cut before {names[1]}, or {abs(more):.2g} more points overheat"
                found.append(Precede(before, after, About(HEAT, names, sentence), abs(more) * price_mm))
        return tuple(found)


def near_pairs(nest: Nest, heat: Heat) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Contours that heat each other, each pair once; marks heat nothing."""
    hot = np.array([k for k, contour in enumerate(nest.contours) if contour.kind != "mark"], dtype=np.int64)
    if not len(hot):
        return hot, hot
    lines = [nest.contours[k].line for k in hot]
    within_mm = NEAR_BANDS * max(heat.kerf_band_mm, heat.grid_mm)
    a, b = shapely.STRtree(lines).query(lines, "dwithin", distance=within_mm)
    pairs = np.unique(np.column_stack([a, b])[a < b], axis=0)
    return hot[pairs[:, 0]], hot[pairs[:, 1]]


def fit_pair_prices(
    nest: Nest, heat: Heat, orders: Sequence[Sequence[int]], overheats: Callable[[int], int]
) -> PairPrices:
    """Prices that explain the overheats of these orders (contour numbers) best.

    `overheats` simulates the order of that number; several are asked for at once, by threads.
    """
    first, second = near_pairs(nest, heat)
    with ThreadPoolExecutor() as pool:
        found = np.array(list(pool.map(overheats, range(len(orders)))), dtype=np.float64)
    stands = _stands(first, second, orders)
    return PairPrices(first, second, _ridge(stands, found, _best_penalty(stands, found)))


def _stands(first: NDArray[np.int64], second: NDArray[np.int64], orders: Sequence[Sequence[int]]) -> Floats:
    """A row an order: 1/2 for every pair in which the first one comes first, else -1/2."""
    rows = np.empty((len(orders), len(first)))
    for row, order in zip(rows, orders, strict=True):
        position = np.empty(len(order), dtype=np.int64)
        position[np.asarray(order)] = np.arange(len(order))
        row[:] = np.where(position[first] < position[second], 0.5, -0.5)
    return rows


def _best_penalty(stands: Floats, found: Floats) -> float:
    """The penalty with which orders that are left out are foretold best."""
    fold = np.arange(len(found)) % FOLDS

    def error(penalty: float) -> float:
        total = 0.0
        for k in range(FOLDS):
            known, asked = fold != k, fold == k
            prices = _ridge(stands[known], found[known], penalty)
            told = found[known].mean() + (stands[asked] - stands[known].mean(axis=0)) @ prices
            total += float(((found[asked] - told) ** 2).sum())
        return total

    return min(PENALTIES, key=error)


def _ridge(stands: Floats, found: Floats, penalty: float) -> Floats:
    centred = stands - stands.mean(axis=0)
    inner = centred.T @ centred + penalty * np.eye(stands.shape[1])
    return np.asarray(np.linalg.solve(inner, centred.T @ (found - found.mean())))
