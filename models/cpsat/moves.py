"""Moves over parts that may be out: what the hard orders decide of them, and what stays open."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem


class Out(IntEnum):
    """Whether the contour that a move crosses is out by the time of the move."""

    NO = 0
    YES = 1
    OPEN = 2


def out_by_then(problem: Problem) -> NDArray[np.int64]:
    """For every row of the problem's crossings an `Out`."""
    rows, n = problem.crossings, problem.n
    contour = np.append(problem.site_contour, n)
    leave, reach, over = contour[rows.leave], contour[rows.reach], rows.over
    before = np.zeros((n + 1, n + 1), dtype=np.bool_)
    before[:n, :n] = problem.before
    no = (leave == n) | (over == reach) | before[leave, over]
    yes = (reach == n) | (over == leave) | before[over, leave]
    return np.where(no, Out.NO, np.where(yes, Out.YES, Out.OPEN)).astype(np.int64)
