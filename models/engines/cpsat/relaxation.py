"""A smaller model for large nests: every contour as one point. Its bound holds for the whole problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from ortools.sat.python.cp_model import INFEASIBLE

from kerfwise.models.engines.solution import Incumbent, Progress, SolveOptions
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.links import Links
from kerfwise.models.problem.pace import Pace
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Before

from .hint import add_hint
from .in_time import GoOn
from .model import build_model, proven_bound
from .objective import limit_objective
from .outcome import CpsatOutcome
from .prices import PricedArcs
from .run import run_solver


def solve_relaxed(
    problem: Problem,
    priced: PricedArcs,
    options: SolveOptions,
    start: Incumbent | None,
    bound_um: int,
    progress: Progress,
    go_on: GoOn,
) -> CpsatOutcome:
    """A proven lower bound from the cheapest arcs between contours; no route but `start` comes back.

    Every route of the whole problem is one of the relaxed problem, and costs no less there.
    """
    relaxed = by_contours(problem)
    model, v = build_model(relaxed, priced.arcs, go_on)
    # `bound_um` need not hold for the relaxed problem, and is no limit to it
    limit_objective(model, priced.bound, None if start is None else start.cost)
    if start is not None:
        add_hint(model, relaxed, priced.arcs, v, [int(problem.site_contour[s]) for s in start.route])
    done = run_solver(model, options, _of_plans(progress, start, bound_um))
    if done.status == INFEASIBLE and start is None:
        return CpsatOutcome(None, infeasible=True, work=done.work)
    bound = max(bound_um, proven_bound(done, priced.bound))
    proven = start is not None and bound >= start.cost
    return CpsatOutcome(start, bound, proven, interrupted=done.interrupted, work=done.work)


def _of_plans(progress: Progress, start: Incumbent | None, proven_um: int) -> Progress:
    """Tells `progress` of the known plan: what a relaxed route costs is not what a plan does."""

    def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        return progress(engine, None if start is None else start.cost, max(proven_um, bound_um or 0))

    return going


def by_contours(problem: Problem) -> Problem:
    """The problem with one site a contour; what is said of one site among several, of moves or of seconds is left out.

    Where the sites lie is left as it was and means nothing here: the arcs know what travel costs.
    """
    single = np.diff(problem.first) == 1
    return replace(
        problem,
        first=np.arange(problem.n + 1, dtype=np.int64),
        site_contour=np.arange(problem.n, dtype=np.int64),
        site_candidate=problem.site_candidate[problem.first[:-1]],
        site_cost=np.zeros(problem.n, dtype=np.int64),
        conditions=tuple(replace(c, when=None) for c in problem.conditions if c.when is None or single[c.contour]),
        lags=tuple(replace(lag, seconds=0.0) for lag in problem.lags),
        general=tuple(
            s for s in problem.general if s.when is None and all(isinstance(lit, Before) for lit in s.literals)
        ),
        crossings=Crossings(),
        pace=Pace(),
        links=Links(),
    )
