"""Conditions on the set already cut, as the search reads them: in flat arrays, judged by position."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.problem.problem import Problem

from .compiled import compiled
from .lists import flatten, ints

HARD = -1  # a cost that cannot be paid


class Demands(NamedTuple):
    """Conditions numbered so that those of a contour, then those of a site, are consecutive.

    Contour i has `of_contour[i]` … `of_contour[i + 1] - 1`, site s those of `of_site`. `touch` lists the conditions
    that a contour is a member of.
    """

    of_contour: Ints
    of_site: Ints
    contour: Ints
    site: Ints
    bound: Ints
    cost: Ints
    member_first: Ints
    member: Ints
    weight: Ints
    touch_first: Ints
    touch: Ints
    touch_weight: Ints


def make_demands(problem: Problem) -> Demands:
    """The conditions of a problem."""
    whole = sorted((c for c in problem.conditions if c.when is None), key=lambda c: c.contour)
    sited = sorted((c for c in problem.conditions if c.when is not None), key=lambda c: c.when or 0)
    conditions = [*whole, *sited]
    touching: list[list[tuple[int, int]]] = [[] for _ in range(problem.n)]
    for k, c in enumerate(conditions):
        for x, w in zip(c.members, c.weights, strict=True):
            touching[x].append((k, w))
    member_first, member = flatten([c.members for c in conditions])
    touch_first, touch = flatten([[k for k, _ in row] for row in touching])
    return Demands(
        of_contour=ints(np.searchsorted([c.contour for c in whole], range(problem.n + 1)).tolist()),
        of_site=ints((len(whole) + np.searchsorted([c.when or 0 for c in sited], range(problem.m + 1))).tolist()),
        contour=ints([c.contour for c in conditions]),
        site=ints([-1 if c.when is None else c.when for c in conditions]),
        bound=ints([c.bound for c in conditions]),
        cost=ints([HARD if c.cost is None else c.cost for c in conditions]),
        member_first=member_first,
        member=member,
        weight=ints([w for c in conditions for w in c.weights]),
        touch_first=touch_first,
        touch=touch,
        touch_weight=ints([w for row in touching for _, w in row]),
    )


@compiled
def met_at(demands: Demands, k: int, position: Ints, at: int, more: int) -> bool:
    """Whether condition k is met when its contour is cut just before position `at`, with `more` on its left side."""
    total = more
    for e in range(demands.member_first[k], demands.member_first[k + 1]):
        where = position[demands.member[e]]
        if 0 <= where < at:
            total += demands.weight[e]
    return bool(total >= demands.bound[k])


@compiled
def unmet(demands: Demands, start: int, stop: int, position: Ints, at: int) -> tuple[int, int]:
    """Cost, and number of hard ones, of the conditions `start` … `stop - 1` not met at a position."""
    cost, broken = 0, 0
    for k in range(start, stop):
        if not met_at(demands, k, position, at, 0):
            if demands.cost[k] < 0:
                broken += 1
            else:
                cost += demands.cost[k]
    return cost, broken
