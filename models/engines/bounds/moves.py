"""What moves cost at least, whatever is out."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Floats, Int32s, Ints
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem


class Moves:
    """What it costs at least to go from the end of one site to the pierce of another, from site to site.

    Infinite for moves that no lawful order has. What soft lags charge for following each other at once is in it, and
    what is crossed that is out in every order that has the move. What depends on the order is not: it can only add.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, n = problem, problem.n
        self._owner = np.append(problem.site_contour, n)
        self._extra: Floats = np.where(problem.successors(), 0.0, np.inf)
        for lag in problem.lags:
            if lag.weight is not None and lag.cuts > 0:
                cost = round(lag.weight * UM_PER_MM) * lag.cuts
                self._extra[lag.first, lag.second] += cost
                self._extra[lag.second, lag.first] += cost
        self._charged = sure_crossings(problem) if len(problem.crossings) else None

    def between(self, leave: Ints, reach: Ints) -> Floats:
        """From each site in `leave` (k,) to each in `reach` (l,), (k, l); home is site m."""
        move: Floats = self._problem.travel(leave, reach) + self._extra[np.ix_(self._owner[leave], self._owner[reach])]
        if self._charged is not None:
            move += self._charged[leave][:, reach].toarray()
        return move


def least_moves(problem: Problem) -> Floats:
    """All `Moves`, (m + 1, m + 1), home last."""
    everywhere = np.arange(problem.m + 1)
    return Moves(problem).between(everywhere, everywhere)


def sure_crossings(problem: Problem) -> csr_matrix:
    """What every move, (m + 1, m + 1), costs for what it crosses that is out in every order that has the move."""
    rows, owner = problem.crossings, np.append(problem.site_contour, problem.n)
    sure = _surely_out(problem, rows.over, owner[rows.leave], owner[rows.reach])
    charged = np.where(rows.cost == FORBIDDEN, np.inf, rows.cost)[sure]
    return csr_matrix((charged, (rows.leave[sure], rows.reach[sure])), shape=(problem.m + 1, problem.m + 1))


def open_crossings(problem: Problem) -> Bools:
    """Which rows of its crossings depend on the order: what is crossed may be out already, or still in."""
    rows, owner = problem.crossings, np.append(problem.site_contour, problem.n)
    leave, reach = owner[rows.leave], owner[rows.reach]
    inside = np.minimum(reach, problem.n - 1)
    still = (leave == problem.n) | ((reach < problem.n) & ((rows.over == reach) | problem.before[inside, rows.over]))
    return np.asarray(~still & ~_surely_out(problem, rows.over, leave, reach))


def _surely_out(problem: Problem, over: Ints | Int32s, leave: Ints, reach: Ints) -> Bools:
    """Whether contour `over[k]` is out whenever the torch goes from contour `leave[k]` to `reach[k]`; home is n."""
    n = problem.n
    at_leave = (leave < n) & ((over == leave) | problem.before[over, np.minimum(leave, n - 1)])
    at_reach = (reach == n) | problem.before[over, np.minimum(reach, n - 1)]  # before the way home all is out
    return np.asarray(at_leave | at_reach)
