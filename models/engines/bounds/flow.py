"""A bound by linear programming: a unit of flow through every contour, and inequalities for the orders.

Every plan is a cycle through home that reaches each contour at one of its sites and leaves it from there. What no
plan does and the cheapest flow may do is cut off: what must lead from one contour to another must do so without what
comes before the one or after the other (Balas, Fischetti and Pulleyblank 1995), contiguous blocks are entered once, and
a site that needs its neighbours in, or out, needs flow in that order. The bound is worked out from the multipliers
over all moves, so that it holds however good they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import highspy
import numpy as np
from scipy.sparse import csr_matrix, vstack

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent, flows_s, look_s, made_s, simplex_round_s
from kerfwise.models.engines.tuning import (
    BYTES_A_MOVE,
    CROWD,
    DEAR_UM,
    LOOSE,
    MANY_MOVES,
    MOVES_KEPT,
    PRIMAL,
    RISEN,
    SETTING_OUT,
)
from kerfwise.models.engines.tuning import FLOW_LEAST as LEAST
from kerfwise.models.engines.tuning import FLOW_LEAST_GAIN as LEAST_GAIN
from kerfwise.models.engines.tuning import FLOW_LITTLE as LITTLE
from kerfwise.models.engines.tuning import FLOW_PATIENCE as PATIENCE
from kerfwise.models.engines.tuning import FLOW_STEP as STEP
from kerfwise.models.engines.tuning import FLOWS_MOST_CONTOURS as MOST_CONTOURS
from kerfwise.models.engines.tuning import FLOWS_MOST_SITES as MOST_SITES
from kerfwise.models.engines.tuning import PROGRAM_AT_ONCE as AT_ONCE
from kerfwise.models.engines.tuning import PROGRAM_AT_ONCE_S as AT_ONCE_S
from kerfwise.models.engines.tuning import PROGRAM_FEW as FEW
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.problem import Links, Problem

from .move_costs import Stopped, size_without_inner, sure_crossings
from .network import AllMoves, Inequalities, Multipliers, Network, block_inequalities, network_of
from .separation import Flow, Separation


@dataclass(frozen=True, slots=True)
class FlowBound:
    """What every plan costs at least, in the problem's unit (µm), and the deterministic seconds spent."""

    bound: int
    work: float


def flow_bound(
    problem: Problem,
    plan: Incumbent,
    deadline: Deadline,
) -> FlowBound:
    """Bound every plan from below, cutting off what no plan does until it is worth no more rounds.

    Parameters
    ----------
    plan
        A lawful plan: its moves make the flow feasible, and its cost is as high as a bound can be.
    deadline
        The round in which its work is spent is finished; where its seconds are over, a linear program is broken off.
        Told the bound after every round. Tables of all moves take no more than its bytes.
    """
    if not 0 < problem.n <= MOST_CONTOURS:
        return FlowBound(0, 0.0)
    most_sites = int(min(MOST_SITES, math.sqrt(deadline.most_bytes / BYTES_A_MOVE)))
    contours, sites = size_without_inner(problem)
    if sites > most_sites or flows_s(contours, sites) > SETTING_OUT * deadline.work:
        plan = Incumbent(tuple(int(problem.site_contour[s]) for s in plan.route), plan.cost)
        problem, sites = contract_sites(problem), contours

    def in_time() -> bool:
        """Whether the clock leaves time; all work is counted afterwards."""
        return deadline("bound", plan.cost, None)

    try:
        network = network_of(problem, plan.route, plan.cost, most_sites, in_time)
    except Stopped:
        return FlowBound(0, flows_s(contours, sites))
    loop = CutLoop(network, plan, deadline, in_time)
    with suppress(Stopped):
        loop.run(PATIENCE, LEAST_GAIN)
    return FlowBound(max(0, min(plan.cost, _whole(loop.best))), loop.flow.work)


class CutLoop:
    """A program that is solved, and cut where its flow does what no plan does, again and again.

    No move leaves the program that a plan of `most_um` may have, where that is given.
    `best` is what every plan costs at least; `proving` are multipliers that prove about as much of all moves.
    """

    def __init__(
        self,
        network: Network,
        plan: Incumbent,
        deadline: Deadline,
        in_time: Callable[[], bool],
        most_um: int | None = None,
    ) -> None:
        problem = network.problem
        self._plan, self._deadline = plan, deadline
        self._separation = Separation(network)
        blocks = block_inequalities(problem)
        most = plan.cost if most_um is None else most_um
        self.flow = FlowProgram(network, blocks, most, in_time, deadline)
        self._kept, self._most = len(blocks), CROWD * problem.n
        self.best, self._dropped_at = 0.0, 0.0
        self.proving: Multipliers | None = None

    def run(self, patience: int, least_gain: float) -> None:
        """Raise the best bound, until so many rounds gain less than a share, or no plan is left."""
        flow, seen = self.flow, [0.0] * patience
        between = Between(self._separation)
        while flow.solve(self._deadline.work):
            self._look()
            loose = not flow.complete and flow.value - flow.bound > LOOSE * flow.value
            if loose and flow.solve(self._deadline.work):  # with the moves that were missing, before it is cut
                self._look()
            if self.best > self._plan.cost - 1 or not self.go():
                break
            before = self._separation.work
            found = between.broken(flow.moves, self.go)
            flow.work += self._separation.work - before
            seen.append(self.best)
            if (flow.complete and not len(found)) or self.best < (1 + least_gain) * seen[-1 - patience]:
                break
            between.keep(flow.drop_dear(between.uses(len(flow.moves.leave))))
            if (flow.complete or flow.inequalities > self._most) and self.best > (1 + RISEN) * self._dropped_at:
                flow.drop_idle(self._kept)
                self._dropped_at = self.best
            flow.ask(found)

    def _look(self) -> None:
        """Look at all moves, and note the bound if it is the best."""
        self.flow.look_at_all()
        if self.proving is None or self.flow.bound > self.best:
            self.proving = self.flow.multipliers
        self.best = max(self.best, self.flow.bound)

    def go(self) -> bool:
        """Whether there is work left."""
        return self.flow.work <= self._deadline.work and self._deadline("bound", self._plan.cost, _whole(self.best))


