"""Arcs between contours of one site each, as the exchanges read them: small numbers, near to hand."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.models.problem.problem import Problem

from .compiled import compiled
from .legs import Legs

NEAREST = 16  # ends of arcs that an exchange tries to make, the nearer the oftener
DEAREST = 1 << 29  # the most that an arc may cost, so that sums of a few stay small numbers
DRAWS = 4096  # numbers in `falls`


class ArcCosts(NamedTuple):
    """Costs `cost[a, b]` (n + 1, n + 1) from contour to contour, home is n; all empty unless `plain` is 1.

    A problem is plain if every contour has one site, and nothing but orders says who stands where.
    `near[a, :near_count[a]]` are the nearest contours that may directly follow a, `near_in[b, :near_in_count[b]]`
    those that may directly precede b.
    `even` is 1 if most arcs cost the same both ways. `falls` spreads -log(u), u uniform, evenly by chance.
    """

    plain: int
    even: int
    cost: Int32s
    near: Int32s
    near_count: Ints
    near_in: Int32s
    near_in_count: Ints
    falls: NDArray[np.float64]


def make_arcs(problem: Problem, legs: Legs) -> ArcCosts:
    """The arcs of a problem."""
    n = problem.n
    falls = -np.log((np.arange(DRAWS) + 0.5) / DRAWS)
    if not _plain(problem) or not legs.travel.size or legs.travel.max() > DEAREST:
        none, empty = np.zeros((0, 0), dtype=np.int32), np.zeros(0, dtype=np.int64)
        return ArcCosts(0, 0, none, none, empty, none, empty, falls)
    cost = legs.travel.astype(np.int32)
    cost[:, :n] += problem.site_cost.astype(np.int32)
    lawful = problem.successors()
    near, count = _nearest(cost, lawful[:, :n])
    near_in, count_in = _nearest(cost.T, lawful.T[:, :n])
    inner = cost[:n, :n]
    return ArcCosts(1, int((inner == inner.T).mean() > 0.5), cost, near, count, near_in, count_in, falls)


def _plain(problem: Problem) -> bool:
    return (
        problem.n == problem.m > 1
        and len(np.unique(problem.block)) == problem.n
        and not (problem.conditions or problem.soft_groups or problem.lags or problem.general)
        and not len(problem.crossings)
        and bool((problem.site_cost < DEAREST).all())
    )


def _nearest(cost: Int32s, lawful: Bools) -> tuple[Int32s, Ints]:
    """The `NEAREST` lawful contours of each row, nearest first, and how many there are."""
    masked = np.where(lawful, cost[:, : lawful.shape[1]], np.iinfo(np.int32).max)
    near = np.argsort(masked, axis=1, kind="stable")[:, :NEAREST].astype(np.int32)
    return np.ascontiguousarray(near), np.minimum(lawful.sum(axis=1), NEAREST).astype(np.int64)


@compiled
def gap_cost(arcs: ArcCosts, line: Int32s, p: int) -> int:
    """Cost of the arc into what stands at place p of a line."""
    return int(np.int64(arcs.cost[line[p - 1], line[p]]))
