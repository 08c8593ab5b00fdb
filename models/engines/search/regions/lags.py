"""Contours that should not follow each other, as prices of moves between pieces."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.models.problem.problem import Problem

from .pieces import Pieces

UNLAWFUL = 1 << 44
"""More than any plan costs, µm; sums of a few thousand are whole numbers of 8 bytes still."""


class LaggedBy:
    """The lags of one problem, of one cut each."""

    def __init__(self, problem: Problem) -> None:
        lags = [lag for lag in problem.lags if lag.cuts > 0]
        self._pair = np.array([(lag.first, lag.second) for lag in lags], dtype=np.int64).reshape(-1, 2)
        self._cost = np.array([UNLAWFUL if lag.weight is None else cost_um(lag.weight) for lag in lags], dtype=np.int64)

    def add_to(self, matrix: Ints, pieces: Pieces) -> None:
        """Add what it costs that the last contour of a piece is followed by the first of another."""
        is_first, is_last = (np.zeros(len(pieces.of_contour), dtype=np.bool_) for _ in range(2))
        is_first[pieces.leader], is_last[pieces.closer] = True, True
        for leave, reach in (self._pair.T, self._pair.T[::-1]):
            a, b = pieces.of_contour[leave], pieces.of_contour[reach]
            for k in np.flatnonzero(is_last[leave] & is_first[reach] & (a != b)).tolist():
                rows = slice(pieces.first[a[k]], pieces.first[a[k] + 1])
                columns = slice(pieces.first[b[k]], pieces.first[b[k] + 1])
                matrix[rows, columns] += self._cost[k]
