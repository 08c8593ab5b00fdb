"""Blocks whose last contour stands for them: how the others are gone through is worked out beforehand.

A contiguous block is entered once, and left from its last contour where it has one. Where nothing asks anything of the
contours before that one, the cheapest way through them depends on two sites alone: that by which the block is entered
and that by which it is left. It is found by dynamic programming over sets (Held and Karp 1962), and a program over
moves has neither their sites nor cuts for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.problem import Problem

from .moves import Moves, open_crossings

MOST_INNER = 6
"""Contours before the last one of a block, at the most: all their sets are gone through."""


@dataclass(frozen=True, eq=False, slots=True)
class Passage:
    """Contour `last` ends a block; all of `inner` (k,) come before it, and nothing else is asked of them."""

    last: int
    inner: Ints


def passages_of(problem: Problem) -> tuple[Passage, ...]:
    """The blocks of a problem that their last contour can stand for."""
    asked = np.zeros(problem.n, dtype=np.bool_)
    asked[[condition.contour for condition in problem.conditions]] = True
    asked |= _crossing_inside(problem)
    names, size = np.unique(problem.block, return_counts=True)
    found = []
    for block in names[(size > 1) & (size <= MOST_INNER + 1)].tolist():
        inside = problem.block == block
        members = np.flatnonzero(inside)
        ends = members[problem.before[np.ix_(members, members)].sum(axis=0) == len(members) - 1]
        if not len(ends):
            continue
        last, inner = int(ends[0]), members[members != ends[0]]
        alike = (problem.before[members][:, ~inside] == problem.before[last, ~inside]).all()
        alike &= (problem.before[:, members][~inside] == problem.before[~inside, last][:, None]).all()
        if alike and not asked[inner].any():
            found.append(Passage(last, inner))
    return tuple(found)


def _crossing_inside(problem: Problem) -> Bools:
    """Contours, (n,), that some move crosses, or that are left for another of their block by a move that crosses some.

    Of moves whose cost depends on what is out: of several contours of a block that are crossed each is paid for.
    """
    found = np.zeros(problem.n, dtype=np.bool_)
    if len(problem.crossings):
        rows = problem.crossings.only(open_crossings(problem))
        found[rows.over] = True
        owner, block = np.append(problem.site_contour, problem.n), np.append(problem.block, -1)
        leave = owner[rows.leave]
        found[leave[block[leave] == block[owner[rows.reach]]]] = True
    return found


def stand_for(problem: Problem, passages: Sequence[Passage]) -> tuple[Ints, Ints, Ints]:
    """The contours that are left (k,), the number of each contour among them (n,), and which one stands for it (n,).

    An inner contour has no number: -1.
    """
    last_of = np.arange(problem.n)
    for passage in passages:
        last_of[passage.inner] = passage.last
    kept = np.flatnonzero(last_of == np.arange(problem.n))
    number = np.full(problem.n, -1, dtype=np.int64)
    number[kept] = np.arange(len(kept))
    return kept, number, last_of


def size_without_inner(problem: Problem) -> tuple[int, int]:
    """How many contours and sites are left where last contours stand for their blocks."""
    kept, _, _ = stand_for(problem, passages_of(problem))
    return len(kept), int((problem.first[kept + 1] - problem.first[kept]).sum())


def through(problem: Problem, passage: Passage, moves: Moves, sites: Ints, charged: Floats) -> Floats:
    """What it costs at least to cut the contours of a block before its last, and then that one, (k, l).

    From the cut at each of the k sites of `passage.inner`, in their order, to that at each of `sites` (l,), which are
    of the last contour and cost `charged` (l,). Infinite where no order has it.
    """
    inner = problem.sites_of(passage.inner)
    owner, own = problem.site_contour[inner], problem.site_cost[inner].astype(np.float64)
    step = moves.between(inner, inner) + own
    none = frozenset[int]()
    to_go = {none: moves.between(inner, sites) + charged}
    contours = passage.inner.tolist()
    for size in range(1, len(contours)):
        for some in combinations(contours, size):
            rest = frozenset(some)
            cost = np.full(to_go[none].shape, np.inf)
            for contour in some:
                next_ = owner == contour
                cost = np.minimum(cost, cheapest(step[:, next_], to_go[rest - {contour}][next_]))
            to_go[rest] = cost
    whole = np.empty(to_go[none].shape)
    for contour in contours:
        first = owner == contour
        whole[first] = to_go[frozenset(contours) - {contour}][first]
    return whole + own[:, None]


def best_way(problem: Problem, passage: Passage, moves: Moves, entered: Floats, last: int) -> list[int]:
    """The sites of a cheapest way through the contours of a block before its last, which is cut at site `last`.

    `entered` (k,) is what it costs to come to each of the k sites of `passage.inner`, in their order.
    """
    route: list[int] = []
    sites, end = problem.sites_of(passage.inner), np.array([last])
    while True:
        rest = through(problem, passage, moves, end, np.zeros(1))[:, 0]
        route.append(int(sites[np.argmin(entered + rest)]))
        inner = passage.inner[passage.inner != problem.site_contour[route[-1]]]
        if not len(inner):
            return route
        passage, sites = Passage(passage.last, inner), problem.sites_of(inner)
        entered = moves.between(np.array(route[-1:]), sites)[0]


def cheapest(one: Floats, then: Floats) -> Floats:
    """The cheapest of all ways in two steps, (j, l): `one` (j, k) and `then` (k, l)."""
    cost: Floats = (one[:, :, None] + then[None]).min(axis=1)
    return cost


def without_inner(condition: Condition, last_of: Ints) -> Condition:
    """The same condition on the last contours of blocks alone; `last_of` (n,) is that which stands for each contour.

    What lies in another block is out when its last contour is; what comes before the contour in its own block is out.
    """
    weights: dict[int, int] = {}
    bound = condition.bound
    for member, weight in zip(condition.members, condition.weights, strict=True):
        last = int(last_of[member])
        if last == condition.contour != member:
            bound -= weight
        else:
            weights[last] = weights.get(last, 0) + weight
    return replace(condition, members=tuple(weights), weights=tuple(weights.values()), bound=bound)


def renumbered(condition: Condition, number: Ints) -> Condition:
    """The same condition where contours have other numbers."""
    members = tuple(int(number[member]) for member in condition.members)
    return replace(condition, contour=int(number[condition.contour]), members=members)
