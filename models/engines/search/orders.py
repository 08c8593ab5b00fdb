"""Which contour may stand where: precedence in lists, blocks, and who may follow whom."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.problem.closure import immediate
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
    n = problem.n
    direct = immediate(problem.before)
    sooner, later = np.nonzero(direct)
    _, block = np.unique(problem.block, return_inverse=True)
    covers_first, covers = _grouped(later, sooner, n)
    covered_first, covered = _grouped(sooner, later, n)
    block_first, in_block = _grouped(block, np.arange(n), int(block.max(initial=-1)) + 1)
    may_follow = ~problem.before.T & (~problem.before | direct)
    np.fill_diagonal(may_follow, False)
    return OrderLists(
        before=np.ascontiguousarray(problem.before),
        covers_first=covers_first,
        covers=covers,
        covered_first=covered_first,
        covered=covered,
        block=np.asarray(block, dtype=np.int64),
        block_first=block_first,
        in_block=in_block,
        near=_nearest(legs, may_follow, forward=True),
        near_in=_nearest(legs, may_follow.T, forward=False),
    )


def _grouped(key: Ints, value: Ints, groups: int) -> tuple[Ints, Ints]:
    """The values with key 0, then those with key 1 …, in the order given: `first` and `flat` (see `lists`)."""
    by = np.argsort(key, kind="stable")
    return np.searchsorted(key[by], np.arange(groups + 1)).astype(np.int64), value[by].astype(np.int64)


def _nearest(legs: Legs, allowed: Bools, forward: bool) -> Ints:
    """The `NEAR` nearest allowed contours of each, nearest first."""
    k = min(NEAR, max(legs.n - 1, 1))
    found = np.full((legs.n, k), -1, dtype=np.int64)
    if legs.n == 0:
        return found
    if legs.travel.size:
        least = np.minimum.reduceat(legs.leave[:-1], legs.first[:-1], axis=0)
        cost = least if forward else least.T
        for i in range(legs.n):
            others = np.flatnonzero(allowed[i])
            best = others[np.argsort(cost[i, others], kind="stable")[:k]]
            found[i, : len(best)] = best
        return found
    here, there = (legs.end_circle, legs.pierce_circle) if forward else (legs.pierce_circle, legs.end_circle)
    from scipy.spatial import KDTree

    _, around = KDTree(there[:, :2]).query(here[:, :2], k=min(4 * k, legs.n))
    for i, others in enumerate(around.reshape(legs.n, -1)):
        best = others[allowed[i, others]][:k]
        found[i, : len(best)] = best
    return found
