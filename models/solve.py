"""Finds the best plan: the search finds, the ideals prove where they fit, CP-SAT carries on where they do not."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from ..encoder.errors import RulesConflict
from ..encoder.facts.facts import Facts
from ..rules.statements import Statement
from .cpsat import solve_cpsat
from .evaluate import broken, route_cost
from .ideals import fits, prove
from .problem import UM_PER_MM, Problem, make_problem
from .search import Searcher
from .simplify import simplify
from .solution import Incumbent, Progress, Solution, SolveOptions

Refine = Callable[[tuple[int, ...]], tuple[Statement, ...]]

FIRST = 0.03
"""Share of the work for a first look by the search."""
PROOF = 0.45
"""Share that the proof by ideals may take, where it fits; most take next to nothing."""
ROUND = 0.7
"""Share of what is left for one round, where geometry may have afterthoughts that ask for another."""
ENOUGH = 0.9
"""Share after which no further round is begun."""
SEARCH = 0.6
"""Share of what is left, where nothing is proven, for more search; CP-SAT has the rest."""


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
    whole = options.work if options.time_s is None else options.time_s
    spent = 0.0
    while True:
        problem = simplify(make_problem(facts, statements, options.home_mm, options.feeds))
        share = (whole - spent) * (1.0 if refine is None else ROUND)
        known = _run(problem, replace(options, work=share, time_s=options.time_s and share), watch)
        spent = spent + known.work if options.time_s is None else time.monotonic() - started
        if known.incumbent is None:
            raise _no_plan(known.infeasible)
        order = tuple(int(problem.site_contour[s]) for s in known.incumbent.route)
        missing = () if refine is None else refine(order)
        statements += missing
        if not missing or watch.stopped or spent >= whole * ENOUGH:
            break
    if missing:
        candidates = problem.site_candidate[list(known.incumbent.route)]
        problem = make_problem(facts, statements, options.home_mm, options.feeds)
        known = replace(known, incumbent=_judged_anew(problem, problem.candidate_site[candidates].tolist(), missing))
    assert known.incumbent is not None
    cost = known.incumbent.cost
    bound = min(known.bound_um, cost)
    return Solution(
        route=tuple(int(problem.site_candidate[s]) for s in known.incumbent.route),
        objective=cost / UM_PER_MM,
        bound=bound / UM_PER_MM if known.proved_by else None,
        status="optimal" if bound >= cost else "feasible",
        found_by=known.found_by,
        proved_by=known.proved_by,
        seconds=spent,
    )


def _judged_anew(problem: Problem, route: list[int], missing: tuple[Statement, ...]) -> Incumbent:
    """The route at hand at the price of what was found missing last, when there is no time left to solve again."""
    if broken(problem, route):
        raise _no_plan(False, tuple(s.about.sentence for s in missing))
    return Incumbent(tuple(route), route_cost(problem, route))


def _no_plan(infeasible: bool, reasons: tuple[str, ...] = ()) -> RulesConflict:
    if infeasible:
        return RulesConflict("no plan meets every hard rule", reasons)
    return RulesConflict(
        "no plan that meets every hard rule was found within the limit (none is proven impossible)", reasons
    )


def _run(problem: Problem, options: SolveOptions, watch: _Watch) -> _Known:
    known = _Known()
    searcher = Searcher(problem, options.seed)

    def look(work: float) -> None:
        searcher.run(work, None if options.time_s is None else work, watch)
        known.offer(searcher.best, "search")
        known.work += work

    look(options.work * FIRST)
    if fits(problem):
        proof = prove(problem, known.incumbent, options.work * PROOF, watch)
        known.work += options.work * PROOF if proof is None else proof.work
        if proof is not None and proof.incumbent is None:
            known.infeasible = True
        elif proof is not None and proof.incumbent is not None:
            known.offer(proof.incumbent, "ideals")
            known.raise_bound(proof.incumbent.cost, "ideals")
        if proof is not None:
            return known
    if not watch.stopped:
        look((options.work - known.work) * SEARCH)
    if not watch.stopped:
        left = options.work - known.work
        limits = replace(options, work=left, time_s=options.time_s and left)
        outcome = solve_cpsat(problem, limits, known.incumbent, known.bound_um, watch)
        known.offer(outcome.incumbent, "cp-sat")
        known.infeasible = outcome.infeasible
        if outcome.bound is not None:
            known.raise_bound(outcome.bound, "cp-sat")
        known.work += left
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
