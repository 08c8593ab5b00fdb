"""A bound by linear programming: a unit of flow through every contour, and inequalities for the orders.

Every plan is a cycle through home that reaches each contour at one of its sites and leaves it from there. What no
plan does and the cheapest flow may do is cut off: what must lead from one contour to another must do so without what
comes before the one or after the other (Balas, Fischetti and Pulleyblank 1995), contiguous blocks are entered once, and
a site that needs its neighbours in, or out, needs flow in that order. The bound is worked out from the multipliers
over all moves, so that it holds however good they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, hstack, vstack

from kerfwise.arrays import Floats, Ints
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.problem.problem import Problem

from .demands import DemandColumns
from .inequalities import Inequalities, block_inequalities
from .merged import merged
from .network import Network, network_of
from .restricted_master import restricted_master
from .separation import Flow, Separation

NEAREST = 3
"""Moves from and to every site that are looked at from the start."""
MORE = 8000
"""Moves that are added at once at the most."""
EVERY, EVERY_WIDE, WIDE = 1, 2, 2000
"""Rounds of cuts from one look at all moves to the next; and where there are more sites than so many."""
MARGIN_UM = 0.5
"""Plans cost whole numbers: one that is cheaper than the known one costs 1 less."""
LEAST_GAIN = 3e-4
"""Share of the bound that the last few rounds must bring."""
PATIENCE = 20
CROWD = 3
"""Inequalities per contour, beyond which those are dropped that nothing is paid for."""
RISEN = 1e-5
"""Share by which the bound has risen before inequalities are dropped again: else the same ones come back in turn."""
ADDITIONS_PER_S = 3.6e7
"""Moves times rounds of the simplex method that a second is counted for."""
FEW = 1000
"""Rounds of the simplex method that there is always time for."""
PRODUCTS_PER_S = 1.2e10
"""Of multipliers and moves, in the same way."""
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
    network = network_of(problem, plan.route, plan.cost, MOST_SITES)
    problem = network.problem
    demands = DemandColumns(problem)
    separation = Separation(network, demands)
    blocks = block_inequalities(problem, len(demands.cost))
    flow, best, seen = _Flow(network, blocks, demands.cost, plan.cost), 0.0, [0.0] * PATIENCE
    dropped_at = 0.0
    rounds, found, every = 0, None, EVERY_WIDE if problem.m > WIDE else EVERY
    while flow.solve(work):
        if rounds % every == 0 or (found is not None and not len(found)):
            flow.look_at_all()
        rounds += 1
        best = max(best, flow.bound)
        if best > plan.cost - 1 or flow.work > work or (progress and not progress("bound", plan.cost, _whole(best))):
            break
        before = separation.work
        found = separation.broken(flow.moves, flow.beside, lambda: not progress or progress("bound", plan.cost, None))
        flow.work += separation.work - before
        seen.append(best)
        if (flow.complete and not len(found)) or best < (1 + LEAST_GAIN) * seen[-1 - PATIENCE]:
            break
        if (flow.complete or flow.inequalities > CROWD * problem.n) and best > (1 + RISEN) * dropped_at:
            flow.drop_idle(len(blocks))
            dropped_at = best
        flow.ask(found)
    flow.look_at_all()
    best = max(best, flow.bound)
    return FlowBound(max(0, min(plan.cost, _whole(best))), flow.work)


def _whole(bound: float) -> int:
    """Costs are whole; multipliers are sums of doubles, so a little less than the next whole number is not enough."""
    return int(np.ceil(bound - 1e-9 * abs(bound) - 1e-3))


class _Flow:
    """The linear program over the moves that have been useful so far.

    Rows: home and every contour are come to once, every site and home are left as often as come to,
    then the inequalities.
    """

    def __init__(self, network: Network, inequalities: Inequalities, beside: Floats, plan_um: int) -> None:
        problem = network.problem
        n, m = problem.n, problem.m
        self._n, self._m = n, m
        self._owner = np.append(problem.site_contour, n)
        self._cost, self._plan_um = network.cost, plan_um
        self._open = np.isfinite(self._cost)
        self._used = np.zeros_like(self._open)
        self._leave, self._reach = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        everywhere, most = np.arange(m + 1), min(NEAREST, m + 1)
        wanted = np.zeros_like(self._open)
        wanted[everywhere[:, None], np.argsort(self._cost, axis=1, kind="stable")[:, :most]] = True
        wanted[np.argsort(self._cost, axis=0, kind="stable")[:most], everywhere[None, :]] = True
        wanted &= self._open
        self._own = (np.array([m, *network.plan]), np.array([*network.plan, m]))
        wanted[self._own] = True
        once = np.repeat([1.0, 0.0], [n + 1, m + 1])
        self._program = restricted_master(once)
        self._beside_cost = beside
        self._program.add_columns(beside, csr_matrix((len(once), len(beside))), 1.0)
        self._inequalities = inequalities.only(np.zeros(len(inequalities), dtype=np.bool_))
        self._use(*np.nonzero(wanted))
        self.ask(inequalities)
        self.work, self.bound, self.complete = 0.0, 0.0, False
        self._idle = np.zeros(0, dtype=np.bool_)
        self._prices: tuple[Floats, Floats, Inequalities] | None = None

    def solve(self, work: float) -> bool:
        """Find the cheapest flow over the moves in use. False where it cannot be found within that work."""
        left = max(0.0, work - self.work) * ADDITIONS_PER_S / len(self._leave)
        solved = self._program.solve(FEW + int(left))
        if solved is None:
            return False
        n = self._n
        self.work += len(self._leave) * (solved.iterations + 1) / ADDITIONS_PER_S
        paid = np.maximum(solved.multiplier[n + self._m + 2 :], 0.0)
        self._idle = paid <= 1e-9
        columns = len(self._beside_cost)
        self.beside = np.clip(solved.value[:columns], 0.0, 1.0)
        self.moves = Flow(self._leave, self._reach, np.maximum(solved.value[columns:], 0.0))
        self._prices = (solved.multiplier[n + 1 : n + self._m + 2], paid, self._inequalities)
        return True

    def look_at_all(self) -> None:
        """The bound that the last multipliers prove over all moves; those that would make it cheaper come in."""
        if self._prices is not None:
            self.work += (len(self._prices[2]) + 10) * self._open.size / PRODUCTS_PER_S
            self._learn(*self._prices)
            self._prices = None

    def ask(self, found: Inequalities) -> None:
        """Ask for these inequalities, too."""
        entries = hstack([found.beside, found.across(self._leave, self._reach)], format="csr")
        self._program.add_rows(entries, found.least)
        self._inequalities = self._inequalities.joined(found)

    @property
    def inequalities(self) -> int:
        """Number of inequalities."""
        return len(self._inequalities)

    def drop_idle(self, kept: int) -> None:
        """Drop the inequalities that nothing is paid for, but for the first few."""
        idle = self._idle & (np.arange(len(self._idle)) >= kept)
        self._program.drop_rows(self._n + self._m + 2 + np.flatnonzero(idle))
        self._inequalities = self._inequalities.only(~idle)

    def _use(self, leave: Ints, reach: Ints) -> None:
        """Let more moves be made."""
        self._used[leave, reach] = True
        self._leave, self._reach = np.append(self._leave, leave), np.append(self._reach, reach)
        n, moves = self._n, np.arange(len(leave))
        entry = np.repeat([1.0, 1.0, -1.0], len(moves))
        rows = np.concatenate([self._owner[reach], n + 1 + reach, n + 1 + leave])
        flow = csr_matrix((entry, (rows, np.tile(moves, 3))), shape=(n + self._m + 2, len(moves)))
        self._program.add_columns(self._cost[leave, reach], vstack([flow, self._inequalities.across(leave, reach)]))

    def _learn(self, price: Floats, paid: Floats, inequalities: Inequalities) -> None:
        """The bound that these multipliers prove over all moves, and the moves that are missing."""
        owner, m = self._owner, self._m
        left = self._cost - price[None, :] + price[:, None] - inequalities.worth(paid)
        first = np.append(np.searchsorted(owner, np.arange(self._n)), m)
        least = np.minimum.reduceat(left.min(axis=0), first)
        beside = self._beside_cost - inequalities.beside.T @ paid  # between 0 and 1 each
        self.bound = float(least.sum() + paid @ inequalities.least + np.minimum(beside, 0.0).sum())
        in_use = np.where(self._used, left, np.inf)
        known = np.minimum.reduceat(in_use.min(axis=0), first)
        missing = np.where(self._used | ~self._open, 0.0, left - known[owner][None, :])
        better = np.flatnonzero(missing.ravel() < -1.0)
        chosen = better[np.argsort(missing.ravel()[better], kind="stable")[:MORE]]
        self.complete = not len(better)
        self._close(left - np.repeat(least, np.diff(np.append(first, m + 1)))[None, :])
        chosen = chosen[self._open.ravel()[chosen]]
        if len(chosen):
            self._use(*np.divmod(chosen, m + 1))

    def _close(self, dearer: Floats) -> None:
        """Close the moves without which all plans are that cost less than the known one: they are `dearer` (m + 1,
        m + 1) than what is left to it above the bound. The known plan's own stay, so that there is always a flow."""
        closed = self._open & (self.bound + dearer > self._plan_um - MARGIN_UM)
        closed[self._own] = False
        if not closed.any():
            return
        self._open[closed] = False
        self._cost[closed] = np.inf
        stays = np.ones(self._m + 1, dtype=np.bool_)
        stays[:-1] = self._open[:, :-1].any(axis=0) & self._open[:-1].any(axis=1)
        self._open &= stays[:, None] & stays[None, :]
        self._cost[~self._open] = np.inf
        self._program.close(len(self._beside_cost) + np.flatnonzero(~self._open[self._leave, self._reach]))
