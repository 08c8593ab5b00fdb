"""Which problems the beam takes."""

from __future__ import annotations

import numpy as np

from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.models.problem.problem import Problem

from .tables import NEVER

MOST_SITES = 4000
"""More would make the tables of moves, from both ends, larger than 400 MB."""


def unfit(problem: Problem) -> str:
    """Why the beam cannot be used; empty where a state holds all that a step costs, and the tables hold the numbers."""
    if problem.further_back is not None:
        return f"rule {problem.further_back.rule} looks further back than the last cut"
    if problem.m > MOST_SITES:
        return f"it takes up to {MOST_SITES} ways to cut, there are {problem.m}"
    return "" if _dearest(problem) < NEVER else "a move costs more than its tables hold"


def _dearest(problem: Problem) -> float:
    """What no move costs more than, but for what it crosses."""
    lags = sum(cost_um(lag.weight) for lag in problem.lags if lag.weight is not None)
    if problem.matrix is not None:
        return float(problem.matrix.max()) + lags
    points = np.vstack([problem.ends(), problem.pierces()]).astype(np.float64)
    return problem.travel_weight * float(np.linalg.norm(np.ptp(points, axis=0))) + lags + 1
