"""Moves over parts that may be out: what the hard orders decide of them, and what stays open."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from kerfwise.arrays import Int32s, Ints
from kerfwise.models.problem.problem import Problem


class Out(IntEnum):
    """Whether the contour that a move crosses is out by the time of the move."""

    NO = 0
    YES = 1
    OPEN = 2


def out_by_then(problem: Problem) -> Ints:
    """For every row of the problem's crossings an `Out`."""
    rows, n = problem.crossings, problem.n
    contour = np.append(problem.site_contour, n)
    leave, reach, over = contour[rows.leave], contour[rows.reach], rows.over
    before = np.zeros((n + 1, n + 1), dtype=np.bool_)
    before[:n, :n] = problem.before
    no = (leave == n) | (over == reach) | before[leave, over]
    yes = (reach == n) | (over == leave) | before[over, leave]
    return np.where(no, Out.NO, np.where(yes, Out.YES, Out.OPEN)).astype(np.int64)


def arc_of_move(m: int, tail: Ints, head: Ints, leave: Ints | Int32s, reach: Ints | Int32s) -> Ints:
    """The arc of every move from a site to a site, -1 where there is none."""
    past_all = (m + 1) ** 2
    keys, wanted = np.append(tail * (m + 1) + head, past_all), leave.astype(np.int64) * (m + 1) + reach
    order = np.argsort(keys, kind="stable")
    found = order[np.searchsorted(keys, wanted, sorter=order)]
    return np.where(keys[found] == wanted, found, -1)
