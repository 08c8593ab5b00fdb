"""The linear program of a bound by flows, over the moves that have been useful so far."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import highspy
import numpy as np
from scipy.sparse import csr_matrix, vstack

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import look_s, made_s, simplex_round_s
from kerfwise.models.engines.tuning import DEAR_UM, FEWER_MOVES, MANY_MOVES, PRIMAL
from kerfwise.models.engines.tuning import PROGRAM_AT_ONCE as AT_ONCE
from kerfwise.models.engines.tuning import PROGRAM_AT_ONCE_S as AT_ONCE_S
from kerfwise.models.engines.tuning import PROGRAM_FEW as FEW

from .network import AllMoves, Inequalities, Multipliers, Network
from .separation import Flow


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
        each_s = simplex_round_s(n, self._m, cuts)
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


# A linear program that grows by columns and rows, and is solved on from its last basis (Huangfu and Hall 2018).

BY_DUAL, BY_PRIMAL = 1, 4
"""Ways of the simplex method, as HiGHS numbers them. Where nothing but columns came, the last solution is still lawful,
and the primal one goes on from it in a third of the time."""
MOST_ROUNDS = 2**31 - 1
"""The highest limit of rounds that HiGHS takes."""


@dataclass(frozen=True, eq=False, slots=True)
class MasterSolution:
    """A solution: the value of every column, the multiplier of every row, and what these leave of columns' costs."""

    value: Floats
    multiplier: Floats
    reduced: Floats


class _Quiet(highspy.Highs):
    """HiGHS without callbacks: to set any prints its name, and keeps the program in memory for longer."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]

    def enableCallbacks(self) -> None:
        self.callbacks.clear()


class RestrictedMaster:
    """Minimises over columns between 0 and a most, under equations with these right sides, and then inequalities.

    `iterations` are those of the simplex method that the last call of `solve` took, `primal` whether they were of the
    primal one.

    Examples
    --------
    >>> program = RestrictedMaster(np.array([4.0]))
    >>> program.add_columns(np.array([2.0, 3.0]), csr_matrix([[1.0, 1.0]]))
    >>> program.solve(100).value.tolist()
    [4.0, 0.0]
    >>> program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    >>> program.solve(100).multiplier.tolist()
    [2.0, 1.0]
    """

    def __init__(self, right: Floats) -> None:
        self._highs = _Quiet()
        self._lawful, self._value = False, np.zeros(0)
        self.iterations, self.primal = 0, False
        options: dict[str, bool | int | str] = {"output_flag": False, "solver": "simplex", "presolve": "off"}
        for option, value in (options | {"threads": 1}).items():
            self._highs.setOptionValue(option, value)
        self._add_rows(csr_matrix((len(right), 0)), right, right)

    def add_columns(self, cost: Floats, entries: csr_matrix, most: float = np.inf) -> None:
        """Add columns of at most `most`; `entries` is (rows, columns)."""
        by_column = entries.tocsc()
        none, all_of_it = np.zeros(len(cost)), np.full(len(cost), most)
        self._value = np.append(self._value, none)
        self._told(self._highs.addCols(len(cost), cost, none, all_of_it, *_sparse(by_column)))

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        """Add rows that are at least `least`; `entries` is (rows, columns)."""
        self._add_rows(entries.tocsr(), least, np.full(len(least), np.inf))

    def drop_rows(self, rows: Ints) -> None:
        """Drop some of the rows that were added, counted from the first equation on; those after them move up."""
        if len(rows):
            self._told(self._highs.deleteRows(len(rows), rows.astype(np.int32)))

    def drop_columns(self, columns: Ints) -> None:
        """Drop some columns, none of them in use; those after them move up."""
        if len(columns):
            self._value = np.delete(self._value, columns)
            self._told(self._highs.deleteCols(len(columns), columns.astype(np.int32)))

    def limit(self, columns: Ints, most: Floats) -> None:
        """Keep these columns at no more than so much each from now on."""
        if len(columns):
            self._lawful = self._lawful and bool((self._value[columns] <= most).all())
            chosen, none = columns.astype(np.int32), np.zeros(len(columns))
            self._told(self._highs.changeColsBounds(len(columns), chosen, none, most))

    def price(self, columns: Ints, cost: Floats) -> None:
        """What these columns cost from now on."""
        if len(columns):
            self._told(self._highs.changeColsCost(len(columns), columns.astype(np.int32), cost))

    def solve(self, most: int, most_s: float = np.inf) -> MasterSolution | None:
        """The cheapest columns, None where no optimum is found in so many iterations, and seconds by the clock."""
        self._highs.setOptionValue("time_limit", self._highs.getRunTime() + max(0.0, most_s))
        self._highs.setOptionValue("simplex_iteration_limit", min(most, MOST_ROUNDS))
        self.primal = self._lawful
        self._highs.setOptionValue("simplex_strategy", BY_PRIMAL if self.primal else BY_DUAL)
        self._highs.run()
        self.iterations = int(self._highs.getInfo().simplex_iteration_count)
        if self._highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        self._lawful = True
        found = self._highs.getSolution()
        self._value = np.array(found.col_value)
        return MasterSolution(self._value, np.array(found.row_dual), np.array(found.col_dual))

    def _add_rows(self, entries: csr_matrix, least: Floats, most: Floats) -> None:
        if len(least):
            self._lawful = False
            self._told(self._highs.addRows(len(least), least, most, *_sparse(entries)))

    def _told(self, status: object) -> None:
        """Nothing may be left out of the program in silence: a bound would still hold, but less than it could."""
        if status == highspy.HighsStatus.kError:
            raise RuntimeError(f"HiGHS refuses a change of the linear program: {status}")


def _sparse(entries: csr_matrix) -> tuple[int, Ints, Ints, Floats]:
    """Entries by row (or by column) as HiGHS reads them: how many, where each row begins, and each one's place."""
    starts, places = entries.indptr[:-1].astype(np.int32), entries.indices.astype(np.int32)
    return entries.nnz, starts, places, entries.data.astype(np.float64)
