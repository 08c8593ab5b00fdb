"""Plain strategies to compare the solver with: shortest path, random, Realtime (Verkhoturov et al.)."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.engines.baselines import Strategy
from kerfwise.models.engines.baselines.random_order import random_order
from kerfwise.models.engines.baselines.realtime import realtime_order
from kerfwise.models.engines.rounds import solve
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.physics.heat.route_path import RoutePaths
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, Statement


def solve_by(
    strategy: Strategy,
    facts: Facts,
    profile: Profile,
    statements: tuple[Statement, ...],
    limits: SolveOptions,
    progress: Progress | None = None,
) -> Solution:
    """A route by a plain strategy that keeps every hard statement; soft ones are not looked at.

    Raises
    ------
    RulesConflict
        If it finds none.
    """
    prices = by_kind(statements).idle_travel
    bare = tuple(s for s in statements if s in prices or _binds(s))
    if strategy == "shortest":
        return solve(facts, bare, limits, progress)
    problem = make_problem(facts, bare, limits.home_mm, limits.feeds)
    if strategy == "random":
        route: Sequence[int] = random_order(problem, limits.seed)
    else:
        feeds, material = feeds_of(profile), profile.material
        paths = RoutePaths(facts, material.kerf_mm, feeds, limits.home_mm)
        route = realtime_order(problem, facts, profile.heat, material.thickness_mm, paths)
    return Solution(
        route=tuple(problem.site_candidate[list(route)].tolist()),
        objective=route_cost(problem, route) / UM_PER_MM,
        bound=None,
        status="feasible",
        found_by=strategy,
        proved_by="",
        seconds=0.0,
    )


def _binds(statement: Statement) -> bool:
    """Whether it is hard, or hard but for excuses."""
    return statement.weight is None or statement.weight >= EXEMPTION_MM
