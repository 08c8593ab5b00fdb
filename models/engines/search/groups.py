"""Soft groups, as the search reads them: every piece of a group beyond the first costs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.problem.problem import Problem

from .compiled import compiled
from .lists import flatten, ints


class Groups(NamedTuple):
    """`of` lists the groups of every contour, `within[g, i]` says that contour i is in group g."""

    first: Ints
    of: Ints
    cost: Ints
    within: Bools


def make_groups(problem: Problem) -> Groups:
    """The soft groups of a problem."""
    within = np.zeros((len(problem.soft_groups), problem.n), dtype=np.bool_)
    for g, soft in enumerate(problem.soft_groups):
        within[g, list(soft.contours)] = True
    first, of = flatten([np.flatnonzero(within[:, i]).tolist() for i in range(problem.n)])
    return Groups(first, of, ints([g.cost for g in problem.soft_groups]), within)


@compiled
def pieces_begun(groups: Groups, contour: int, previous: int) -> int:
    """What it costs that pieces of groups begin at a contour; `previous` is -1 at the start of the route."""
    cost = 0
    for e in range(groups.first[contour], groups.first[contour + 1]):
        g = groups.of[e]
        if previous < 0 or not groups.within[g, previous]:
            cost += groups.cost[g]
    return cost
