"""A bound by linear programming: a unit of flow through every contour, and inequalities for the orders.

Every plan is a cycle through home that reaches each contour at one of its sites and leaves it from there. What no
plan does and the cheapest flow may do is cut off: what must lead from one contour to another must do so without what
comes before the one or after the other (Balas, Fischetti and Pulleyblank 1995), contiguous blocks are entered once, and
a site that needs its neighbours in, or out, needs flow in that order. The bound is worked out from the multipliers
over all moves, so that it holds however good they are.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.problem.problem import Problem

from .between import Between
from .branching import split
from .costs import Stopped
from .demands import DemandColumns
from .flow_program import FlowProgram
from .flow_work import sets_out_s
from .inequalities import block_inequalities
from .merged import merged
from .network import Network, network_of
from .passages import size_without_inner
from .pricing import Multipliers
from .separation import Separation

LEAST_GAIN = 3e-4
"""Share of the bound that the last few rounds must bring."""
PATIENCE = 20
LOOSE = 0.004
"""Share of what the program costs, by which the bound may lag behind before the program is cut again."""
CROWD = 3
"""Inequalities per contour, beyond which those are dropped that nothing is paid for."""
RISEN = 1e-5
"""Share by which the bound has risen before inequalities are dropped again: else the same ones come back in turn."""
MOST_SITES, MOST_CONTOURS = 9000, 1500
"""With more sites contours stand for all of theirs; with more contours there is no bound (it takes too long)."""
BYTES_A_MOVE = 14.0
"""What is kept of every move, and needed while they are gone through."""
SETTING_OUT = 0.75
"""Share of the work that may go before the first bound; where it takes more, contours stand for all of their sites."""
ROUNDS, GAIN = 3, 3e-4
"""A case is split again once so many rounds of cuts have gained less than this share."""
MOST_BRANCHED, MOST_CASES = 1200, 1000
"""Sites from which on cases take too long; and cases that are kept at the most."""


@dataclass(frozen=True, slots=True)
class FlowBound:
    """What every plan costs at least, in the problem's unit (µm), and the deterministic seconds spent."""

    bound: int
    work: float


def flow_bound(
    problem: Problem,
    plan: Incumbent,
    work: float,
    progress: Progress | None = None,
    most_bytes: float = math.inf,
    ends_s: float = math.inf,
) -> FlowBound:
    """Bound every plan from below, cutting off what no plan does until it is worth no more rounds.

    Parameters
    ----------
    plan
        A lawful plan: its moves make the flow feasible, and its cost is as high as a bound can be.
    work
        Limit in deterministic seconds; the round in which it is reached is finished.
    progress
        Told the bound after every round, asked whether to go on.
    most_bytes
        What tables of all moves may take where there are many sites.
    ends_s
        When a limit in seconds ends, by `running_s`: a linear program is broken off then.
    """
    if not 0 < problem.n <= MOST_CONTOURS:
        return FlowBound(0, 0.0)
    most_sites = int(min(MOST_SITES, math.sqrt(most_bytes / BYTES_A_MOVE)))
    contours, sites = size_without_inner(problem)
    if sites > most_sites or sets_out_s(contours, sites) > SETTING_OUT * work:
        plan = Incumbent(tuple(int(problem.site_contour[s]) for s in plan.route), plan.cost)
        problem, sites = merged(problem), contours

    def in_time() -> bool:
        """Whether the clock leaves time; all work is counted afterwards."""
        return progress is None or progress("bound", plan.cost, None)

    try:
        network = network_of(problem, plan.route, plan.cost, most_sites, in_time)
    except Stopped:
        return FlowBound(0, sets_out_s(contours, sites))
    loop = CutLoop(network, plan, work, progress, in_time, ends_s)
    with suppress(Stopped):
        loop.run(PATIENCE, LEAST_GAIN)
        if loop.stalled and network.problem.m <= MOST_BRANCHED:
            loop.best = max(loop.best, branch(loop))
    return FlowBound(max(0, min(plan.cost, _whole(loop.best))), loop.flow.work)


