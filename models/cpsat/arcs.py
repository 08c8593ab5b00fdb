"""The arcs of the route: which contour may directly follow which, by which sites, and at what cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem
from ..successors import Bools

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Arcs:
    """Arcs between sites, in groups of the same two contours; the machine's home is site m and contour n.

    Group g leads from contour `groups[g, 0]` to `groups[g, 1]` and holds arcs `first[g]` … `first[g + 1] - 1`; arc a
    leads from site `tail[a]` to `head[a]` and costs `cost[a]` µm.
    """

    groups: Ints
    first: Ints
    tail: Ints
    head: Ints
    cost: Ints


def count_site_arcs(problem: Problem, lawful: Bools) -> int:
    """How many arcs between sites there are."""
    sites = np.append(np.diff(problem.first), 1)
    return int(sites @ lawful @ sites)


def site_arcs(problem: Problem, lawful: Bools) -> Arcs:
    """Every lawful arc between sites, at the cost of its idle travel."""
    groups = np.argwhere(lawful).astype(np.int64)
    sites = [*(np.array(problem.sites(i)) for i in range(problem.n)), np.array([problem.m])]
    tails = [np.repeat(sites[i], len(sites[j])) for i, j in groups]
    heads = [np.tile(sites[j], len(sites[i])) for i, j in groups]
    costs = [travel.ravel() for travel in _travel(problem, groups)]
    first = np.cumsum([0, *(len(cost) for cost in costs)])
    return Arcs(groups, first, np.concatenate(tails), np.concatenate(heads), np.concatenate(costs))


def arc_ms(problem: Problem, arcs: Arcs) -> Ints:
    """Time of the idle travel along every arc between sites, whole ms."""
    home = problem.home_um[None, :]
    ends, pierces = np.concatenate([problem.end_um, home]), np.concatenate([problem.pierce_um, home])
    return problem.pace.move_ms(ends[arcs.tail], pierces[arcs.head])


def contour_arcs(problem: Problem, lawful: Bools) -> Arcs:
    """One arc for every two contours, at the least idle travel between their sites; site i stands for contour i."""
    groups = np.argwhere(lawful).astype(np.int64)
    costs = np.array([travel.min() for travel in _travel(problem, groups)], dtype=np.int64)
    return Arcs(groups, np.arange(len(groups) + 1), groups[:, 0], groups[:, 1], costs)


def _travel(problem: Problem, groups: Ints) -> Iterator[Ints]:
    """Idle travel from every site of the one contour to every site of the other, for all these groups."""
    home = problem.home_um[None, :]
    ends, pierces = np.concatenate([problem.end_um, home]), np.concatenate([problem.pierce_um, home])
    first = [*problem.first.tolist(), problem.m + 1]
    for i, j in groups.tolist():
        yield problem.travel(ends[first[i] : first[i + 1]], pierces[first[j] : first[j + 1]])
