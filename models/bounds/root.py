"""A bound on whole plans, for problems of any size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..crossings import Crossings
from ..problem import Problem
from ..solution import Progress
from .completion import complete

MOST_SITES = 3000
"""With more, contours stand for all their sites."""


def root_bound(problem: Problem, target: float | None, work: float, progress: Progress | None = None) -> int | None:
    """What every lawful plan costs at least, in whole µm (or the problem's unit); None where no plan is lawful.

    `target` is the cost of a known plan, `work` a limit in deterministic seconds.
    """
    if problem.n == 0:
        return int(problem.travel([problem.m], [problem.m])[0, 0])
    root = complete(problem if problem.m <= MOST_SITES else merged(problem), target, work, progress).root
    return int(np.ceil(root)) if np.isfinite(root) else None


def merged(problem: Problem) -> Problem:
    """A problem of one site a contour that no plan undercuts: to and from it by the cheapest move."""
    n, first = problem.n, problem.first
    starts = [*first[:-1].tolist(), problem.m]
    everywhere = np.arange(problem.m + 1)
    cost = np.append(problem.site_cost, 0)
    rows = []
    for i in range(n + 1):
        leave = everywhere[first[i] : first[i + 1]] if i < n else everywhere[-1:]
        reach = (problem.travel(leave, everywhere) + cost).min(axis=0)
        rows.append(np.minimum.reduceat(reach, starts))
    nothing = np.zeros(n, dtype=np.int64)
    return replace(
        problem,
        first=np.arange(n + 1, dtype=np.int64),
        site_contour=np.arange(n, dtype=np.int64),
        site_candidate=problem.site_candidate[first[:-1]],
        pierce_um=problem.pierce_um[first[:-1]],
        end_um=problem.end_um[first[:-1]],
        site_cost=nothing,
        conditions=(),
        soft_groups=(),
        general=(),
        crossings=Crossings(),
        matrix=np.stack(rows),
    )
