"""A stretch as a problem of its own, between homes that stand for what comes before it and after it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.links import Links
from kerfwise.models.problem.problem import Problem

FAR = 1 << 38
"""µm: what an unlawful way out of a stretch costs in a bound, more than any plan; sums stay exact in doubles."""


def ends_of(problem: Problem, group: tuple[int, ...]) -> tuple[Ints, Ints]:
    """Sites of the contours that a group may begin with, and of those that it may end with."""
    within = problem.before[np.ix_(group, group)]
    chosen = np.array(group)
    into, out_of = (problem.sites_of(chosen[~within.any(axis=axis)]) for axis in (0, 1))
    return into, out_of


def alone(problem: Problem, group: tuple[int, ...], sites: Ints, enter: Ints, leave: Ints, onward: Ints) -> Problem:
    """A stretch as a problem without conditions, entered from home at `enter` (sites,), left at `onward`."""
    size = np.diff(problem.first)[list(group)]
    matrix = np.full((len(sites) + 1, len(sites) + 1), FAR, dtype=np.int64)
    matrix[:-1, :-1] = problem.travel(sites, sites)
    matrix[-1, :-1] = np.minimum(enter, FAR)
    matrix[:-1, -1][np.searchsorted(sites, leave)] = onward
    number = {c: k for k, c in enumerate(group)}
    lags = (lag for lag in problem.lags if lag.first in number and lag.second in number)
    return replace(
        problem,
        n=len(group),
        first=np.append(0, np.cumsum(size)),
        site_contour=np.repeat(np.arange(len(group)), size),
        site_candidate=problem.site_candidate[sites],
        candidate_site=np.arange(len(sites)),
        pierce_um=problem.pierce_um[sites],
        end_um=problem.end_um[sites],
        site_cost=problem.site_cost[sites],
        before=np.ascontiguousarray(problem.before[np.ix_(group, group)]),
        block=np.unique(problem.block[list(group)], return_inverse=True)[1],
        conditions=(),
        soft_groups=(),
        lags=tuple(replace(lag, first=number[lag.first], second=number[lag.second]) for lag in lags),
        general=(),
        ids=tuple(problem.ids[c] for c in group),
        crossings=Crossings(),
        links=Links(),
        matrix=matrix,
        orders=b"",
    )


def conditions_within(
    problem: Problem, group: tuple[int, ...], sites: Ints, earlier: frozenset[int]
) -> Iterator[Condition]:
    """The conditions of a stretch in its own numbers, once all contours of `earlier` are out, and none that follow."""
    number = {c: k for k, c in enumerate(group)}
    for asked in problem.conditions:
        if asked.contour in number:
            pairs = list(zip(asked.members, asked.weights, strict=True))
            inside = [(number[c], weight) for c, weight in pairs if c in number]
            yield replace(
                asked,
                contour=number[asked.contour],
                members=tuple(c for c, _ in inside),
                weights=tuple(weight for _, weight in inside),
                bound=asked.bound - sum(weight for c, weight in pairs if c in earlier),
                when=None if asked.when is None else int(np.searchsorted(sites, asked.when)),
            )