class CutLoop:
    """A program that is solved, and cut where its flow does what no plan does, again and again.

    No move leaves the program that a plan of `most_um` may have, where that is given.
    `best` is what every plan costs at least. `stalled` says that more rounds are not worth it, but that there is work
    left; `proving` are multipliers that prove about as much of all moves.
    """

    def __init__(
        self, network: Network, plan: Incumbent, work: float, progress: Progress | None,
        in_time: Callable[[], bool], ends_s: float, most_um: int | None = None,
    ) -> None:  # fmt: skip
        problem = network.problem
        self._plan, self._work, self._progress = plan, work, progress
        demands = DemandColumns(problem)
        self._separation = Separation(network, demands)
        blocks = block_inequalities(problem, len(demands.cost))
        most = plan.cost if most_um is None else most_um
        self.flow = FlowProgram(network, blocks, demands.cost, most, in_time, ends_s)
        self._kept, self._most = len(blocks), CROWD * problem.n
        self.best, self.stalled, self._dropped_at = 0.0, False, 0.0
        self.proving: Multipliers | None = None

    def run(self, patience: int, least_gain: float) -> float:
        """The bound of the moves that are open: until so many rounds gain less than a share, or no plan is left.

        What holds of all moves is noted as the best.
        """
        flow, best, seen = self.flow, 0.0, [0.0] * patience
        between = Between(self._separation)
        self.stalled = False
        while flow.solve(self._work):
            best = self._looked(best)
            if self._loose(flow.value - flow.bound) and flow.solve(self._work):
                best = self._looked(best)
            if best > self._plan.cost - 1 or not self.go():
                break
            before = self._separation.work
            found = between.broken(flow.moves, flow.beside, self.go)
            flow.work += self._separation.work - before
            seen.append(best)
            if (flow.complete and not len(found)) or best < (1 + least_gain) * seen[-1 - patience]:
                self.stalled = True
                break
            between.keep(flow.drop_dear(between.uses(len(flow.moves.leave))))
            if (flow.complete or flow.inequalities > self._most) and best > (1 + RISEN) * self._dropped_at:
                flow.drop_idle(self._kept)
                self._dropped_at = best
            flow.ask(found)
        return best

    def _looked(self, best: float) -> float:
        """This bound, or that of a look at all moves that are open, if it is higher.

        It holds of all plans, and is noted as such, unless only some moves are open.
        """
        self.flow.look_at_all()
        best = max(best, self.flow.bound)
        if not self.flow.restricted:
            if self.proving is None or self.flow.bound > self.best:
                self.proving = self.flow.multipliers
            self.best = max(self.best, best)
        return best

    def _loose(self, missing: float) -> bool:
        """Whether the program is worth solving once more with the moves that were missing, before it is cut."""
        return not self.flow.complete and missing > LOOSE * self.flow.value

    def go(self) -> bool:
        """Whether there is work left."""
        if self.flow.work > self._work:
            return False
        return self._progress is None or self._progress("bound", self._plan.cost, _whole(self.best))


def _whole(bound: float) -> int:
    """Costs are whole; multipliers are sums of doubles, so a little less than the next whole number is not enough."""
    return int(np.ceil(bound - 1e-9 * abs(bound) - 1e-3))


def branch(loop: CutLoop) -> float:
    """What every plan costs at least by all cases together; the case with the lowest bound is split first."""
    flow = loop.flow
    goal, known = float(flow.plan_um - 1), float(flow.plan_um)
    cases: list[tuple[float, int, Bools]] = []
    number, reached, done = 0, loop.best, known
    while True:
        parts = split(flow.allowed, flow.contours_used(), flow.sites_used(), flow.owner) if reached <= goal else []
        if reached <= goal and not parts:
            done = min(done, reached)
        for part in parts:
            number += 1
            heapq.heappush(cases, (reached, number, part))
        if not cases:
            return done
        if cases[0][0] > goal or len(cases) > MOST_CASES or not loop.go():
            return min(done, cases[0][0])
        bound, _, allowed = heapq.heappop(cases)
        flow.restrict(allowed)
        reached = max(bound, loop.run(ROUNDS, GAIN))
        if not loop.stalled and reached <= goal:  # not looked at to its end
            return min(done, reached, *(case[0] for case in cases))
