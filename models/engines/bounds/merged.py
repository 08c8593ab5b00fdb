"""A smaller problem that bounds a large one: contours stand for all their sites."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.links import Links
from kerfwise.models.problem.problem import Problem

from .moves import sure_crossings

FAR = 1e11
"""What an unlawful move costs where moves are whole numbers."""


def merged(problem: Problem) -> Problem:
    """A problem of one site a contour that no plan undercuts: to and from it by the cheapest move."""
    n, m, first = problem.n, problem.m, np.append(problem.first, problem.m + 1)
    charged = sure_crossings(problem) if len(problem.crossings) else None
    least = np.empty((n + 1, n + 1))
    for contour in range(n + 1):  # the table of all sites is too large to be made at once
        sites = np.arange(first[contour], first[contour + 1])
        move = problem.travel(sites, np.arange(m + 1)).astype(np.float64)
        move[:, :m] += problem.site_cost
        if charged is not None:
            move += charged[sites].toarray()
        least[contour] = np.minimum.reduceat(move.min(axis=0), first[:-1])
    least[~problem.successors()] = np.inf
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
        general=(),
        crossings=Crossings(),
        links=Links(),
        matrix=np.minimum(least, FAR).astype(np.int64),
    )
