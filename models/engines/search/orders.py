"""Which contour may stand where: precedence in lists, blocks, and who may follow whom."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.problem.closure import known_immediate_pairs
from kerfwise.models.problem.problem import Problem

from .legs import Legs

NEAR = 16  # neighbours of a contour that moves look at


class OrderLists(NamedTuple):
    """`before` is closed. `covers` lists for every contour those that come before it with no third between
    (transitive reduction), `covered` those after it. The members of block `block[i]` are
    `in_block[block_first[block[i]]:…]`.
    `near` (n, k) are the nearest contours that may directly follow, `near_in` those that may directly precede; padded
    with -1.
    """

    before: Bools
    covers_first: Ints
    covers: Ints
    covered_first: Ints
    covered: Ints
    block: Ints
    block_first: Ints
    in_block: Ints
    near: Ints
    near_in: Ints


def make_orders(problem: Problem, legs: Legs) -> OrderLists:
    """The orders of a problem."""
    n, before = problem.n, problem.before
    sooner, later = known_immediate_pairs(before)
    _, block = np.unique(problem.block, return_inverse=True)
    covers_first, covers = _grouped(later, sooner, n)
    covered_first, covered = _grouped(sooner, later, n)
    block_first, in_block = _grouped(block, np.arange(n), int(block.max(initial=-1)) + 1)
    direct = np.sort(sooner * n + later)

    def may_follow(one: Ints, other: Ints) -> Bools:
        at = np.searchsorted(direct, key := one * n + other)
        near = direct[np.minimum(at, len(direct) - 1)] == key if len(direct) else np.zeros(key.shape, dtype=np.bool_)
        return np.asarray((one != other) & ~before[other, one] & (near | ~before[one, other]))

    return OrderLists(
        before=np.ascontiguousarray(before),
        covers_first=covers_first,
        covers=covers,
        covered_first=covered_first,
        covered=covered,
        block=np.asarray(block, dtype=np.int64),
        block_first=block_first,
        in_block=in_block,
        near=_nearest(legs, may_follow, forward=True),
        near_in=_nearest(legs, lambda one, other: may_follow(other, one), forward=False),
    )


def _grouped(key: Ints, value: Ints, groups: int) -> tuple[Ints, Ints]:
    """The values with key 0, then those with key 1 …, in the order given: `first` and `flat` (see `lists`)."""
    by = np.argsort(key, kind="stable")
    return np.searchsorted(key[by], np.arange(groups + 1)).astype(np.int64), value[by].astype(np.int64)


def _nearest(legs: Legs, allowed: Callable[[Ints, Ints], Bools], forward: bool) -> Ints:
    """The `NEAR` nearest allowed contours of each, nearest first."""
    n, k = legs.n, min(NEAR, max(legs.n - 1, 1))
    found = np.full((n, k), -1, dtype=np.int64)
    if n == 0:
        return found
    if legs.travel.size:
        least = np.minimum.reduceat(legs.leave[:-1], legs.first[:-1], axis=0)
        cost = least if forward else least.T
        for i in range(n):
            others = np.flatnonzero(allowed(np.full(n, i), np.arange(n)))
            best = others[np.argsort(cost[i, others], kind="stable")[:k]]
            found[i, : len(best)] = best
        return found
    here, there = (legs.end_circle, legs.pierce_circle) if forward else (legs.pierce_circle, legs.end_circle)
    from scipy.spatial import KDTree

    _, around = KDTree(there[:, :2]).query(here[:, :2], k=min(4 * k, n))
    around = around.reshape(n, -1)
    lawful = allowed(np.repeat(np.arange(n), around.shape[1]), around.ravel()).reshape(around.shape)
    row, column = np.nonzero(lawful)
    rank = np.cumsum(lawful, axis=1)[row, column] - 1
    first = rank < k
    found[row[first], rank[first]] = around[row[first], column[first]]
    return found
