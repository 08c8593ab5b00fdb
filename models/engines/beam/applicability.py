"""Which problems the beam takes."""

from __future__ import annotations

import numpy as np

from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.models.problem.problem import Problem

from .tables import NEVER

MOST_SITES = 4000
"""More would make the tables of moves, from both ends, larger than 400 MB."""


def applies(problem: Problem) -> bool:
    """Whether a state of the beam holds all that a step costs, and its tables hold the numbers."""
    return problem.looks_one_back and problem.m <= MOST_SITES and _dearest(problem) < NEVER


def _dearest(problem: Problem) -> float:
    """What no move costs more than, but for what it crosses."""
    lags = sum(cost_um(lag.weight) for lag in problem.lags if lag.weight is not None)
    if problem.matrix is not None:
        return float(problem.matrix.max()) + lags
    points = np.vstack([problem.ends(), problem.pierces()]).astype(np.float64)
    return problem.travel_weight * float(np.linalg.norm(np.ptp(points, axis=0))) + lags + 1
