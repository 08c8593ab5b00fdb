"""The linear program of a bound by flows, over the moves that have been useful so far."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix, hstack, vstack

from kerfwise.arrays import Bools, Floats, Ints

from .inequalities import Inequalities
from .network import Network
from .restricted_master import restricted_master
from .separation import Flow

NEAREST = 3
"""Moves from and to every site that are looked at from the start."""
MORE = 8000
"""Moves that are added at once at the most."""
MARGIN_UM = 0.5
"""Plans cost whole numbers: one that is cheaper than the known one costs 1 less."""
ADDITIONS_PER_S = 3.6e7
"""Moves times rounds of the simplex method that a second is counted for."""
FEW = 1000
"""Rounds of the simplex method that there is always time for."""
PRODUCTS_PER_S = 1.2e10
"""Of multipliers and moves, in the same way."""


class FlowProgram:
    """The linear program over the moves that have been useful so far.

    Rows: home and every contour are come to once, every site and home are left as often as come to,
    then the inequalities.
    """

    def __init__(self, network: Network, inequalities: Inequalities, beside: Floats, plan_um: int) -> None:
        problem = network.problem
        n, m = problem.n, problem.m
        self._n, self._m = n, m
        self.owner = np.append(problem.site_contour, n)
        self._all_costs = network.cost
        self._cost, self.plan_um = network.cost.copy(), plan_um
        self.open = np.isfinite(self._cost)
        self._used = np.zeros_like(self.open)
        self._leave, self._reach = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        everywhere, most = np.arange(m + 1), min(NEAREST, m + 1)
        wanted = np.zeros_like(self.open)
        wanted[everywhere[:, None], np.argsort(self._cost, axis=1, kind="stable")[:, :most]] = True
        wanted[np.argsort(self._cost, axis=0, kind="stable")[:most], everywhere[None, :]] = True
        wanted &= self.open
        self._forced = np.zeros_like(self.open)
        self._own = (np.array([m, *network.plan]), np.array([*network.plan, m]))
        wanted[self._own] = True
        once = np.repeat([1.0, 0.0], [n + 1, m + 1])
        self._program = restricted_master(once)
        self._beside_cost = beside
        self._program.add_columns(beside, csr_matrix((len(once), len(beside))), 1.0)
        self._inequalities = inequalities.only(np.zeros(len(inequalities), dtype=np.bool_))
        self._use(*np.nonzero(wanted))
        self.ask(inequalities)
        self.work, self.bound, self.complete, self.restricted = 0.0, 0.0, False, False
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

    def look_at_all(self) -> bool:
        """The bound that the last multipliers prove over all moves; those that would make it cheaper come in.

        False where that is known already.
        """
        if self._prices is None:
            return False
        self.work += (len(self._prices[2]) + 10) * self.open.size / PRODUCTS_PER_S
        self._learn(*self._prices)
        self._prices = None
        return True

    def ask(self, found: Inequalities) -> None:
        """Ask for these inequalities, too."""
        entries = hstack([found.beside, found.across(self._leave, self._reach)], format="csr")
        self._program.add_rows(entries, found.least)
        self._inequalities = self._inequalities.joined(found)

    def contours_used(self) -> Floats:
        """How much goes from contour to contour, (n + 1, n + 1), home last."""
        used = np.zeros((self._n + 1, self._n + 1))
        np.add.at(used, (self.owner[self.moves.leave], self.owner[self.moves.reach]), self.moves.amount)
        return used

    def sites_used(self) -> Floats:
        """How much comes to every site and home, (m + 1,)."""
        return np.bincount(self.moves.reach, self.moves.amount, self._m + 1).astype(np.float64)

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
        rows = np.concatenate([self.owner[reach], n + 1 + reach, n + 1 + leave])
        flow = csr_matrix((entry, (rows, np.tile(moves, 3))), shape=(n + self._m + 2, len(moves)))
        self._program.add_columns(self._cost[leave, reach], vstack([flow, self._inequalities.across(leave, reach)]))

    def _learn(self, price: Floats, paid: Floats, inequalities: Inequalities) -> None:
        """The bound that these multipliers prove over all moves, and the moves that are missing."""
        owner, m = self.owner, self._m
        left = self._cost - price[None, :] + price[:, None] - inequalities.worth(paid)
        first = np.append(np.searchsorted(owner, np.arange(self._n)), m)
        least = np.minimum.reduceat(left.min(axis=0), first)
        beside = self._beside_cost - inequalities.beside.T @ paid  # between 0 and 1 each
        self.bound = float(least.sum() + paid @ inequalities.least + np.minimum(beside, 0.0).sum())
        in_use = np.where(self._used, left, np.inf)
        known = np.minimum.reduceat(in_use.min(axis=0), first)
        missing = np.where(self._used | ~self.open, 0.0, left - known[owner][None, :])
        better = np.flatnonzero(missing.ravel() < -1.0)
        chosen = better[np.argsort(missing.ravel()[better], kind="stable")[:MORE]]
        self.complete = not len(better)
        self._close(left - np.repeat(least, np.diff(np.append(first, m + 1)))[None, :])
        chosen = chosen[self.open.ravel()[chosen]]
        if len(chosen):
            self._use(*np.divmod(chosen, m + 1))

    def _close(self, dearer: Floats) -> None:
        """Close the moves without which all plans are that cost less than the known one: they are `dearer` (m + 1,
        m + 1) than what is left to it above the bound. The known plan's own stay, so that there is always a flow."""
        closed = self.open & (self.bound + dearer > self.plan_um - MARGIN_UM)
        closed[self._own] = False
        if not closed.any():
            return
        self.open[closed] = False
        self._cost[closed] = np.inf
        stays = np.ones(self._m + 1, dtype=np.bool_)
        stays[:-1] = self.open[:, :-1].any(axis=0) & self.open[:-1].any(axis=1)
        self.open &= stays[:, None] & stays[None, :]
        self._cost[~self.open] = np.inf
        shut = np.flatnonzero(~self.open[self._leave, self._reach])
        self._program.limit(len(self._beside_cost) + shut, np.zeros(len(shut)))

    def restrict(self, allowed: Bools) -> None:
        """Go on with these moves alone, (m + 1, m + 1).

        The known plan's own stay, so that there is always a flow; those not among them cost as much as a plan more.
        """
        self.open, self.restricted, self.bound = allowed.copy(), True, 0.0
        self.open[self._own] = True
        self._cost = np.where(self.open, self._all_costs, np.inf)
        self._forced = np.zeros_like(allowed)
        self._forced[self._own] = ~allowed[self._own]
        self._cost[self._forced] += self.plan_um
        moves = len(self._beside_cost) + np.arange(len(self._leave))
        here = self.open[self._leave, self._reach]
        self._program.limit(moves, np.where(here, np.inf, 0.0))
        own = np.flatnonzero(
            np.isin(self._leave * (self._m + 1) + self._reach, self._own[0] * (self._m + 1) + self._own[1])
        )
        self._program.price(moves[own], self._cost[self._leave[own], self._reach[own]])

    @property
    def allowed(self) -> Bools:
        """The moves that are left, without those of the known plan that stay although they are not allowed."""
        return self.open & ~self._forced
