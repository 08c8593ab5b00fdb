"""Builds the model, sets objective and hint, runs CP-SAT so that it can be stopped, and reads the route back."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import pairwise

from ortools.sat.python.cp_model import (
    FEASIBLE,
    INFEASIBLE,
    MODEL_INVALID,
    OPTIMAL,
    CpModel,
    CpSolver,
    CpSolverSolutionCallback,
    CpSolverStatus,
    IntVar,
    LinearExpr,
    LinearExprT,
)

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.deadline import Deadline, Progress
from kerfwise.models.engines.solution import Incumbent, count_site_arcs
from kerfwise.models.engines.tuning import MAX_ARCS, POLL_S
from kerfwise.models.engines.tuning import MODEL_MOST_CONTOURS as MOST_CONTOURS
from kerfwise.models.problem.evaluate import broken, general_holds, missing_ms, route_cost, times_ms
from kerfwise.models.problem.problem import Problem

from .constraints import add_constraints, inner
from .variables import (
    ArcLiterals,
    GoOn,
    OpenCrossing,
    Stopped,
    Variables,
    always,
    make_variables,
    report_progress,
    site_arcs,
)


def solve_cpsat(
    problem: Problem,
    deadline: Deadline,
    start: Incumbent | None,
    bound_um: int = 0,
    seed: int = 1,
    max_arcs: int = MAX_ARCS,
) -> CpsatOutcome:
    """Improve on `start`, a lawful route, and prove a bound, given one (µm) that is proven already.

    Ends when proven, at the deadline, or on Ctrl-C; what was found until then comes back. A model of more than
    `max_arcs` arcs between sites is not built. Raises AssertionError if the model and `models/problem/evaluate`
    disagree about a route: a bug in one of them.
    """
    if problem.n == 0:
        return CpsatOutcome(Incumbent((), 0), 0, proven_optimal=True)
    if problem.n > MOST_CONTOURS or count_site_arcs(problem) > max_arcs:
        return CpsatOutcome(start)
    go_on = report_progress(ENGINE, deadline, None if start is None else start.cost, bound_um)
    try:
        go_on()
        arcs = site_arcs(problem, problem.successors(), go_on)
        model, v = build_model(problem, arcs, go_on)
    except Stopped:
        return CpsatOutcome(start, bound_um)
    limit_objective(model, bound_um, None if start is None else start.cost)
    if start is not None:
        add_hint(model, problem, arcs, v, start.route)
    done = run_solver(model, seed, deadline.work, deadline)
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
    sentences = [about.sentence for about in broken(problem, route)]
    if sentences or cost > most_um:
        raise AssertionError(f"CP-SAT found {route} for {most_um} µm; it costs {cost} µm and breaks {sentences}")
    return Incumbent(tuple(route), cost)


# What a plan costs: idle travel, and the penalties of soft statements, in whole µm.


def set_objective(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables) -> None:
    """Minimise idle travel and penalties."""
    terms = [
        _travel(arcs, v),
        _sites(problem, v),
        _conditions(problem, v),
        *_groups(problem, v),
        _others(problem, v),
    ]
    model.minimize(LinearExpr.sum(terms))


def limit_objective(model: CpModel, least_um: int, most_um: int | None) -> None:
    """Tell the solver what is known of the cost: a proven lower bound, and the cost of a known route."""
    objective = model.proto.objective
    offset = round(objective.offset)  # the domain is that of the terms alone
    objective.domain.extend([least_um - offset, (1 << 60) if most_um is None else most_um - offset])


def _travel(arcs: ArcLiterals, v: Variables) -> LinearExprT:
    return LinearExpr.weighted_sum(v.travel, arcs.cost.tolist())


def _sites(problem: Problem, v: Variables) -> LinearExprT:
    """What using a site costs."""
    return LinearExpr.weighted_sum(v.pick, problem.site_cost.tolist())


def _conditions(problem: Problem, v: Variables) -> LinearExprT:
    """Every soft condition that is not met costs once."""
    return LinearExpr.weighted_sum(list(v.broken.values()), [problem.conditions[k].cost or 0 for k in v.broken])


def _groups(problem: Problem, v: Variables) -> Iterator[LinearExprT]:
    """A group in one piece has one inner step less than members; every further piece is one step fewer."""
    for group in problem.soft_groups:
        members = sorted(set(group.contours))
        steps = inner(v, members)
        yield LinearExpr.weighted_sum(steps, [-group.cost] * len(steps)) + group.cost * (len(members) - 1)


def _others(problem: Problem, v: Variables) -> LinearExprT:
    """Soft lags cost by the cut or the ms that is missing; soft general statements and moves over parts cost once."""
    return LinearExpr.weighted_sum(
        [*v.missing.values(), *v.failed.values(), *v.over.values(), *v.late.values()],
        [
            *(round((problem.lags[k].weight or 0.0) * UM_PER_MM) for k in v.missing),
            *(round((problem.general[k].weight or 0.0) * UM_PER_MM) for k in v.failed),
            *(v.crossings[k].cost for k in v.over),
            *(round(problem.lags[k].weight or 0.0) for k in v.late),
        ],
    )


# A known route as a complete hint: a value for every variable.


def add_hint(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables, route: Sequence[int]) -> None:
    """Hint at this route (sites in cutting order)."""
    picked = set(route)
    order = [int(problem.site_contour[s]) for s in route]
    position = {contour: k for k, contour in enumerate(order)}
    tour = set(pairwise([problem.m, *route, problem.m]))
    taken = {a for a, leg in enumerate(zip(arcs.tail.tolist(), arcs.head.tolist(), strict=True)) if leg in tour}
    values = {
        **_values(v.pick, (s in picked for s in range(problem.m))),
        **_values(v.travel, (a in taken for a in range(len(v.travel)))),
        **_values(v.follow.values(), _steps(v, pairwise([problem.n, *order, problem.n]))),
        **_values(v.position, (position[i] for i in range(problem.n))),
        **_values(v.broken.values(), (_unmet(problem, k, order, picked) for k in v.broken)),
        **_values(
            v.failed.values(), (not general_holds(problem, problem.general[k], position, picked) for k in v.failed)
        ),
        **_values(v.missing.values(), (_lacking(problem, k, position) for k in v.missing)),
        **_values(v.over.values(), (_crosses(v.crossings[k], taken, position) for k in v.over)),
    }
    if v.begin:
        times = times_ms(problem, route)
        values |= _values(v.begin, (times[i][0] for i in range(problem.n)))
        values |= _values(v.late.values(), (missing_ms(problem.lags[k], times) for k in v.late))
    for (i, j), literal in v.order.items():
        if isinstance(literal, IntVar):
            values[literal.index] = int(position[i] < position[j])
    hint = model.proto.solution_hint
    hint.vars.extend(values.keys())
    hint.values.extend(values.values())


def _values(variables: Iterable[IntVar], values: Iterable[int]) -> dict[int, int]:
    return {variable.index: int(value) for variable, value in zip(variables, values, strict=True)}


def _steps(v: Variables, taken: Iterable[tuple[int, int]]) -> list[int]:
    on_route = set(taken)
    return [step in on_route for step in v.follow]


def _unmet(problem: Problem, k: int, order: Sequence[int], picked: set[int]) -> bool:
    condition = problem.conditions[k]
    if condition.when is not None and condition.when not in picked:
        return False
    return not condition.met(set(order[: order.index(condition.contour)]))


def _crosses(crossing: OpenCrossing, taken: set[int], position: dict[int, int]) -> bool:
    return position[crossing.over] < position[crossing.leave] and not taken.isdisjoint(crossing.arcs)


def _lacking(problem: Problem, k: int, position: dict[int, int]) -> int:
    lag = problem.lags[k]
    return max(0, lag.cuts + 1 - abs(position[lag.first] - position[lag.second]))


# Runs CP-SAT so that it can be watched and stopped, and so that the same model gives the same answer.

ENGINE = "cp-sat"


@dataclass(frozen=True, eq=False, slots=True)
class CpsatRun:
    """A finished run; `interrupted` says that Ctrl-C ended it."""

    solver: CpSolver
    status: CpSolverStatus
    interrupted: bool

    @property
    def work(self) -> float:
        """Deterministic seconds that it took."""
        return float(self.solver.response_proto.deterministic_time)


def run_solver(model: CpModel, seed: int, work: float, progress: Progress) -> CpsatRun:
    """Solve until proven, out of work, told to stop by `progress`, or interrupted; what was found is kept.

    The solver runs in a thread of its own, so that this one can ask `progress` and hear Ctrl-C.
    """
    solver = _solver(seed, work)
    seen = _Seen()
    solver.best_bound_callback = seen.on_bound
    going, interrupted = True, False
    with ThreadPoolExecutor(max_workers=1) as pool:
        running = pool.submit(solver.solve, model, seen)
        while not running.done():
            try:
                wait([running], timeout=POLL_S)
                going = going and progress(ENGINE, seen.cost_um, seen.bound_um)
                if not going:
                    solver.stop_search()  # said again each time: the first may come before the search has begun
            except KeyboardInterrupt:
                going, interrupted = False, True
        return CpsatRun(solver, running.result(), interrupted)


def _solver(seed: int, work: float) -> CpSolver:
    """One worker, so that every run is the same, and linear programs with every cut: by far the fastest proofs here.

    Probing costs more than it finds in these models.
    """
    solver = CpSolver()
    parameters = solver.parameters
    parameters.num_workers = 1
    parameters.random_seed = seed
    parameters.linearization_level = 2
    parameters.cp_model_probing_level = 0
    parameters.max_deterministic_time = work
    parameters.catch_sigint_signal = False
    return solver


class _Seen(CpSolverSolutionCallback):
    """Notes the best cost and bound seen so far, µm."""

    def __init__(self) -> None:
        super().__init__()
        self.cost_um: int | None = None
        self.bound_um: int | None = None

    def on_solution_callback(self) -> None:
        self.cost_um = round(self.objective_value)

    def on_bound(self, bound: float) -> None:
        self.bound_um = round(bound)


# What CP-SAT answers.


@dataclass(frozen=True, slots=True)
class CpsatOutcome:
    """The best route known, and what is proven.

    `bound` is a lower bound for the whole problem, µm (None where nothing was proven); `interrupted` says that Ctrl-C
    ended the search; `work` is what the solver took of its limit.
    """

    incumbent: Incumbent | None
    bound: int | None = None
    proven_optimal: bool = False
    infeasible: bool = False
    interrupted: bool = False
    work: float = 0.0
