"""What moves cost at least, whatever is out."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem


def least_moves(problem: Problem) -> Floats:
    """Cost of going from the end of one site to the pierce of another, (m + 1, m + 1), home last.

    Infinite for moves that no lawful order has. What soft lags charge for following each other at once is in it, and
    what is crossed that is out in every order that has the move. What depends on the order is not: it can only add.
    """
    everywhere = np.arange(problem.m + 1)
    owner = np.append(problem.site_contour, problem.n)
    move = problem.travel(everywhere, everywhere).astype(np.float64)
    for lag in problem.lags:
        if lag.weight is not None and lag.cuts > 0:
            cost = round(lag.weight * UM_PER_MM) * lag.cuts
            one, other = np.flatnonzero(owner == lag.first), np.flatnonzero(owner == lag.second)
            move[np.ix_(one, other)] += cost
            move[np.ix_(other, one)] += cost
    if len(problem.crossings):
        move += sure_crossings(problem).toarray()
    move[~problem.successors()[np.ix_(owner, owner)]] = np.inf
    return move


def sure_crossings(problem: Problem) -> csr_matrix:
    """What every move, (m + 1, m + 1), costs for what it crosses that is out in every order that has the move."""
    rows, owner = problem.crossings, np.append(problem.site_contour, problem.n)
    sure = _surely_out(problem, rows.over, owner[rows.leave], owner[rows.reach])
    charged = np.where(rows.cost == FORBIDDEN, np.inf, rows.cost)[sure]
    return csr_matrix((charged, (rows.leave[sure], rows.reach[sure])), shape=(problem.m + 1, problem.m + 1))


def _surely_out(problem: Problem, over: Ints, leave: Ints, reach: Ints) -> Bools:
    """Whether contour `over[k]` is out whenever the torch goes from contour `leave[k]` to `reach[k]`; home is n."""
    n = problem.n
    sooner = np.zeros((n, n + 1), dtype=np.bool_)  # must be out before the column; all is, before the way home
    sooner[:, :n], sooner[:, n] = problem.before, True
    at_leave = (leave < n) & ((over == leave) | sooner[over, np.minimum(leave, n - 1)])
    return np.asarray(at_leave | sooner[over, reach])
