"""A bound by walks: n steps over sites at lawful positions, contours priced so that each is visited about once.

A plan is a walk from home that takes n steps, the k-th to a site whose contour may be cut k-th, and goes home. A walk
need not visit every contour once. A price on every contour, paid out on a visit and charged once to all, changes the
cost of no plan, and makes walks that visit one contour often and others never dear. The cheapest walk is found by
dynamic programming over (position, what it remembers, site), good prices by subgradients (Picard and Queyranne 1978;
Held and Karp 1971). Where a walk goes on from is where it came to, so sites are as they should be.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.models.engines.solution import Progress
from kerfwise.models.kernels import cores
from kerfwise.models.problem.problem import Problem

from .kernels import look_back, walk_on
from .moves import least_moves
from .ng_paths import NgSets, ng_sets

ADDITIONS_PER_S = 6e8
THREADS = cores()
MOST_NEIGHBOURS = 7
MOST_NUMBERS = 60_000_000
"""Of all tables together."""
SHARE, BYTES_A_NUMBER = 0.3, 8
"""Share of the bytes given that the tables may take; a sweep with its own follows."""
GRAIN = 64.0
"""Prices are multiples of 1 / 64: sums of them and of whole costs are then exact in doubles, below 10¹⁴."""
DEAREST = 1e12
"""Prices stay within this, so that sums stay exact."""
PATIENCE = 8
"""Rounds without a better bound after which the steps become shorter."""
SHORTEST = 0.002
"""Steps below which no more rounds are worth it."""
WORTH_SHARING = 2e5
"""Additions at a place from which on other threads are worth waking."""
INERTIA = 0.4
"""How much of the last direction is in the next (Camerini, Fratta and Maffioli 1975)."""


class TooMuch(Exception):
    """A single round takes more than there is."""


@dataclass(frozen=True, eq=False, slots=True)
class Completion:
    """What every plan still costs after a state; `root` is what whole plans cost.

    After k contours, the set S of them out and the last cut at site s of contour c, the rest costs at least
    `to_go[k, A, s]` and `price[d]` for every contour d not in S. Bit j of A says that `near[c, j]` is a contour not
    in S. `to_go` is (n + 1, 2 ** g, m), `price` (n,), `near` (n, g), -1 for none; all in the problem's unit (µm).
    """

    to_go: Floats
    price: Floats
    near: Ints
    root: float
    work: float

    def after_first(self, contour: Ints) -> Floats:
        """What the rest costs at least once a plan has begun at a site, (m,); `contour` (m,) is that of every site."""
        memory = ((self.near >= 0) << np.arange(self.near.shape[1])).sum(axis=1)[contour]
        rest: Floats = self.to_go[1, memory, np.arange(len(contour))] + self.price.sum() - self.price[contour]
        return rest


def complete(
    problem: Problem,
    target: float | None,
    work: float,
    progress: Progress | None = None,
    most_neighbours: int = MOST_NEIGHBOURS,
    most_bytes: float = math.inf,
    most: float = math.inf,
) -> Completion:
    """Look for prices that make the bound as high as can be.

    Parameters
    ----------
    target
        Cost of a known plan.
    work
        Limit in deterministic seconds; at least one round is made.
    progress
        Asked every round whether to go on.
    most_neighbours
        What a walk remembers at the most; fewer where the tables would be too large.
    most_bytes
        Of which the tables take no more than a share.
    most
        Deterministic seconds of which a bound is of no use if it takes as many.

    Raises
    ------
    TooMuch
        If one round takes `most` or more.
    """
    n = problem.n
    move = least_moves(problem)
    near = ng_sets(problem, move, _affordable(problem, most_neighbours, most_bytes))
    back = np.ascontiguousarray(move.T)
    back[: problem.m] += problem.site_cost[:, None]
    lawful, first = problem.successors(), problem.first
    earliest, latest = problem.before.sum(axis=0) + 1, n - problem.before.sum(axis=1)
    cost = _additions(problem, near, earliest, latest)
    if cost >= most * ADDITIONS_PER_S:
        raise TooMuch
    price = best_price = heading = np.zeros(n)
    shape = (n + 1, near.size, problem.m)
    to_go, least, best = np.empty(shape), np.full(shape, np.inf), np.full(shape, np.inf)
    walk = np.zeros(n, dtype=np.int64)
    bound, step, waited, spent = -np.inf, 1.0, 0, 0
    while True:
        spent += 1
        _look_back(n, cost / max(1, n), (back, lawful, price, first, earliest, latest, near.carried, to_go, least))
        reached = walk_on(back, lawful, price, first, near.carried, to_go, walk) + price.sum()
        if reached > bound or spent == 1:
            bound, best_price, waited = reached, price, 0
            best, least = least, best
        else:
            waited += 1
        missing = 1.0 - np.bincount(walk, minlength=n)
        if not np.isfinite(reached) or not missing.any() or (target is not None and bound > target - 1):
            break
        if (spent + 1) * cost > work * ADDITIONS_PER_S or (progress and not progress("bound", None, None)):
            break
        if waited == PATIENCE:
            price, step, waited, heading = best_price, step * 0.6, 0, np.zeros(n)
            if step < SHORTEST:
                break
        heading = missing + INERTIA * heading
        aim = (1.05 * abs(bound) if target is None else target) - reached
        price = price + step * max(aim, 1.0) / max(1.0, float(heading @ heading)) * heading
        price = np.rint(np.clip(price, -DEAREST, DEAREST) * GRAIN) / GRAIN
    return Completion(best, best_price, near.near, bound, spent * cost / ADDITIONS_PER_S)


def _look_back(n: int, additions: float, tables: tuple[NDArray[Any], ...]) -> None:
    """The whole sweep, every place by all threads (numba's own would keep the process from forking later).

    Where a place takes few `additions`, one thread is done before others have woken.
    """
    if additions < WORTH_SHARING:
        for k in range(n, 0, -1):
            look_back(k, 0, 1, *tables)
        return
    with ThreadPoolExecutor(THREADS) as threads:
        for k in range(n, 0, -1):
            parts = [threads.submit(look_back, k, part, THREADS, *tables) for part in range(1, THREADS)]
            look_back(k, 0, THREADS, *tables)
            for part in parts:
                part.result()


def _affordable(problem: Problem, most: int, most_bytes: float) -> int:
    """How many neighbours a walk may remember so that the tables fit the memory."""
    one = 3 * (problem.n + 1) * problem.m + problem.n**2
    numbers = min(MOST_NUMBERS, SHARE * most_bytes / BYTES_A_NUMBER)
    return max(0, min(most, int(np.log2(max(1, numbers / max(1, one))))))


def _additions(problem: Problem, near: NgSets, earliest: Ints, latest: Ints) -> float:
    """What one round takes."""
    sites = np.diff(problem.first)
    numbers = (np.diff(np.sort(near.carried, axis=2), axis=2) > 0).sum(axis=2) + 1
    ways = np.where(problem.successors()[:-1, :-1], numbers, 0) * sites[:, None] * sites[None, :]
    places = np.minimum(latest[:, None], latest[None, :] - 1) - np.maximum(earliest[:, None], earliest[None, :] - 1) + 1
    return float((ways * np.maximum(places, 0)).sum()) + float(problem.n * problem.m * near.size * 4) + 1.0
