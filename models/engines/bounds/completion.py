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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Int16s, Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.tuning import BYTES_A_NUMBER, INERTIA, MOST_NUMBERS, WORTH_SHARING
from kerfwise.models.engines.tuning import COMPLETION_ADDITIONS_PER_S as ADDITIONS_PER_S
from kerfwise.models.engines.tuning import COMPLETION_MOST_NEIGHBOURS as MOST_NEIGHBOURS
from kerfwise.models.engines.tuning import COMPLETION_PATIENCE as PATIENCE
from kerfwise.models.engines.tuning import COMPLETION_SHARE as SHARE
from kerfwise.models.engines.tuning import COMPLETION_SHORTEST as SHORTEST
from kerfwise.models.jit import KERNEL, cores, jit
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.problem import Problem

from .move_costs import least_moves

THREADS = cores()
GRAIN = 64.0
"""Prices are multiples of 1 / 64: sums of them and of whole costs are then exact in doubles, below 10¹⁴."""
DEAREST = 1e12
"""Prices stay within this, so that sums stay exact."""


class TooMuch(Exception):
    """A single round takes more than there is; `work` deterministic seconds were spent before that was known."""

    def __init__(self, work: float = 0.0) -> None:
        super().__init__()
        self.work = work


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
    deadline: Deadline,
    most_neighbours: int = MOST_NEIGHBOURS,
    most: float = math.inf,
) -> Completion:
    """Look for prices that make the bound as high as can be.

    Parameters
    ----------
    target
        Cost of a known plan.
    deadline
        At least one round is made of its work. The tables take no more than a share of its bytes.
    most_neighbours
        What a walk remembers at the most; fewer where the tables would be too large.
    most
        Deterministic seconds of which a bound is of no use if it takes as many.

    Raises TooMuch if one round takes `most` or more.
    """
    n = problem.n
    lawful, first = problem.successors(), problem.first
    earliest, latest = problem.before.sum(axis=0) + 1, n - problem.before.sum(axis=1)
    if _additions(problem, None, lawful, earliest, latest) >= most * ADDITIONS_PER_S:  # its tables alone take long
        raise TooMuch
    move = least_moves(problem)
    near = ng_sets(problem, move, _affordable(problem, most_neighbours, deadline.most_bytes))
    back = np.ascontiguousarray(move.T)
    back[: problem.m] += problem.site_cost[:, None]
    cost = _additions(problem, near, lawful, earliest, latest)
    if cost >= most * ADDITIONS_PER_S:
        raise TooMuch
    walks = kernel_argument(Walks(back, lawful, first, earliest, latest, near.carried))
    price = best_price = heading = np.zeros(n)
    shape = (n + 1, near.size, problem.m)
    to_go, least, best = np.empty(shape), np.full(shape, np.inf), np.full(shape, np.inf)
    walk = np.zeros(n, dtype=np.int64)
    bound, step, waited, spent = -np.inf, 1.0, 0, 0
    while True:
        spent += 1
        _look_back(n, cost / max(1, n), walks, price, to_go, least)
        reached = walk_on(walks, price, to_go, walk) + price.sum()
        if reached > bound or spent == 1:
            bound, best_price, waited = reached, price, 0
            best, least = least, best
        else:
            waited += 1
        missing = 1.0 - np.bincount(walk, minlength=n)
        if not np.isfinite(reached) or not missing.any() or (target is not None and bound > target - 1):
            break
        if (spent + 1) * cost > deadline.work * ADDITIONS_PER_S or not deadline("bound", None, None):
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


def _look_back(n: int, additions: float, walks: Walks, price: Floats, to_go: Floats, least: Floats) -> None:
    """The whole sweep, every place by all threads (numba's own would keep the process from forking later).

    Where a place takes few `additions`, one thread is done before others have woken.
    """
    room = np.empty((THREADS, walks.carried.shape[2]))
    if additions < WORTH_SHARING:
        for k in range(n, 0, -1):
            look_back(k, 0, 1, walks, price, to_go, least, room[0])
        return
    with ThreadPoolExecutor(THREADS) as threads:
        for k in range(n, 0, -1):
            parts = [
                threads.submit(look_back, k, part, THREADS, walks, price, to_go, least, room[part])
                for part in range(1, THREADS)
            ]
            look_back(k, 0, THREADS, walks, price, to_go, least, room[0])
            for part in parts:
                part.result()


