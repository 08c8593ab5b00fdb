"""Which contours lie near each other on the sheet."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.models.problem.problem import Problem

NEIGHBOURS = 200
"""Contours near a contour that are kept in mind."""


class Nearby:
    """The contours of a problem by where they are pierced. `travel_um` is what a move to the nearest costs about."""

    def __init__(self, problem: Problem) -> None:
        from scipy.spatial import KDTree

        self._problem = problem
        starts = problem.first[:-1]
        centre = np.add.reduceat(problem.pierce_um.astype(np.float64), starts) / np.diff(problem.first)[:, None]
        away, self._near = KDTree(centre).query(centre, k=min(NEIGHBOURS, problem.n))
        self.travel_um = max(1.0, float(problem.travel_weight) * float(np.median(away[:, 1])))

    def around(self, centre: int, movable: Bools, count: int) -> Bools:
        """About so many movable contours nearest to one, whole blocks, (n,)."""
        near = self._near[centre]
        near = near[movable[near]][:count]
        free = np.isin(self._problem.block, self._problem.block[near])
        return free & movable
