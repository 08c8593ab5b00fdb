"""Finds the best plan: the search finds, the ideals prove where they fit, CP-SAT carries on where they do not."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from ..encoder.errors import RulesConflict
from ..encoder.facts.facts import Facts
from ..rules.statements import Statement
from .cpsat import solve_cpsat
from .crossings import Crossings
from .evaluate import broken, route_cost
from .ideals import prove
from .pace import Pace
from .problem import UM_PER_MM, Problem, make_problem
from .search import search
from .simplify import simplify
from .solution import Incumbent, Progress, Solution, SolveOptions

Refine = Callable[[tuple[int, ...]], tuple[Statement, ...]]

# shares of the budget: a first look, the proof by ideals, more search where that fails, CP-SAT
FIRST, PROOF, SEARCH, EXACT = 0.03, 0.42, 0.3, 0.25


@dataclass(slots=True)
class _Known:
    """What is known so far, and who found it."""

    incumbent: Incumbent | None = None
    found_by: str = ""
    bound_um: int = 0
    proved_by: str = ""
    infeasible: bool = False
    work: float = 0.0

    def offer(self, incumbent: Incumbent | None, engine: str) -> None:
        if incumbent is not None and (self.incumbent is None or incumbent.cost < self.incumbent.cost):
            self.incumbent, self.found_by = incumbent, engine

    def raise_bound(self, bound_um: int, engine: str) -> None:
        if bound_um > self.bound_um:
            self.bound_um, self.proved_by = bound_um, engine


def solve(
    facts: Facts,
    statements: tuple[Statement, ...],
    options: SolveOptions,
    progress: Progress | None = None,
    refine: Refine | None = None,
) -> Solution:
    """The best route found within the limits, with what is proven of it.

    `refine` looks at a whole order (contour numbers) and answers with statements that geometry has now shown to be
    missing; the problem is solved again with them until there are none. A bound proven before all are known is a
    bound all the same: the missing ones can only add to the cost.

    Raises
    ------
    RulesConflict
        If no lawful plan exists, or none was found (the message says which).
    """
    started = time.monotonic()
    watch = _Watch(progress, None if options.time_s is None else started + options.time_s)
    left = options.work if options.time_s is None else options.time_s
    spent = 0.0
    while True:
        problem = simplify(make_problem(facts, statements, options.home_mm, options.feeds))
        known = _run(problem, replace(options, work=left - spent), watch)
        spent += known.work
        if known.incumbent is None:
            raise RulesConflict(
                "no plan meets every hard rule"
                if known.infeasible
                else "no plan that meets every hard rule was found within the limit (none is proven impossible)"
            )
        order = tuple(int(problem.site_contour[s]) for s in known.incumbent.route)
        missing = () if refine is None else refine(order)
        if not missing:
            break
        statements += missing
        if watch.stopped or spent >= left:
            raise RulesConflict(
                "no plan that meets every hard rule was found within the limit (none is proven impossible)",
                tuple(s.about.sentence for s in missing),
            )
    cost = known.incumbent.cost
    bound = min(known.bound_um, cost)
    return Solution(
        route=tuple(int(problem.site_candidate[s]) for s in known.incumbent.route),
        objective=cost / UM_PER_MM,
        bound=bound / UM_PER_MM if known.proved_by else None,
        status="optimal" if bound >= cost else "feasible",
        found_by=known.found_by,
        proved_by=known.proved_by,
        seconds=spent if options.time_s is None else time.monotonic() - started,
    )


def _run(problem: Problem, options: SolveOptions, watch: _Watch) -> _Known:
    known = _Known()
    work = options.work
    known.offer(_search(problem, options, watch, FIRST), "search")
    proof = prove(problem, known.incumbent, work * PROOF, watch)
    known.work = work * FIRST + (work * PROOF if proof is None else proof.work)
    if proof is not None:
        if proof.incumbent is None:
            known.infeasible = True
        else:
            known.offer(proof.incumbent, "ideals")
            known.raise_bound(proof.incumbent.cost, "ideals")
        return known
    if not watch.stopped:
        known.offer(_search(problem, options, watch, SEARCH), "search")
        known.work += work * SEARCH
    if not watch.stopped:
        outcome = solve_cpsat(problem, replace(options, work=work * EXACT), known.incumbent, known.bound_um, watch)
        known.offer(outcome.incumbent, "cp-sat")
        known.infeasible = outcome.infeasible
        if outcome.bound is not None:
            known.raise_bound(outcome.bound, "cp-sat")
        known.work += work * EXACT
    return known


def _search(problem: Problem, options: SolveOptions, watch: _Watch, share: float) -> Incumbent | None:
    """The search's best route, judged by all statements: it knows nothing of crossings and seconds itself."""
    simpler = replace(
        problem, crossings=Crossings(), lags=tuple(replace(lag, seconds=0.0) for lag in problem.lags), pace=Pace()
    )
    found = search(simpler, options, watch, share)
    if found is None or broken(problem, found.route):
        return None
    return Incumbent(found.route, route_cost(problem, found.route))


class _Watch:
    """Passes progress on, and says stop when the clock or the listener does."""

    def __init__(self, progress: Progress | None, deadline: float | None) -> None:
        self.progress, self.deadline, self.stopped = progress, deadline, False

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        late = self.deadline is not None and time.monotonic() >= self.deadline
        heard = self.progress is None or self.progress(engine, cost_um, bound_um)
        self.stopped = self.stopped or late or not heard
        return not self.stopped