def _affordable(problem: Problem, most: int, most_bytes: float) -> int:
    """How many neighbours a walk may remember so that the tables fit the memory."""
    one = 3 * (problem.n + 1) * problem.m + problem.n**2
    numbers = min(MOST_NUMBERS, SHARE * most_bytes / BYTES_A_NUMBER)
    return max(0, min(most, int(np.log2(max(1, numbers / max(1, one))))))


def _additions(problem: Problem, near: NgSets | None, lawful: NDArray[np.bool_], earliest: Ints, latest: Ints) -> float:
    """What one round takes, by `problem.successors()`; without `near` that of a walk which remembers nothing."""
    sites = np.diff(problem.first)
    numbers = 1 if near is None else (np.diff(np.sort(near.carried, axis=2), axis=2) > 0).sum(axis=2) + 1
    ways = np.where(lawful[:-1, :-1], numbers, 0) * sites[:, None] * sites[None, :]
    places = np.minimum(latest[:, None], latest[None, :] - 1) - np.maximum(earliest[:, None], earliest[None, :] - 1) + 1
    memories = 1 if near is None else near.size
    return float((ways * np.maximum(places, 0)).sum()) + float(problem.n * problem.m * memories * 4) + 1.0


# The inner loops of the bound by walks, compiled by numba.


class Walks(NamedTuple):
    """What every round goes by: `back[t, s]` is what coming to t from s costs (home last).

    Contour c may be the k-th for `earliest[c]` ≤ k ≤ `latest[c]`; `first` and `lawful` are as the problem has them,
    `carried` as `NgSets` has it.
    """

    back: Floats
    lawful: NDArray[np.bool_]
    first: Ints
    earliest: Ints
    latest: Ints
    carried: Int16s


@jit(**KERNEL)
def look_back(  # pragma: no cover - compiled
    k: int, part: int, parts: int, walks: Walks, price: Floats, to_go: Floats, least: Floats, ahead: Floats
) -> None:
    """Fill `to_go[k, M, s]` for every `parts`-th contour from `part` on, `to_go[k + 1]` given.

    It is the least of all walks that go on from site s, the k-th, to the end and remember M.

    `price[c]` is paid out at contour c. Where remembering less costs no more, `to_go` is infinite. `least[k, A, s]` is
    the least over all memories M within A. `ahead` is room for what comes of each memory.
    """
    back, lawful, first, carried = walks.back, walks.lawful, walks.first, walks.carried
    earliest, latest = walks.earliest, walks.latest
    n, m, memories = len(first) - 1, len(back) - 1, carried.shape[2]
    for a in range(part, n, parts):
        for s in range(first[a], first[a + 1]):  # numba takes seconds to compile what copies an array into another
            for memory in range(memories):
                to_go[k, memory, s] = np.inf
        if k < earliest[a] or k > latest[a]:
            for s in range(first[a], first[a + 1]):
                for memory in range(memories):
                    least[k, memory, s] = np.inf
            continue
        if k == n:
            for s in range(first[a], first[a + 1]):
                to_go[k, 0, s] = back[m, s]
        else:
            for b in range(n):
                if not lawful[a, b] or k + 1 < earliest[b] or k + 1 > latest[b]:
                    continue
                for t in range(first[b], first[b + 1]):
                    for after in range(memories):
                        ahead[after] = np.inf
                    for before in range(memories):
                        after = carried[a, b, before]
                        if after >= 0:
                            ahead[after] = min(ahead[after], to_go[k + 1, before, t])
                    row = back[t]
                    for after in range(memories):
                        if ahead[after] < np.inf:
                            cost = ahead[after] - price[b]
                            here = to_go[k, after]
                            for s in range(first[a], first[a + 1]):
                                total = row[s] + cost
                                here[s] = min(here[s], total)
        for s in range(first[a], first[a + 1]):
            for memory in range(memories):
                best = np.inf
                bit = 1
                while bit < memories:
                    if memory & bit:
                        best = min(best, least[k, memory ^ bit, s])
                    bit <<= 1
                if to_go[k, memory, s] < best:
                    best = to_go[k, memory, s]
                else:
                    to_go[k, memory, s] = np.inf
                least[k, memory, s] = best


