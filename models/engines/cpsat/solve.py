"""The entry: takes the model that the size of the problem allows."""

from __future__ import annotations

from kerfwise.models.engines.setting_out import MAX_ARCS, count_site_arcs
from kerfwise.models.engines.solution import Incumbent, Progress, SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.models.problem.problem import Problem

from .arcs import site_arcs
from .in_time import Stopped, asked, until
from .model import solve_whole
from .outcome import CpsatOutcome
from .prices import NEVER, price_sites
from .relaxation import solve_relaxed
from .run import ENGINE

MOST_ARCS = 20_000_000
"""More arcs between sites than this are not even listed."""
MAX_CONTOURS = 3_000


def solve_cpsat(
    problem: Problem,
    options: SolveOptions,
    start: Incumbent | None,
    bound_um: int = 0,
    progress: Progress | None = None,
    max_arcs: int = MAX_ARCS,
) -> CpsatOutcome:
    """Improve on `start`, a lawful route, and prove a bound, given one (µm) that is proven already.

    Ends when proven, when `options.work` or `options.time_s` is used up, when `progress` returns False, or on Ctrl-C;
    what was found until then comes back. A model of more than `max_arcs` arcs between sites is not built: a smaller
    one then gives a bound only; if that is too large as well, its prices alone do, or nothing.

    Raises
    ------
    AssertionError
        If the model and `models/problem/evaluate` disagree about a route: a bug in one of them.
    """
    progress = until(progress, None if options.time_s is None else running_s() + options.time_s)
    if problem.n == 0:
        return CpsatOutcome(Incumbent((), 0), 0, proven_optimal=True)
    if problem.n > MAX_CONTOURS:
        return CpsatOutcome(start)
    go_on = asked(ENGINE, progress, None if start is None else start.cost, bound_um)
    try:
        go_on()
        count = count_site_arcs(problem)
        if count > MOST_ARCS:
            return CpsatOutcome(start)
        arcs = site_arcs(problem, problem.successors(), go_on)
        priced = price_sites(problem, arcs, None if start is None else start.cost, go_on=go_on)
        if priced.bound >= NEVER:
            return CpsatOutcome(None, infeasible=True)
        bound_um = max(bound_um, priced.bound)
        go_on = asked(ENGINE, progress, None if start is None else start.cost, bound_um)
        go_on()
        if count <= max_arcs:
            return solve_whole(problem, arcs, options, start, bound_um, progress, go_on)
        if len(priced.arcs.cost) <= max_arcs:
            return solve_relaxed(problem, priced, options, start, bound_um, progress, go_on)
    except Stopped:
        pass
    return CpsatOutcome(start, bound_um)
