"""Finds the best plan: statements become a problem, the portfolio solves it, geometry may ask for another round."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kerfwise.encoder.errors import MOST_DETAILS, InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.tuning import ENOUGH_WORK, MOVES_SHARE, PACE_KNOWN, ROUND
from kerfwise.models.engines.tuning import SOLVE_ENOUGH as ENOUGH
from kerfwise.models.engines.tuning import SOLVE_LEAST as LEAST
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.statements import Statement

from . import Member
from .deadline import Deadline, Progress
from .portfolio import run_portfolio
from .shared_state import SharedState
from .solution import Incumbent, Solution, SolveOptions

Sites = NDArray[np.int64]
Refine = Callable[[tuple[int, ...]], tuple[Statement, ...]]


def solve(
    facts: Facts,
    statements: tuple[Statement, ...],
    options: SolveOptions,
    progress: Progress | None = None,
    refine: Refine | None = None,
    look_s: float = 0.0,
    start: Sequence[int] = (),
    found: Callable[[Solution], None] | None = None,
) -> Solution:
    """The best route found within the limits, with what is proven of it.

    `refine` looks at a whole order (contour numbers) and answers with statements that geometry has now shown to be
    missing; the problem is solved again with them until there are none. A bound proven before all are known is a
    bound all the same: the missing ones can only add to the cost. `look_s` is how long the first look will take, as
    far as anyone can tell: a limit in seconds keeps so much of itself for it. The last plan is looked at to the end,
    whatever the limit, since nothing else tells its cost; a note says so where that takes longer than the limit leaves.
    `start` is a route to go on from, as a solution has it, if one is known. `found` is told each better plan as it is
    found, with nothing proven of it and before geometry has looked at it; it changes nothing.

    Raises
    ------
    InputError
        If the one engine that was asked for cannot find a plan under these statements (the message says why).
    RulesConflict
        If no lawful plan exists, or none was found (the message says which).
    """
    deadline = Deadline.of(options, progress)
    timed = deadline.timed
    whole = options.work if options.time_s is None else options.time_s
    spent = 0.0
    posed: Problem | None = None
    known: SharedState | None = None
    candidates = np.array(start, dtype=np.int64) if start else None
    while True:
        in_time = _in_time(deadline, MOVES_SHARE * whole) if timed else _always
        posed = make_problem(facts, statements, options.home_mm, options.feeds, posed, in_time)
        problem = simplify(posed)
        spent = deadline.seconds if timed else spent  # making a problem takes its time on large nests, as looks do
        share = whole - spent if refine is None else min((whole - spent) * ROUND, whole - spent - look_s)
        share = max(share, LEAST * whole) if known is None else max(share, 0.0)
        deadline.begin()
        limits = replace(options, work=share, time_s=options.time_s and share)
        hear = None if found is None else partial(_tell_found, found, posed, problem, deadline)
        known = run_portfolio(problem, limits, deadline, _known_route(problem, candidates, posed), known, hear)
        spent += known.work
        if known.incumbent is None:
            against = tuple(about.sentence for about in known.against[:MOST_DETAILS])
            raise _unable(options.member, known.unable) if known.unable else _no_plan(known.infeasible, against)
        candidates = problem.site_candidate[list(known.incumbent.route)]
        order = tuple(int(problem.site_contour[s]) for s in known.incumbent.route)
        began_s = deadline.seconds
        missing = () if refine is None else refine(order)
        statements += missing
        if timed:
            spent, look_s = deadline.seconds, deadline.seconds - began_s
            if spent > whole:
                known.notes.append(f"rounds: the last look took {look_s:.1f} s, more than was left of the limit")
        if not missing or deadline.stopped or spent + look_s >= whole * (ENOUGH if timed else ENOUGH_WORK):
            break
    if missing:
        took = f" that ends with a look of {look_s:.1f} s" if timed else ""
        known.notes.append(f"rounds: what geometry found last is priced only; the limit leaves no further round{took}")
        posed = problem = make_problem(facts, statements, options.home_mm, options.feeds, posed)
        known = replace(known, incumbent=_judged_anew(problem, problem.candidate_site[candidates].tolist(), missing))
    return replace(_solution(problem, known, spent), problem=posed)


def _tell_found(
    found: Callable[[Solution], None], posed: Problem, problem: Problem, deadline: Deadline, plan: Incumbent
) -> None:
    """Tell of a plan of the problem that was simplified, as of one of the problem as it was posed."""
    known = SharedState(incumbent=plan, found_by="search")
    found(replace(_solution(problem, known, deadline.seconds), problem=posed))


def _always(share: float) -> bool:
    return True


def _in_time(deadline: Deadline, most_s: float) -> Callable[[float], bool]:
    """Whether work of which some share is done ends within so many seconds by its pace since it was first asked."""
    began_s: float | None = None

    def going(share: float) -> bool:
        nonlocal began_s
        began_s = deadline.seconds if began_s is None else began_s
        return deadline.seconds - began_s <= most_s * (share if share > PACE_KNOWN else 1.0)

    return going


def _known_route(problem: Problem, candidates: Sites | None, posed: Problem) -> tuple[int, ...] | None:
    """A route known before, where it may be gone on from; a site that another was never worse than is that other.

    One that breaks statements is none, but of a problem with statements over the whole order: the search mends it.
    """
    if candidates is None:
        return None
    route = [
        _alike(problem, int(c), posed) if problem.candidate_site[c] < 0 else s
        for c, s in zip(candidates, problem.candidate_site[candidates].tolist(), strict=True)
    ]
    if min(route, default=0) < 0 or not (problem.general or not broken(problem, route)):
        return None
    return tuple(route)


def _alike(problem: Problem, candidate: int, posed: Problem) -> int:
    """The cheapest site of a problem with the ends of a candidate that the problem as it was posed still has, or -1."""
    if (site := int(posed.candidate_site[candidate])) < 0:
        return -1
    sites = np.array(problem.sites(int(posed.site_contour[site])))
    same = (problem.pierce_um[sites] == posed.pierce_um[site]).all(axis=1)
    same &= (problem.end_um[sites] == posed.end_um[site]).all(axis=1)
    alike = sites[same]
    return int(alike[problem.site_cost[alike].argmin()]) if len(alike) else -1


def _solution(problem: Problem, known: SharedState, spent: float) -> Solution:
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
        notes=tuple(known.notes),
        left_out=problem.left_out,
    )


def _judged_anew(problem: Problem, route: list[int], missing: tuple[Statement, ...]) -> Incumbent:
    """The route at hand at the price of what was found missing last, when there is no time left to solve again."""
    if broken(problem, route):
        raise _no_plan(False, tuple(s.about.sentence for s in missing))
    return Incumbent(tuple(route), route_cost(problem, route))


def _unable(member: Member | None, why: str) -> InputError:
    return InputError(f"the engine {member} cannot plan this nest: {why}; take another engine, such as portfolio")


def _no_plan(infeasible: bool, reasons: tuple[str, ...] = ()) -> RulesConflict:
    if infeasible:
        return RulesConflict("no plan meets every hard rule", reasons, proven=True)
    return RulesConflict(
        "no plan that meets every hard rule was found within the limit (none is proven impossible)", reasons
    )
