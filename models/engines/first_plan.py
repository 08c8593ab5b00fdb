"""A first plan where sums want contours out early, or late: laid out from its end.

Of contours that must be out while no more than so much else is, one that may come last of all that is left can be put
there without a loss: whatever else comes before it has as much time as before (Lawler 1973, for jobs with deadlines and
orders). So a plan is found at once where a search, which repairs one sum and breaks another, finds none. Runs and sums
that want something out first may lead it into a dead end; then there is no answer, and nothing is lost.
"""

from __future__ import annotations

import numpy as np

from kerfwise.models.engines.tuning import EARLY_LONG as LONG
from kerfwise.models.problem.conditions import Condition, ConditionRows
from kerfwise.models.problem.problem import Problem


def wants_early(problem: Problem) -> bool:
    """Whether hard sums want contours out before much else is."""
    hard = (c for c in problem.conditions if c.cost is None and len(c.members) > LONG)
    return any(sum(weight < 0 for weight in c.weights) > LONG for c in hard)


def route_from_its_end(problem: Problem) -> tuple[int, ...] | None:
    """A route, each contour as near to the one after it as may be; None where it comes to a dead end.

    It may break lags and sums within sums, and makes a move that is not lawful where only such are left: a search mends
    that.
    """
    n, m = problem.n, problem.m
    sums = _Sums(problem)
    to_come = problem.before.sum(axis=1)  # contours that come after each and have no place yet
    left = np.ones(n, dtype=np.bool_)
    block_left = np.bincount(problem.block, minlength=n)
    backwards: list[int] = []
    last = m
    for _ in range(n):
        ready = left & (to_come == 0)
        if backwards and block_left[block := problem.block[problem.site_contour[last]]]:
            ready &= problem.block == block
        cost = problem.travel(np.arange(m), np.array([last]))[:, 0].astype(np.float64)
        cost += problem.site_cost + sums.unmet()
        cost[~ready[problem.site_contour]] = np.inf
        last = int(np.argmin(cost))
        if not np.isfinite(cost[last]):
            return None
        contour = int(problem.site_contour[last])
        left[contour] = False
        block_left[problem.block[contour]] -= 1
        to_come -= problem.before[:, contour]
        sums.put_last(contour)
        backwards.append(last)
    return tuple(reversed(backwards))


# Sums that no order can hold: some contours of which none can come last, or none first.


def impossible(problem: Problem) -> tuple[Condition, ...]:
    """Hard conditions that show that no order holds them all; none where that is not shown.

    A contour leaves the set where it may come last in it: no order puts another of the set behind it, and with all of
    these out, and what else helps, its conditions hold for some way to cut it. What is left has no last contour, and so
    no order. Likewise from the beginning. Runs, moves and lags are not asked.
    """
    hard = [c for c in problem.conditions if c.cost is None]
    if not hard:
        return ()
    of, when, bound, row, member, weight = ConditionRows.of(hard)
    weight[member == of[row]] = 0
    before, helps = problem.before, np.maximum(weight, 0)
    for last, order in ((True, before), (False, before.T)):
        left = np.ones(problem.n, dtype=np.bool_)
        while left.any():
            inside = weight if last else np.zeros_like(weight)
            value = np.zeros(len(hard), dtype=np.int64)
            np.add.at(value, row, np.where(left[member], inside, helps))
            unmet = value < bound
            shut = np.zeros(problem.m, dtype=np.bool_)
            shut[when[unmet & (when >= 0)]] = True
            shut |= np.isin(problem.site_contour, of[unmet & (when < 0)])
            at_end = left & ~order[:, left].any(axis=1)
            leaves = at_end & ~np.logical_and.reduceat(shut, problem.first[:-1])
            if not leaves.any():
                return tuple(c for c, wrong in zip(hard, unmet & at_end[of], strict=True) if wrong)
            left &= ~leaves
    return ()


class _Sums:
    """What the conditions come to while all contours that are left are out."""

    def __init__(self, problem: Problem) -> None:
        self._problem, given = problem, problem.conditions
        rows = ConditionRows.of(given)
        rows.weight[rows.member == rows.contour[rows.row]] = 0
        self._of, self._site, self._bound = rows.contour, rows.site, rows.bound
        self._price = np.array([np.inf if c.cost is None else float(c.cost) for c in given])
        self._value = np.zeros(len(given), dtype=np.int64)
        np.add.at(self._value, rows.row, rows.weight)
        self._first, self._row, self._weight = rows.by_member(problem.n)

    def unmet(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """What each site costs, (m,), if its contour comes last of all that is left."""
        problem, unmet = self._problem, self._value < self._bound
        of_contour, of_site = np.zeros(problem.n), np.zeros(problem.m)
        whole = unmet & (self._site < 0)
        np.add.at(of_contour, self._of[whole], self._price[whole])
        sited = unmet & (self._site >= 0)
        np.add.at(of_site, self._site[sited], self._price[sited])
        return of_site + of_contour[problem.site_contour]

    def put_last(self, contour: int) -> None:
        """A contour is no longer among those that are left."""
        mine = slice(self._first[contour], self._first[contour + 1])
        np.subtract.at(self._value, self._row[mine], self._weight[mine])
