"""A smaller problem that bounds a large one: contours stand for all their sites."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..crossings import Crossings
from ..problem import Problem
from .moves import least_moves

FAR = 1e11
"""What an unlawful move costs where moves are whole numbers."""


def merged(problem: Problem) -> Problem:
    """A problem of one site a contour that no plan undercuts: to and from it by the cheapest move."""
    n, starts = problem.n, [*problem.first[:-1].tolist(), problem.m]
    move = least_moves(problem)
    move[:, : problem.m] += problem.site_cost
    least = np.minimum.reduceat(np.minimum.reduceat(move, starts, axis=0), starts, axis=1)
    return replace(
        problem,
        first=np.arange(n + 1, dtype=np.int64),
        site_contour=np.arange(n, dtype=np.int64),
        site_candidate=problem.site_candidate[problem.first[:-1]],
        pierce_um=problem.pierce_um[problem.first[:-1]],
        end_um=problem.end_um[problem.first[:-1]],
        site_cost=np.zeros(n, dtype=np.int64),
        conditions=(),
        soft_groups=(),
        lags=tuple(lag for lag in problem.lags if lag.weight is None),
        general=(),
        crossings=Crossings(),
        matrix=np.minimum(least, FAR).astype(np.int64),
    )
