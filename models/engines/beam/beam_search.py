"""A beam over ideals that widens until nothing is dropped (Libralesso et al. 2020; Kuroiwa and Beck's CABS)."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.models.engines.solution import Budget, Incumbent, Progress
from kerfwise.models.problem.bitsets import words
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .bounds import MOST_ROUNDS, Bound, least_in_and_out, priced_walks, walk_operations
from .layers import Grower, History, Spent, root
from .tables import NEVER, make_beam_tables, travel_table

FIRST_WIDTH = 16
MOST_BYTES = 1_500_000_000


@dataclass(frozen=True, slots=True)
class BeamResult:
    """The best route known, and what is proven.

    `bound` is a lower bound for the whole problem, µm, None where nothing is known. With `proven` the incumbent is
    the best there is, or no lawful route exists where it is None. `work` is what was spent, in deterministic seconds,
    `width` how wide the last whole run was.
    """

    incumbent: Incumbent | None
    bound: int | None = None
    proven: bool = False
    interrupted: bool = False
    work: float = field(default=0.0, compare=False)
    width: int = 0


def beam(
    problem: Problem,
    incumbent: Incumbent | None = None,
    work: float = 30.0,
    time_s: float | None = None,
    progress: Progress | None = None,
    first_width: int = FIRST_WIDTH,
    last_width: int | None = None,
    most_bytes: float = MOST_BYTES,
) -> BeamResult:
    """Run beams, each twice as wide as the last, until the best route is proven or a limit is reached.

    Parameters
    ----------
    problem
        One that `applies` is true of.
    incumbent
        A lawful route: states that cannot lead to a cheaper one are left out.
    work
        Deterministic limit, in seconds or so of the machine that `widening.OPERATIONS_PER_S` was measured on.
    time_s
        Wall-clock limit, s; whichever of the two is reached first counts.
    progress
        Asked once a layer whether to go on.
    first_width, last_width
        States a layer to begin with, and at the most; without the latter, as many as fit in the bytes.
    most_bytes
        What the tables may take.
    """
    budget = Budget(work, time_s, OPERATIONS_PER_S)
    if problem.n == 0:
        return BeamResult(Incumbent((), route_cost(problem, ())), route_cost(problem, ()), True)
    widening = Widening(problem, incumbent, budget, progress)
    interrupted = False
    try:
        widening.run(first_width, most_states(problem, most_bytes) if last_width is None else last_width)
    except Empty:
        pass
    except KeyboardInterrupt:
        interrupted = True
    return BeamResult(widening.incumbent, widening.bound, widening.proven, interrupted, budget.spent, widening.width)


def most_states(problem: Problem, most_bytes: float = MOST_BYTES) -> int:
    """How wide a beam fits in so many bytes, or in `MOST_BYTES`: children in two rooms, and two layers of sets."""
    a_state = 2 * 2 * 28 + 3 * 28 + 2 * (16 * words(problem.n) + 60) + 16
    return int(min(most_bytes, MOST_BYTES) // a_state)


# Which problems the beam takes.

MOST_SITES = 4000
"""More would make the tables of moves, from both ends, larger than 400 MB."""


def unfit(problem: Problem) -> str:
    """Why the beam cannot be used; empty where a state holds all that a step costs, and the tables hold the numbers."""
    if problem.further_back is not None:
        return f"rule {problem.further_back.rule} looks further back than the last cut"
    if problem.m > MOST_SITES:
        return f"it takes up to {MOST_SITES} ways to cut, there are {problem.m}"
    return "" if _dearest(problem) < NEVER else "a move costs more than its tables hold"


def _dearest(problem: Problem) -> float:
    """What no move costs more than, but for what it crosses."""
    lags = sum(cost_um(lag.weight) for lag in problem.lags if lag.weight is not None)
    if problem.matrix is not None:
        return float(problem.matrix.max()) + lags
    points = np.vstack([problem.ends(), problem.pierces()]).astype(np.float64)
    return problem.travel_weight * float(np.linalg.norm(np.ptp(points, axis=0))) + lags + 1


# Runs beams one after the other, each twice as wide as the last, at first from both ends.

OPERATIONS_PER_S = 3e8
WORTH_A_RUN = 1.3
"""A run that can only be so much wider than the last is not begun."""
WORTH_PRICING = 128
"""Width from which on a better bound is worth its price."""
PRICING = 0.1
"""Share of what is left that the better bound may take, from each end."""
SCOUTING = 0.25
"""Share of the work after which only the end of the better bound is gone on with."""
ROUNDING = 1e-3
"""Bounds are sums of doubles, costs whole: what is under the next whole number by less is taken for it."""


class Empty(Exception):
    """A limit is reached."""


class _End:
    """The problem from one end."""

    def __init__(self, problem: Problem, backwards: bool) -> None:
        self.problem, self.backwards = problem, backwards
        self.travel = travel_table(problem)
        self.tables = make_beam_tables(problem, self.travel)
        self.bound = least_in_and_out(problem, self.travel)
        self.priced = False
        self.reached = -math.inf  # bound that its last run has proven

    def price(self, target: int, operations: float, pay: Callable[[int], None]) -> None:
        """Better bounds, aiming at the cost of a plan, for no more than so many operations."""
        self.priced = True
        rounds = int(operations / walk_operations(self.problem, self.travel))
        if rounds >= MOST_ROUNDS // 10:
            better = priced_walks(self.problem, self.travel, self.bound, target, rounds, pay)
            self.bound = Bound(
                np.concatenate([self.bound.to_go, better.to_go]), np.concatenate([self.bound.price, better.price])
            )


class Widening:
    """One run after another, each twice as wide as the last."""

    def __init__(
        self, problem: Problem, incumbent: Incumbent | None, budget: Budget, progress: Progress | None
    ) -> None:
        self._problem, self._budget, self._progress = problem, budget, progress
        self._ends = [_End(problem, False)]
        if can_reverse(problem):
            self._ends.append(_End(reversed_problem(problem), True))
        self.incumbent = incumbent
        self.bound: int | None = None
        self.proven = False
        self.width = 0

    def run(self, width: int, most: int) -> None:
        """Until proven, or the next run would not be worth it; `Empty` when a limit is reached on the way."""
        with ThreadPoolExecutor(max_workers=1) as threads:
            while not self.proven and self.width < most:
                width, before = min(width, most), self._budget.mark()
                for end in self._ends:
                    if width >= WORTH_PRICING and self.incumbent is not None and not end.priced:
                        share = PRICING * max(0.0, 1.0 - self._budget.share_spent)
                        end.price(self.incumbent.cost, share * self._budget.operations, self._pay)
                        before = self._budget.mark()
                    self._one(end, width, threads)
                    if self.proven:
                        break
                self.width = width
                if self._budget.share_spent > SCOUTING:
                    self._ends = [max(self._ends, key=lambda end: end.reached)]
                room = self._budget.times(before)
                if room < WORTH_A_RUN:
                    break
                width = math.ceil(width * min(2.0, room))

    def _one(self, end: _End, width: int, threads: ThreadPoolExecutor) -> None:
        """One run: better routes and bounds are noted, and whether all is proven."""
        n = self._problem.n
        limit = math.inf if self.incumbent is None else self.incumbent.cost - 1 + ROUNDING
        grower, spent, history = Grower(end.tables, end.bound, width, threads), Spent(), History()
        layer = root(end.tables, end.bound)
        while layer.depth < n and len(layer.site):
            paid = spent.operations
            layer, parent = grower.grow(layer, limit, spent)
            history.note(parent, layer.site)
            self._pay(spent.operations - paid, self.incumbent, self.bound)
        if len(layer.site):
            total = layer.value + end.bound.to_go[0, n, layer.site]
            best = int(np.argmin(total))
            if math.isfinite(total[best]):
                route = history.route(best)
                self.incumbent = Incumbent(route[::-1] if end.backwards else route, int(total[best]))
                assert self.incumbent.cost == route_cost(self._problem, self.incumbent.route)
        end.reached = spent.dropped
        self._learn(spent.dropped)

    def _pay(self, operations: int, incumbent: Incumbent | None = None, bound: int | None = None) -> None:
        """Count, tell the listener, and raise `Empty` at a limit."""
        self._budget.spend(operations)
        cost = None if incumbent is None else incumbent.cost
        heard = self._progress is None or self._progress("beam", cost, bound)
        if not heard or self._budget.share_spent >= 1.0:
            raise Empty

    def _learn(self, dropped: float) -> None:
        """`dropped` bounds every route that the run could have missed."""
        best = math.inf if self.incumbent is None else self.incumbent.cost
        self.proven = math.isinf(dropped) or dropped > best - 1 + ROUNDING
        lower = min(best, dropped)
        if math.isfinite(lower):
            self.bound = max(math.ceil(lower - ROUNDING), self.bound or 0)


# The same problem from the end to the start: some are far easier to prove that way round.


def can_reverse(problem: Problem) -> bool:
    """Whether it can be said backwards.

    Crossings ask what is already out, not what is still in; a link saves a pierce that must be paid for before it.
    """
    return not len(problem.crossings) and not len(problem.links)


def reversed_problem(problem: Problem) -> Problem:
    """A problem whose routes are those of the given one backwards, at the same cost.

    It `applies` to the beam, and can turn.
    """
    return replace(
        problem,
        pierce_um=problem.end_um,
        end_um=problem.pierce_um,
        before=np.ascontiguousarray(problem.before.T),
        conditions=tuple(_reversed(condition) for condition in problem.conditions),
        matrix=None if problem.matrix is None else np.ascontiguousarray(problem.matrix.T),
    )


def _reversed(condition: Condition) -> Condition:
    """Who is out before the contour one way is not out the other way, and the contour itself never is."""
    pairs = [(k, w) for k, w in zip(condition.members, condition.weights, strict=True) if k != condition.contour]
    return replace(
        condition,
        members=tuple(k for k, _ in pairs),
        weights=tuple(-w for _, w in pairs),
        bound=condition.bound - sum(w for _, w in pairs),
    )
