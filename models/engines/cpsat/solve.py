"""The entry: the model that the size of the problem allows, whole or as a relaxation with priced sites."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from ortools.sat.python.cp_model import INFEASIBLE
from scipy.optimize import linear_sum_assignment

from kerfwise.arrays import Ints
from kerfwise.models.engines.deadline import Deadline, Progress
from kerfwise.models.engines.solution import MAX_ARCS, Incumbent, count_site_arcs
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.problem import Durations, Links, Problem
from kerfwise.rules.statements import Before

from .model import ENGINE, CpsatOutcome, add_hint, build_model, limit_objective, proven_bound, run_solver, solve_whole
from .variables import ArcLiterals, GoOn, Stopped, always, report_progress, site_arcs

MOST_ARCS = 20_000_000
"""More arcs between sites than this are not even listed."""
MAX_CONTOURS = 3_000


def solve_cpsat(
    problem: Problem,
    deadline: Deadline,
    start: Incumbent | None,
    bound_um: int = 0,
    seed: int = 1,
    max_arcs: int = MAX_ARCS,
) -> CpsatOutcome:
    """Improve on `start`, a lawful route, and prove a bound, given one (µm) that is proven already.

    Ends when proven, at the deadline, or on Ctrl-C;
    what was found until then comes back. A model of more than `max_arcs` arcs between sites is not built: a smaller
    one then gives a bound only; if that is too large as well, its prices alone do, or nothing.

    Raises
    ------
    AssertionError
        If the model and `models/problem/evaluate` disagree about a route: a bug in one of them.
    """
    if problem.n == 0:
        return CpsatOutcome(Incumbent((), 0), 0, proven_optimal=True)
    if problem.n > MAX_CONTOURS:
        return CpsatOutcome(start)
    go_on = report_progress(ENGINE, deadline, None if start is None else start.cost, bound_um)
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
        go_on = report_progress(ENGINE, deadline, None if start is None else start.cost, bound_um)
        go_on()
        if count <= max_arcs:
            return solve_whole(problem, arcs, deadline, start, bound_um, seed, go_on)
        if len(priced.arcs.cost) <= max_arcs:
            return solve_relaxed(problem, priced, deadline, start, bound_um, seed, go_on)
    except Stopped:
        pass
    return CpsatOutcome(start, bound_um)


# A smaller model for large nests: every contour as one point. Its bound holds for the whole problem.


def solve_relaxed(
    problem: Problem,
    priced: PricedArcs,
    deadline: Deadline,
    start: Incumbent | None,
    bound_um: int,
    seed: int,
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
    done = run_solver(model, seed, deadline.work, _of_plans(deadline, start, bound_um))
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
        pace=Durations(),
        links=Links(),
        moves=MovePrices(),
    )


# Prices on sites, so that a model of contours alone knows something of sites.
#
# Taking the cheapest arc between every two contours allows a route to come to a contour at one site and leave it from
# another. A price that is paid for coming to a site and given back for leaving from it changes the cost of no real
# route, but makes that dear. Good prices are found by subgradients (Held and Karp 1971) on the cheapest assignment of
# a successor to every contour, whose cost is a lower bound already.

ROUNDS = 200
EFFORT = 100_000_000
"""Numbers to look at in all rounds together: large nests get fewer rounds."""
PATIENCE = 8
"""Rounds without a better bound after which the steps become shorter."""
NEVER = 1e15
"""Cost of an arc that there is not, µm: more than any route."""


@dataclass(frozen=True, eq=False, slots=True)
class PricedArcs:
    """One arc between every two contours, which no route undercuts, and what every route costs at least, µm.

    In these arcs a site is a contour; what using a site costs is in the arcs that reach it.
    """

    arcs: ArcLiterals
    bound: int


def price_sites(
    problem: Problem, arcs: ArcLiterals, target_um: int | None, rounds: int = ROUNDS, go_on: GoOn = always
) -> PricedArcs:
    """Look for prices that make the bound as high as can be; `target_um` is the cost of a known route.

    `go_on` is asked every round.
    """
    costs = arcs.cost + np.append(problem.site_cost, 0)[arcs.head]
    prices = best = np.zeros(problem.m + 1, dtype=np.int64)
    bound, step, waited = 0.0, 1.0, 0
    for _ in range(min(rounds, EFFORT // (len(costs) + (problem.n + 1) ** 2))):
        go_on()
        least, reached = _assigned(problem.n, arcs, costs + prices[arcs.head] - prices[arcs.tail])
        if least > bound:
            bound, best, waited = least, prices, 0
        else:
            waited += 1
        if waited == PATIENCE:
            prices, step, waited = best, step * 0.7, 0
            continue
        uneven = np.bincount(arcs.head[reached], minlength=problem.m + 1)
        uneven -= np.bincount(arcs.tail[reached], minlength=problem.m + 1)
        uneven[problem.m] = 0
        if not uneven.any() or bound >= NEVER:
            break
        missing = max(0.0, (1.1 * bound if target_um is None else target_um) - least)
        prices = prices + np.rint(step * missing / (uneven @ uneven) * uneven).astype(np.int64)
    cost = np.minimum.reduceat(costs + best[arcs.head] - best[arcs.tail], arcs.first[:-1])
    contours = ArcLiterals(arcs.groups, np.arange(len(cost) + 1), arcs.groups[:, 0], arcs.groups[:, 1], cost)
    return PricedArcs(contours, int(bound))


def _assigned(n: int, arcs: ArcLiterals, costs: Ints) -> tuple[float, Ints]:
    """The cheapest assignment of a successor to every contour and to home, and its arcs."""
    least = np.minimum.reduceat(costs, arcs.first[:-1])
    matrix = np.full((n + 1, n + 1), NEVER)
    matrix[arcs.groups[:, 0], arcs.groups[:, 1]] = least
    rows, columns = linear_sum_assignment(matrix)
    chosen = np.zeros((n + 1, n + 1), dtype=np.bool_)
    chosen[rows, columns] = True
    sizes = np.diff(arcs.first)
    in_chosen = np.repeat(chosen[arcs.groups[:, 0], arcs.groups[:, 1]], sizes)
    cheapest = np.flatnonzero(in_chosen & (costs == np.repeat(least, sizes)))
    _, one_each = np.unique(np.repeat(np.arange(len(sizes)), sizes)[cheapest], return_index=True)
    return float(matrix[rows, columns].sum()), cheapest[one_each]
