"""The arcs of the route: which contour may directly follow which, by which sites, and at what cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem

from .in_time import GoOn, always
from .moves import Out, arc_of_move, out_by_then

LOOKS = 1000
"""Pairs of contours from one question whether to go on to the next."""


@dataclass(frozen=True, eq=False, slots=True)
class ArcLiterals:
    """Arcs between sites, in groups of the same two contours; the machine's home is site m and contour n.

    Group g leads from contour `groups[g, 0]` to `groups[g, 1]` and holds arcs `first[g]` … `first[g + 1] - 1`; arc a
    leads from site `tail[a]` to `head[a]` and costs `cost[a]` µm.
    """

    groups: Ints
    first: Ints
    tail: Ints
    head: Ints
    cost: Ints

    def spans(self) -> Iterator[tuple[int, int, slice]]:
        """Contours i and j, and the arcs between them, for every group."""
        for (i, j), a, b in zip(self.groups.tolist(), self.first[:-1].tolist(), self.first[1:].tolist(), strict=True):
            yield i, j, slice(a, b)


def site_arcs(problem: Problem, lawful: Bools, go_on: GoOn = always) -> ArcLiterals:
    """Every lawful arc between sites, at the cost of its idle travel and of what it crosses in any lawful order.

    `go_on` is asked now and then.
    """
    groups = np.argwhere(lawful).astype(np.int64)
    first = np.append(problem.first, problem.m + 1)
    sites = np.arange(problem.m + 1)
    tails, heads, costs = [], [], []
    for k, (i, j) in enumerate(groups.tolist()):
        if k % LOOKS == 0:
            go_on()
        leave, reach = sites[first[i] : first[i + 1]], sites[first[j] : first[j + 1]]
        tails.append(np.repeat(leave, len(reach)))
        heads.append(np.tile(reach, len(leave)))
        costs.append(problem.travel(leave, reach).ravel())
    sizes = np.array([len(cost) for cost in costs])
    return _crossed(problem, groups, sizes, *(np.concatenate(column) for column in (tails, heads, costs)))


def _crossed(problem: Problem, groups: Ints, sizes: Ints, tail: Ints, head: Ints, cost: Ints) -> ArcLiterals:
    """Arcs with the crossings that the hard orders decide: forbidden ones are left out."""
    rows = problem.crossings
    always = out_by_then(problem) == Out.YES
    arc = arc_of_move(problem.m, tail, head, rows.leave, rows.reach)
    paid = always & (arc >= 0) & (rows.cost != FORBIDDEN)
    np.add.at(cost, arc[paid], rows.cost[paid])
    kept = np.ones(len(cost), dtype=np.bool_)
    kept[arc[always & (arc >= 0) & (rows.cost == FORBIDDEN)]] = False
    left = np.add.reduceat(kept, np.cumsum(sizes) - sizes, dtype=np.int64)
    first = np.concatenate([[0], np.cumsum(left[left > 0])])
    return ArcLiterals(groups[left > 0], first, tail[kept], head[kept], cost[kept])
