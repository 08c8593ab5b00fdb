"""Finds the best plan: the search finds, the ideals prove where they fit, CP-SAT carries on where they do not."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from ..encoder.errors import RulesConflict
from ..encoder.facts.facts import Facts
from ..rules.statements import Statement
from .cpsat import solve_cpsat
from .ideals import prove
from .problem import UM_PER_MM, Problem, make_problem
from .search import search
from .solution import Incumbent, Progress, Solution, SolveOptions

# shares of the budget: a first look, the proof by ideals, more search where that fails, CP-SAT
FIRST, PROOF, SEARCH, EXACT = 0.06, 0.44, 0.25, 0.25


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
    facts: Facts, statements: tuple[Statement, ...], options: SolveOptions, progress: Progress | None = None
) -> Solution:
    """The best route found within the limits, with what is proven of it.

    Raises
    ------
    RulesConflict
        If no lawful plan exists, or none was found (the message says which).
    """
    started = time.monotonic()
    watch = _Watch(progress, None if options.time_s is None else started + options.time_s)
    problem = make_problem(facts, statements, options.home_mm)
    known = _run(problem, options, watch)
    if known.incumbent is None:
        raise RulesConflict(
            "no plan meets every hard rule"
            if known.infeasible
            else "no plan that meets every hard rule was found within the limit (none is proven impossible)"
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
        seconds=known.work if options.time_s is None else time.monotonic() - started,
    )


def _run(problem: Problem, options: SolveOptions, watch: _Watch) -> _Known:
    known = _Known()
    work = options.work if options.time_s is None else options.time_s
    options = replace(options, work=work)
    known.offer(search(problem, options, watch, share=FIRST), "search")
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
        known.offer(search(problem, options, watch, share=SEARCH), "search")
        known.work += work * SEARCH
    if not watch.stopped:
        outcome = solve_cpsat(problem, replace(options, work=work * EXACT), known.incumbent, known.bound_um, watch)
        known.offer(outcome.incumbent, "cp-sat")
        known.infeasible = outcome.infeasible
        if outcome.bound is not None:
            known.raise_bound(outcome.bound, "cp-sat")
        known.work += work * EXACT
    return known


class _Watch:
    """Passes progress on, and says stop when the clock or the listener does."""

    def __init__(self, progress: Progress | None, deadline: float | None) -> None:
        self.progress, self.deadline, self.stopped = progress, deadline, False

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        late = self.deadline is not None and time.monotonic() >= self.deadline
        heard = self.progress is None or self.progress(engine, cost_um, bound_um)
        self.stopped = self.stopped or late or not heard
        return not self.stopped
