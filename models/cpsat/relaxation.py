"""A smaller model for large nests: every contour as one point. Its bound holds for the whole problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from ortools.sat.python.cp_model import INFEASIBLE

from ...rules.statements import Before
from ..crossings import Crossings
from ..pace import Pace
from ..problem import Problem
from ..solution import Incumbent, Progress, SolveOptions
from .arcs import Arcs
from .hint import add_hint
from .model import build, proven_bound
from .objective import limit_objective
from .outcome import Outcome
from .run import run


def solve_relaxed(
    problem: Problem,
    arcs: Arcs,
    options: SolveOptions,
    start: Incumbent | None,
    bound_um: int,
    progress: Progress | None,
) -> Outcome:
    """A proven lower bound from arcs between contours (see `contour_arcs`); no route but `start` comes back.

    Every route of the whole problem is one of the relaxed problem, and costs no less there.
    """
    relaxed = by_contours(problem)
    model, v = build(relaxed, arcs)
    limit_objective(model, 0, None if start is None else start.cost)  # `bound_um` need not hold for the relaxed problem
    if start is not None:
        add_hint(model, relaxed, arcs, v, [int(problem.site_contour[s]) for s in start.route])
    done = run(model, options, progress)
    if done.status == INFEASIBLE and start is None:
        return Outcome(None, infeasible=True)
    bound = proven_bound(done, bound_um)
    return Outcome(start, bound, start is not None and bound >= start.cost, interrupted=done.interrupted)


def by_contours(problem: Problem) -> Problem:
    """The problem with one site a contour, at its least cost.

    What is said of one site among several, of moves or of seconds is left out.

    Where the sites lie is left as it was and means nothing here: `contour_arcs` measures the travel.
    """
    single = np.diff(problem.first) == 1
    contours = np.arange(problem.n, dtype=np.int64)
    return replace(
        problem,
        lags=tuple(replace(lag, seconds=0.0) for lag in problem.lags),
        crossings=Crossings(),
        pace=Pace(),
        first=np.arange(problem.n + 1, dtype=np.int64),
        site_contour=contours,
        site_candidate=problem.site_candidate[problem.first[:-1]],
        site_cost=np.minimum.reduceat(problem.site_cost, problem.first[:-1]),
        conditions=tuple(replace(c, when=None) for c in problem.conditions if c.when is None or single[c.contour]),
        general=tuple(
            s for s in problem.general if s.when is None and all(isinstance(lit, Before) for lit in s.literals)
        ),
    )
