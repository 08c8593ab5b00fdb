"""Builds the model, solves it and reads the route back."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ortools.sat.python.cp_model import FEASIBLE, INFEASIBLE, MODEL_INVALID, OPTIMAL, CpModel, CpSolver

from kerfwise.models.engines.solution import Incumbent, Progress, SolveOptions
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem

from .arcs import ArcLiterals
from .constraints import add_constraints
from .hint import add_hint
from .in_time import GoOn, always
from .objective import limit_objective, set_objective
from .outcome import CpsatOutcome
from .run import CpsatRun, run_solver
from .variables import Variables, make_variables


def solve_whole(
    problem: Problem,
    arcs: ArcLiterals,
    options: SolveOptions,
    start: Incumbent | None,
    bound_um: int,
    progress: Progress,
    go_on: GoOn,
) -> CpsatOutcome:
    """Solve the model of the whole problem, given a lawful route and a proven lower bound."""
    model, v = build_model(problem, arcs, go_on)
    limit_objective(model, bound_um, None if start is None else start.cost)
    if start is not None:
        add_hint(model, problem, arcs, v, start.route)
    done = run_solver(model, options, progress)
    bound = proven_bound(done, bound_um)
    if done.status == INFEASIBLE and start is None:
        return CpsatOutcome(None, infeasible=True, work=done.work)
    found = start
    if done.status in (OPTIMAL, FEASIBLE):
        found = _checked(problem, _route(problem, arcs, v, done.solver), round(done.solver.objective_value))
    elif done.status in (INFEASIBLE, MODEL_INVALID):
        raise AssertionError(f"CP-SAT calls the model {done.status.name}, given {start}")
    proven = found is not None and bound >= found.cost
    return CpsatOutcome(found, bound, proven, interrupted=done.interrupted, work=done.work)


def build_model(problem: Problem, arcs: ArcLiterals, go_on: GoOn = always) -> tuple[CpModel, Variables]:
    """The model of a problem over these arcs; `go_on` is asked between its families of constraints."""
    model = CpModel()
    v = make_variables(model, problem, arcs)
    add_constraints(model, problem, arcs, v, go_on)
    set_objective(model, problem, arcs, v)
    return model, v


def proven_bound(done: CpsatRun, bound_um: int) -> int:
    """The better of what the run has proven and of what was known before, whole µm."""
    return max(bound_um, math.ceil(done.solver.best_objective_bound - 1e-6))


def _route(problem: Problem, arcs: ArcLiterals, v: Variables, solver: CpSolver) -> tuple[int, ...]:
    legs = zip(arcs.tail.tolist(), arcs.head.tolist(), v.travel, strict=True)
    after = {tail: head for tail, head, literal in legs if solver.boolean_value(literal)}
    route = [after[problem.m]]
    while len(route) < problem.n:
        route.append(after[route[-1]])
    return tuple(route)


def _checked(problem: Problem, route: Sequence[int], most_um: int) -> Incumbent:
    """The route at its real cost, which is at most what the model has for it.

    Where nothing is proven yet, the solver may still pay for statements that its route keeps: literals of penalties are
    only tied to what they pay for in one direction, and it is the objective that drives them down.
    """
    cost = route_cost(problem, route)
    said = [about.sentence for about in broken(problem, route)]
    if said or cost > most_um:
        raise AssertionError(f"CP-SAT found {route} for {most_um} µm; it costs {cost} µm and breaks {said}")
    return Incumbent(tuple(route), cost)