def _whole(bound: float) -> int:
    """Costs are whole; multipliers are sums of doubles, so a little less than the next whole number is not enough."""
    return int(np.ceil(bound - 1e-9 * abs(bound) - 1e-3))


# Cuts for a flow between the cheapest one and those before it (Ben-Ameur and Neto 2007).
#
# The cheapest flow is a corner of what the program allows, and cuts chosen by a corner often cut off little else. A
# flow inside breaks fewer inequalities; those that it does break, and the cheapest one as well, cut deep.


class Between:
    """Looks for inequalities that a flow on the way to the cheapest one breaks.

    Moves come behind those of before; where some are dropped, `keep` is told.
    """

    def __init__(self, separation: Separation) -> None:
        self._separation = separation
        self._amount: Floats | None = None

    def uses(self, moves: int) -> Bools:
        """Which of the first so many moves the flow inside has, (moves,)."""
        used = np.zeros(moves, dtype=np.bool_)
        if self._amount is not None:
            used[: len(self._amount)] = self._amount >= LITTLE
        return used

    def keep(self, kept: Bools) -> None:
        """Go on with these of the moves."""
        if self._amount is not None:
            self._amount = self._amount[kept[: len(self._amount)]]

    def broken(self, cheapest: Flow, go: Callable[[], bool]) -> Inequalities:
        """Inequalities that the cheapest flow breaks."""
        if self._amount is None:
            self._amount = cheapest.amount
            return self._separation.broken(cheapest, go)
        amount = np.zeros_like(cheapest.amount)
        amount[: len(self._amount)] = (1 - STEP) * self._amount
        self._amount = amount + STEP * cheapest.amount
        inside = Flow(cheapest.leave, cheapest.reach, np.where(self._amount < LITTLE, 0.0, self._amount))
        found = self._separation.broken(inside, go)
        some = np.flatnonzero(cheapest.amount)
        comes_to = found.across(cheapest.leave[some], cheapest.reach[some]) @ cheapest.amount[some]
        cuts = found.only(comes_to < found.least - LEAST)
        if len(cuts) or not go():
            return cuts
        self._amount = None
        return self.broken(cheapest, go)


# A smaller problem that bounds a large one: contours stand for all their sites.

FAR = 1e11
"""What an unlawful move costs where moves are whole numbers."""


def contract_sites(problem: Problem) -> Problem:
    """A problem of one site a contour that no plan undercuts: to and from it by the cheapest move."""
    n, m, first = problem.n, problem.m, np.append(problem.first, problem.m + 1)
    charged = sure_crossings(problem) if len(problem.crossings) else None
    least = np.empty((n + 1, n + 1))
    for contour in range(n + 1):  # the table of all sites is too large to be made at once
        sites = np.arange(first[contour], first[contour + 1])
        move = problem.travel(sites, np.arange(m + 1)).astype(np.float64)
        move[:, :m] += problem.site_cost
        if charged is not None:
            move += charged[sites].toarray()
        least[contour] = np.minimum.reduceat(move.min(axis=0), first[:-1])
    least[~problem.successors()] = np.inf
    return replace(
        problem,
        first=np.arange(n + 1, dtype=np.int64),
        site_contour=np.arange(n, dtype=np.int64),
        site_candidate=problem.site_candidate[problem.first[:-1]],
        pierce_um=problem.pierce_um[problem.first[:-1]],
        end_um=problem.end_um[problem.first[:-1]],
        site_cost=np.zeros(n, dtype=np.int64),
        conditions=(),
        soft_groups=(),
        general=(),
        crossings=Crossings(),
        links=Links(),
        moves=MovePrices(barred=problem.moves.barred),
        matrix=np.minimum(least, FAR).astype(np.int64),
    )


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
            fewer = int(MOVES_KEPT * MANY_MOVES * sites)
            enough = max(float(np.partition(self._reduced, fewer)[fewer]), DEAR_UM)
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
