"""The linear program of a bound by flows, over the moves that have been useful so far."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_matrix, hstack, vstack

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.deadline import Deadline

from .flow_work import PRIMAL, look_s, made_s, products_s, round_s
from .inequalities import Inequalities
from .network import AllMoves, Multipliers, Network, whole
from .restricted_master import restricted_master
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
FEW_SITES = 1200
"""With no more sites none is put to rest: such a program is solved quickly as it is."""
NARROW = 24
"""Binary digits that narrow numbers hold."""


class FlowProgram:
    """The linear program over the moves that have been useful so far.

    Rows: home and every contour are come to once, every site and home are left as often as come to,
    then the inequalities.
    """

    def __init__(
        self,
        network: Network,
        inequalities: Inequalities,
        beside: Floats,
        plan_um: int,
        in_time: Callable[[], bool] = lambda: True,
        deadline: Deadline | None = None,
    ) -> None:
        problem = network.problem
        n, m = problem.n, problem.m
        self._n, self._m, self._in_time, self._deadline = n, m, in_time, deadline or Deadline()
        self.owner = np.append(problem.site_contour, n)
        self.plan_um, self._moves = plan_um, AllMoves(network, plan_um)
        self._leave, self._reach = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        once = np.repeat([1.0, 0.0], [n + 1, m + 1])
        self._program = restricted_master(once)
        self.beside_cost = beside
        self._program.add_columns(beside, csr_matrix((len(once), len(beside))), 1.0)
        self._inequalities = inequalities.only(np.zeros(len(inequalities), dtype=np.bool_))
        self._use(*self._moves.nearest())
        self.ask(inequalities)
        self.work = made_s(self._moves.open.size)
        self.bound, self.value, self.complete, self.restricted = 0.0, 0.0, False, False
        self._idle, self._reduced = np.zeros(0, dtype=np.bool_), np.zeros(0)
        self._resting = Resting(m + 1) if m > FEW_SITES else None

    def solve(self, work: float) -> bool:
        """Find the cheapest flow over the moves in use. False where it cannot be found within that work."""
        n, cuts = self._n, len(self._inequalities)
        each_s = round_s(n, self._awake, cuts)
        left_s = max(0.0, work - self.work)
        left = FEW + int(left_s / each_s)
        at_once = 1 + int(max(AT_ONCE_S, AT_ONCE * left_s) / each_s) if self._program.goes_on else left
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
        columns = len(self.beside_cost)
        self._reduced = solved.reduced[columns:]
        self.beside = np.clip(solved.value[:columns], 0.0, 1.0)
        self.moves = Flow(self._leave, self._reach, np.maximum(solved.value[columns:], 0.0))
        self.value = float(self._moves.costs(self._leave, self._reach) @ self.moves.amount)
        self.value += float(self.beside_cost @ self.beside)
        price, resting = solved.multiplier[n + 1 : n + self._m + 2], self._resting
        if resting is not None and len(resting.leave):
            some, paying = self._inequalities.only(~self._idle), paid[~self._idle]
            cost = self._moves.costs(resting.leave, resting.reach)
            cost -= paying @ some.across(resting.leave, resting.reach)
            price = resting.priced(price, solved.multiplier[self.owner], cost)
        self._multipliers = Multipliers(price, paid, self._inequalities)
        return True

    def look_at_all(self) -> None:
        """The bound that the last multipliers prove over all moves; those that would make it cheaper come in."""
        takes_s = look_s(self._moves.open.size)
        self.work += takes_s
        self._learn(self._multipliers, self._in_time if takes_s > SHORT_S else lambda: True)
        self.work += products_s(self._moves.products)

    def ask(self, found: Inequalities) -> None:
        """Ask for these inequalities, too."""
        entries = hstack([found.beside, found.across(self._leave, self._reach)], format="csr")
        self._program.add_rows(entries, found.least)
        self._inequalities = self._inequalities.joined(found)

    @property
    def multipliers(self) -> Multipliers:
        """Those of the last solution."""
        return self._multipliers

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

    @property
    def _awake(self) -> int:
        """Number of sites that are in the program."""
        return self._m - (0 if self._resting is None else int(self._resting.sites.sum()))

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
        rows = np.concatenate([self.owner[reach], n + 1 + reach, n + 1 + leave])
        flow = csr_matrix((entry, (rows, np.tile(moves, 3))), shape=(n + self._m + 2, len(moves)))
        self._program.add_columns(
            self._moves.costs(leave, reach), vstack([flow, self._inequalities.across(leave, reach)])
        )

    def _learn(self, by: Multipliers, go: Callable[[], bool]) -> None:
        """The bound that these multipliers prove over all moves, and the moves that are missing."""
        moves = self._moves
        by = whole(by, NARROW) if moves.narrow else by
        least, missing = moves.look(by, (self._leave, self._reach), go)
        beside = self.beside_cost - by.inequalities.beside.T @ by.paid  # between 0 and 1 each
        self.bound = least + float(by.paid @ by.inequalities.least + np.minimum(beside, 0.0).sum())
        self.complete = missing is None
        if moves.close(self.bound):
            shut = np.flatnonzero(~moves.open[self._leave, self._reach])
            self._program.limit(len(self.beside_cost) + shut, np.zeros(len(shut)))
        if missing is not None:
            open_ = moves.open[missing]
            leave, reach = missing[0][open_], missing[1][open_]
            self._use(leave, reach)
            if self._resting is not None:
                leave, reach = self._resting.wake(np.append(leave, reach))
                wanted = moves.open[leave, reach] & ~moves.used[leave, reach]
                self._use(leave[wanted], reach[wanted])

    def drop_dear(self, in_use: Bools) -> Bools:
        """Drop the moves that the last multipliers leave dearest where there are many, and say which moves stay.

        Those `in_use` (moves,) stay, and those that have come since.
        """
        known, sites = len(self._reduced), self._awake + 1
        stays = self._moves.is_own(self._leave, self._reach)
        stays[:known] |= in_use[:known]
        stays[known:] = True
        kept = np.ones(len(stays), dtype=np.bool_)
        if known > MANY_MOVES * sites:
            enough = max(float(np.partition(self._reduced, FEWER_MOVES * sites)[FEWER_MOVES * sites]), DEAR_UM)
            kept[:known] = stays[:known] | (self._reduced <= enough)
        emptied = np.zeros(0, dtype=np.int64)
        if self._resting is not None:
            stays[:known] |= self.moves.amount > 0.0
            emptied, gone_to_rest = self._lay_down(self._resting, stays)
            kept &= ~gone_to_rest
        gone = np.flatnonzero(~kept)
        self._program.drop_columns(len(self.beside_cost) + gone, emptied)
        self._moves.used[self._leave[gone], self._reach[gone]] = False
        self._leave, self._reach = self._leave[kept], self._reach[kept]
        self._reduced = self._reduced[kept[:known]]
        return kept

    def _lay_down(self, resting: Resting, stays: Bools) -> tuple[Ints, Bools]:
        """Put sites to rest that no move that `stays` has, and answer which rows that empties, and which moves go."""
        first = self._n + 1
        column, row = self._program.basic()
        column = column[len(self.beside_cost) :]
        bound = row[first : first + self._m + 1].astype(np.int64)
        for ends in (self._leave, self._reach):
            bound += np.bincount(ends[column], minlength=self._m + 1)
        chosen, gone = resting.lay_down(self._leave, self._reach, self._reduced, stays, bound)
        return first + chosen, gone

    def restrict(self, allowed: Bools) -> None:
        """Go on with these moves alone, (m + 1, m + 1).

        The known plan's own stay, so that there is always a flow; those not among them cost as much as a plan more.
        """
        self._moves.restrict(allowed)
        self.restricted, self.bound = True, 0.0
        columns = len(self.beside_cost) + np.arange(len(self._leave))
        here = self._moves.open[self._leave, self._reach]
        self._program.limit(columns, np.where(here, np.inf, 0.0))
        ours = np.flatnonzero(self._moves.is_own(self._leave, self._reach))
        self._program.price(columns[ours], self._moves.costs(self._leave[ours], self._reach[ours]))

    @property
    def allowed(self) -> Bools:
        """The moves that are left, without those of the known plan that stay although they are not allowed."""
        return self._moves.allowed


# Sites that a linear program does without: no flow goes by them, and none would soon.
#
# Most sites of a contour are used by no flow, and a program that holds them all takes far longer to solve. A site at
# rest has no moves in the program, and a multiplier all the same: one that makes neither coming to it nor leaving it
# cheap, as far as that can be. A look at all moves shows whether it is missing after all.

AWAKE = 1.25
"""Sites that are left in the program for each that is in use: those next that are nearest to being used."""
NEVER = 1e15
"""Where a site has no way in, or none out, as much as that is said to cost, µm."""


class Resting:
    """Which of so many sites, home last, are at rest, and the moves that were put aside with them.

    Attributes
    ----------
    sites
        (m + 1,)
    leave, reach
        The moves from and to these, (k,) each.
    """

    def __init__(self, sites: int) -> None:
        self.sites: Bools = np.zeros(sites, dtype=np.bool_)
        self.leave, self.reach = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)

    def lay_down(self, leave: Ints, reach: Ints, reduced: Floats, stays: Bools, bound: Ints) -> tuple[Ints, Bools]:
        """Put sites to rest that are far from being used, and answer which, and which moves (k,) go with them.

        Parameters
        ----------
        leave, reach, reduced
            Moves of the program, (k,) each, and what multipliers leave of the costs of the first ones.
        stays
            Moves whose ends do not rest, (k,).
        bound
            How many moves of the basis go to and from each site (m + 1,), and whether the basis has its row: where that
            comes to one, the site's row alone takes their place.
        """
        busy = np.zeros(len(self.sites), dtype=np.bool_)
        busy[leave[stays]] = busy[reach[stays]] = busy[-1] = True
        ways = np.full((2, len(self.sites)), NEVER)
        for way, ends in zip(ways, (leave, reach), strict=True):
            np.minimum.at(way, ends[: len(reduced)], np.maximum(reduced, 0.0))
        missing = ways.sum(axis=0)
        quiet = np.flatnonzero(~busy & ~self.sites)
        farthest = quiet[np.argsort(missing[quiet], kind="stable")][int((AWAKE - 1) * busy.sum()) :]
        chosen = farthest[(bound[farthest] == 1) & (missing[farthest] > 0)]
        self.sites[chosen] = True
        gone = self.sites[leave] | self.sites[reach]
        self.leave, self.reach = np.append(self.leave, leave[gone]), np.append(self.reach, reach[gone])
        return chosen, gone

    def wake(self, sites: Ints) -> tuple[Ints, Ints]:
        """Let these sites rest no more, and answer which moves come back with them."""
        self.sites[sites] = False
        free = ~self.sites[self.leave] & ~self.sites[self.reach]
        back = self.leave[free], self.reach[free]
        self.leave, self.reach = self.leave[~free], self.reach[~free]
        return back

    def priced(self, price: Floats, come_to: Floats, left: Floats) -> Floats:
        """Multipliers of all sites (m + 1,), given those of the sites that do not rest.

        `come_to` (m + 1,) is what coming to the contour of each site is worth, and `left` (k,) what each move put aside
        costs, less what inequalities pay for it. A site's multiplier lies half way between what would make it cheap to
        leave and what would make it cheap to come to.
        """
        inward = self.sites[self.reach] & ~self.sites[self.leave]
        outward = self.sites[self.leave] & ~self.sites[self.reach]
        most, least = np.full(len(price), np.inf), np.full(len(price), -np.inf)
        np.minimum.at(most, self.reach[inward], (left - come_to[self.reach] + price[self.leave])[inward])
        np.maximum.at(least, self.leave[outward], (come_to[self.reach] + price[self.reach] - left)[outward])
        known = np.isfinite(most).astype(np.int64) + np.isfinite(least)
        sums = np.where(np.isfinite(most), most, 0.0) + np.where(np.isfinite(least), least, 0.0)
        return np.where(self.sites, sums / np.maximum(known, 1), price)
