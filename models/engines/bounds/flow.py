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

import numpy as np

from kerfwise.arrays import Bools, Floats
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent, flows_s
from kerfwise.models.engines.tuning import BYTES_A_MOVE, CROWD, LOOSE, RISEN, SETTING_OUT
from kerfwise.models.engines.tuning import FLOW_LEAST as LEAST
from kerfwise.models.engines.tuning import FLOW_LEAST_GAIN as LEAST_GAIN
from kerfwise.models.engines.tuning import FLOW_LITTLE as LITTLE
from kerfwise.models.engines.tuning import FLOW_PATIENCE as PATIENCE
from kerfwise.models.engines.tuning import FLOW_STEP as STEP
from kerfwise.models.engines.tuning import FLOWS_MOST_CONTOURS as MOST_CONTOURS
from kerfwise.models.engines.tuning import FLOWS_MOST_SITES as MOST_SITES
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.problem import Links, Problem

from .flow_program import FlowProgram
from .move_costs import Stopped, size_without_inner, sure_crossings
from .network import Inequalities, Multipliers, Network, block_inequalities, network_of
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
