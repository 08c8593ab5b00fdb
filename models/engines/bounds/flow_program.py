"""The linear program of a bound by flows, over the moves that have been useful so far."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_matrix, vstack

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.deadline import Deadline

from .flow_work import PRIMAL, look_s, made_s, round_s
from .inequalities import Inequalities
from .network import AllMoves, Multipliers, Network
from .restricted_master import RestrictedMaster
from .separation import Flow

AT_ONCE_S, AT_ONCE = 1.0, 0.2
"""Deterministic seconds from one question whether there is time left to the next; and share of the work that is left,
where that is more, as a program that is broken off often takes longer."""
SHORT_S = 0.5
"""A look at all moves that takes no longer is always had to its end: what was solved last is worth it."""
FEW = 1000
"""Rounds of the simplex method that there is always time for."""
MANY_MOVES, FEWER_MOVES = 8, 5
"""Moves for every site, beyond which the dearest are dropped, and how many stay."""
DEAR_UM = 1.0
"""A move that is no dearer than this is not dropped."""


class FlowProgram:
    """The linear program over the moves that have been useful so far.

    Rows: home and every contour are come to once, every site and home are left as often as come to,
    then the inequalities.
    """

    def __init__(
        self,
        network: Network,
        inequalities: Inequalities,
        plan_um: int,
        in_time: Callable[[], bool] = lambda: True,
        deadline: Deadline | None = None,
    ) -> None:
        problem = network.problem
        n, m = problem.n, problem.m
        self._n, self._m, self._in_time, self._deadline = n, m, in_time, deadline or Deadline()
        self._owner = np.append(problem.site_contour, n)
        self._moves = AllMoves(network, plan_um)
        self._leave, self._reach = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        self._cost: Floats = np.zeros(0)
        once = np.repeat([1.0, 0.0], [n + 1, m + 1])
        self._program = RestrictedMaster(once)
        self._inequalities = inequalities.only(np.zeros(len(inequalities), dtype=np.bool_))
        self._use(*self._moves.nearest())
        self.ask(inequalities)
        self.work = made_s(self._moves.used.size)
        self.bound, self.value, self.complete = 0.0, 0.0, False
        self._idle, self._reduced = np.zeros(0, dtype=np.bool_), np.zeros(0)

    def solve(self, work: float) -> bool:
        """Find the cheapest flow over the moves in use. False where it cannot be found within that work."""
        n, cuts = self._n, len(self._inequalities)
        each_s = round_s(n, self._m, cuts)
        left_s = max(0.0, work - self.work)
        left = FEW + int(left_s / each_s)
        at_once = 1 + int(max(AT_ONCE_S, AT_ONCE * left_s) / each_s)
        solved = None
        while solved is None:
            rows = min(at_once, left)
            if rows <= 0 or not self._in_time():
                return False
            solved = self._program.solve(rows, self._deadline.left_s)
            self.work += (self._program.iterations + 1) * each_s * (PRIMAL if self._program.primal else 1.0)
            left -= self._program.iterations
            if solved is None and self._program.iterations < rows:
                return False
        paid = np.maximum(solved.multiplier[n + self._m + 2 :], 0.0)
        self._idle = paid <= 1e-9
        self._reduced = solved.reduced
        self.moves = Flow(self._leave, self._reach, np.maximum(solved.value, 0.0))
        self.value = float(self._cost @ self.moves.amount)
        self.multipliers = Multipliers(solved.multiplier[n + 1 : n + self._m + 2], paid, self._inequalities)
        return True

    def look_at_all(self) -> None:
        """The bound that the last multipliers prove over all moves; those that would make it cheaper come in."""
        moves = self._moves
        self.work += look_s(moves.used.size)
        self.bound, missing, closes = moves.look(self.multipliers, self._leave, self._reach)
        self.complete = not len(missing[0])
        if closes:
            shut = np.flatnonzero(~np.isfinite(moves.cost[self._leave, self._reach]))
            self._program.limit(shut, np.zeros(len(shut)))
        self._use(*missing)

    def ask(self, found: Inequalities) -> None:
        """Ask for these inequalities, too."""
        self._program.add_rows(found.across(self._leave, self._reach), found.least)
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
        self._moves.used[leave, reach] = True
        self._leave, self._reach = np.append(self._leave, leave), np.append(self._reach, reach)
        n, moves = self._n, np.arange(len(leave))
        entry = np.repeat([1.0, 1.0, -1.0], len(moves))
        rows = np.concatenate([self._owner[reach], n + 1 + reach, n + 1 + leave])
        flow = csr_matrix((entry, (rows, np.tile(moves, 3))), shape=(n + self._m + 2, len(moves)))
        cost = self._moves.cost[leave, reach]
        self._cost = np.append(self._cost, cost)
        self._program.add_columns(cost, vstack([flow, self._inequalities.across(leave, reach)]))

    def drop_dear(self, in_use: Bools) -> Bools:
        """Drop the moves that the last multipliers leave dearest where there are many, and say which moves stay.

        Those `in_use` (moves,) stay, and those that have come since.
        """
        known, sites = len(self._reduced), self._m + 1
        kept = np.ones(len(self._leave), dtype=np.bool_)
        if known > MANY_MOVES * sites:
            enough = max(float(np.partition(self._reduced, FEWER_MOVES * sites)[FEWER_MOVES * sites]), DEAR_UM)
            kept[:known] = in_use[:known] | (self._reduced <= enough)
            kept |= self._moves.is_own(self._leave, self._reach)
        gone = np.flatnonzero(~kept)
        self._program.drop_columns(gone)
        self._moves.used[self._leave[gone], self._reach[gone]] = False
        self._leave, self._reach, self._cost = self._leave[kept], self._reach[kept], self._cost[kept]
        self._reduced = self._reduced[kept[:known]]
        return kept
