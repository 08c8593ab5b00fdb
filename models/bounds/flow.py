"""A bound by linear programming: one unit of flow through every contour, and cuts that make it follow the orders.

Every plan is a cycle through home that reaches each contour at one of its sites and leaves it from there. What no
plan does and the cheapest flow may do is cut off: what must lead from one contour to another must do so without what
comes before the one or after the other (Balas, Fischetti and Pulleyblank 1995), and contiguous blocks are entered
once. The bound is worked out from the multipliers over all moves, so that it holds however good they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

from ..problem import Problem
from ..solution import Incumbent, Progress
from .cuts import Cuts, block_cuts, broken_cuts
from .merged import merged
from .moves import least_moves

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

NEAREST = 10
"""Moves from and to every site that are looked at from the start."""
MORE = 8000
"""Moves that are added at once at the most."""
LEAST_GAIN = 3e-4
"""Share of the bound that the last few rounds must bring."""
PATIENCE = 3
ADDITIONS_PER_S = 3.6e7
"""Moves times rounds of the simplex method that a second is counted for."""
MOST_SITES, MOST_CONTOURS = 3000, 1500
"""With more sites contours stand for all of theirs; with more contours there is no bound (it takes too long)."""


@dataclass(frozen=True, slots=True)
class FlowBound:
    """What every plan costs at least, in the problem's unit (µm), and the deterministic seconds spent."""

    bound: int
    work: float


def flow_bound(problem: Problem, plan: Incumbent, work: float, progress: Progress | None = None) -> FlowBound:
    """Bound every plan from below, cutting off what no plan does until it is worth no more rounds.

    Parameters
    ----------
    plan
        A lawful plan: its moves make the flow feasible, and its cost is as high as a bound can be.
    work
        Limit in deterministic seconds; the round in which it is reached is finished.
    progress
        Told the bound after every round, asked whether to go on.
    """
    if not 0 < problem.n <= MOST_CONTOURS:
        return FlowBound(0, 0.0)
    if problem.m > MOST_SITES:
        plan = Incumbent(tuple(int(problem.site_contour[s]) for s in plan.route), plan.cost)
        problem = merged(problem)
    flow, blocks = _Flow(problem, plan), block_cuts(problem)
    cuts, best, seen = blocks, 0.0, [0.0] * PATIENCE
    while flow.cheapest(cuts):
        best = max(best, flow.bound)
        if best > plan.cost - 1 or flow.work > work or (progress and not progress("bound", plan.cost, _whole(best))):
            break
        if flow.complete:
            seen.append(best)
            found = broken_cuts(problem, flow.between, lambda: not progress or progress("bound", plan.cost, None))
            if not len(found) or best < (1 + LEAST_GAIN) * seen[-1 - PATIENCE]:
                break
            kept = flow.binding | (np.arange(len(cuts)) < len(blocks))
            cuts = cuts.only(kept).joined(found)
    return FlowBound(max(0, min(plan.cost, _whole(best))), flow.work)


def _whole(bound: float) -> int:
    """Costs are whole; multipliers are sums of doubles, so a little less than the next whole number is not enough."""
    return int(np.ceil(bound - 1e-9 * abs(bound) - 1e-3))


class _Flow:
    """The linear program over the moves that have been of use so far."""

    def __init__(self, problem: Problem, plan: Incumbent) -> None:
        n, m = problem.n, problem.m
        self._n, self._m = n, m
        self._owner = np.append(problem.site_contour, n)
        self._cost = least_moves(problem)
        self._cost[:, :m] += problem.site_cost
        self._open = np.isfinite(self._cost)
        self._used = np.zeros_like(self._open)
        everywhere, most = np.arange(m + 1), min(NEAREST, m + 1)
        self._used[everywhere[:, None], np.argsort(self._cost, axis=1, kind="stable")[:, :most]] = True
        self._used[np.argsort(self._cost, axis=0, kind="stable")[:most], everywhere[None, :]] = True
        self._used &= self._open
        self._used[[m, *plan.route], [*plan.route, m]] = True
        self.work, self.bound, self.complete = 0.0, 0.0, False
        self.between: Floats = np.zeros((n + 1, n + 1))
        self.binding: Bools = np.zeros(0, dtype=np.bool_)

    def cheapest(self, cuts: Cuts) -> bool:
        """Solve for these cuts; add the moves that would have made it cheaper. False where it cannot be solved."""
        leave, reach = np.nonzero(self._used)
        owner, n, moves = self._owner, self._n, np.arange(len(leave))
        flow = csr_matrix(
            (
                np.repeat([1.0, 1.0, -1.0], len(moves)),
                (np.concatenate([owner[reach], n + 1 + reach, n + 1 + leave]), np.tile(moves, 3)),
            ),
            shape=(n + self._m + 2, len(moves)),
        )
        once = np.repeat([1.0, 0.0], [n + 1, self._m + 1])
        crossing = csr_matrix(cuts.tail[:, owner[leave]] & cuts.head[:, owner[reach]], dtype=np.float64)
        solved = linprog(
            self._cost[leave, reach],
            A_ub=-crossing if len(cuts) else None,
            b_ub=-cuts.least if len(cuts) else None,
            A_eq=flow,
            b_eq=once,
            method="highs",
        )
        if solved.x is None or solved.status != 0:
            return False
        self.work += len(moves) * solved.nit / ADDITIONS_PER_S
        paid = np.maximum(-solved.ineqlin.marginals, 0.0) if len(cuts) else np.zeros(0)
        self._learn(cuts, solved.eqlin.marginals[n + 1 :], paid)
        self.binding = paid > 1e-9
        self.between = np.zeros((n + 1, n + 1))
        np.add.at(self.between, (owner[leave], owner[reach]), solved.x)
        return True

    def _learn(self, cuts: Cuts, price: Floats, paid: Floats) -> None:
        """The bound that these multipliers prove over all moves, and the moves that are missing."""
        owner, m = self._owner, self._m
        taken = (cuts.tail.T * paid) @ cuts.head.astype(np.float64)
        left = self._cost - price[None, :] + price[:, None] - taken[np.ix_(owner, owner)]
        first = np.append(np.searchsorted(owner, np.arange(self._n)), m)
        least = np.minimum.reduceat(left.min(axis=0), first)
        self.bound = float(least.sum() + paid @ cuts.least)
        in_use = np.where(self._used, left, np.inf)
        known = np.minimum.reduceat(in_use.min(axis=0), first)
        missing = np.where(self._used | ~self._open, 0.0, left - known[owner][None, :])
        better = np.flatnonzero(missing.ravel() < -1.0)
        chosen = better[np.argsort(missing.ravel()[better], kind="stable")[:MORE]]
        self._used.ravel()[chosen] = True
        self.complete = not len(better)