@jit(**KERNEL)
def walk_on(walks: Walks, price: Floats, to_go: Floats, walk: Ints) -> float:  # pragma: no cover - compiled
    """The cheapest walk from home, its contours in `walk`; its cost."""
    back, lawful, first, carried = walks.back, walks.lawful, walks.first, walks.carried
    n, m, memories = len(first) - 1, len(back) - 1, carried.shape[2]
    at, here, memory, cost = m, n, 0, np.inf
    for k in range(1, n + 1):
        best = np.inf
        site, contour, remembered = -1, -1, 0
        for b in range(n):
            if not lawful[here, b]:
                continue
            for ahead in range(memories):
                if here < n and carried[here, b, ahead] != memory:
                    continue
                for t in range(first[b], first[b + 1]):
                    total = back[t, at] - price[b] + to_go[k, ahead, t]
                    if total < best:
                        best, site, contour, remembered = total, t, b, ahead
        if site < 0:
            return np.inf
        if k == 1:
            cost = best
        walk[k - 1] = contour
        at, here, memory = site, contour, remembered
    return cost


# What a walk remembers: at every contour, which of a few others near it come later.
#
# A walk that must keep clear of the contours it remembers takes short cycles no more (ng-routes: Baldacci, Mingozzi
# and Roberti 2011). It remembers a contour as long as all contours on its way have it among their neighbours.


@dataclass(frozen=True, eq=False, slots=True)
class NgSets:
    """`near[a, j]` is neighbour j of contour a, -1 for none; a memory at a is a set of bits j.

    A walk at contour a that goes on to b, where it remembers M, remembers `carried[a, b, M]` at a; -1 where it may
    not: a is in M, or something that must come before a is.
    """

    near: Ints
    carried: Int16s

    @property
    def size(self) -> int:
        """Number of memories at a contour."""
        return int(self.carried.shape[2])


def ng_sets(problem: Problem, move: Floats, most: int) -> NgSets:
    """The `most` nearest neighbours of every contour among those that may be cut at about the same time."""
    n = problem.n
    near = _nearest(problem, move, min(most, n - 1))
    memories = np.arange(1 << near.shape[1])
    bit = np.full((n, n + 1), -1, dtype=np.int64)  # which neighbour of the row the column is
    rows, columns = np.nonzero(near >= 0)
    bit[rows, near[rows, columns]] = columns
    own = np.where(bit[:, :n] >= 0, 1 << np.maximum(bit[:, :n], 0), 0)
    carried = np.repeat(own[:, :, None], len(memories), axis=2)
    never = problem.before.T | np.eye(n, dtype=np.bool_)  # never[a, c]: c may not come after a
    for j in range(near.shape[1]):
        has = (memories >> j & 1).astype(np.bool_)
        there = near[:, j] >= 0
        contour = np.where(there, near[:, j], 0)
        kept = np.where(there[None, :], own[:, contour], 0)  # (a, b): what neighbour j of b is at a
        broken = never[:, contour] & there[None, :]
        carried |= np.where(has, kept[:, :, None], 0)
        carried[broken[:, :, None] & has] = -1
    return NgSets(near, carried.astype(np.int16))


def _nearest(problem: Problem, move: Floats, most: int) -> Ints:
    n, m = problem.n, problem.m
    first = problem.first[:-1]
    apart = np.minimum.reduceat(np.minimum.reduceat(move[:m, :m], first, axis=0), first, axis=1)
    apart = np.minimum(apart, apart.T)
    np.fill_diagonal(apart, np.inf)
    order = np.argsort(apart, axis=1, kind="stable")[:, :most]
    near: Ints = np.where(np.isfinite(np.take_along_axis(apart, order, axis=1)), order, -1).reshape(n, most)
    return near
