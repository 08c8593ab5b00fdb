"""What moves cost at least, whatever is out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem

Floats = NDArray[np.float64]


def least_moves(problem: Problem) -> Floats:
    """Cost of going from the end of one site to the pierce of another, (m + 1, m + 1), home last.

    Infinite for moves that no lawful order has. What a move costs on top for parts that are out, for lags and for
    groups left early is not in it: it can only add.
    """
    everywhere = np.arange(problem.m + 1)
    owner = np.append(problem.site_contour, problem.n)
    move = problem.travel(everywhere, everywhere).astype(np.float64)
    move[~problem.successors()[np.ix_(owner, owner)]] = np.inf
    return move
