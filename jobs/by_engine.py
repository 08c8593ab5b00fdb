"""A request solved by the engines, by MiniZinc, or by a plain strategy to compare with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines import Engine, Strategy
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions, Status
from kerfwise.models.engines.tuning import LARGE_NEST as FEW
from kerfwise.models.engines.tuning import MOST_CONTOURS
from kerfwise.models.jit import running_s
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements, look_takes_s
from kerfwise.rules.stating.state_rules import Stated

from .adaptive_zones import rungs
from .inputs import expect_one_torch
from .request import Request

if TYPE_CHECKING:
    from .cooler_orders import SimulatedOrders

GECODE = "gecode"
OrdersOf = Callable[[Facts, Profile, Stated], "SimulatedOrders"]
"""Makes what finds orders by simulation."""


class Method(NamedTuple):
    """How a plan is looked for.

    Attributes
    ----------
    engine, solver
        Who plans; `solver` is that of the engine minizinc.
    strategy
        A plain one takes the engine's place, to compare with.
    start
        A plan at hand, as of the nest before an edit: the new one costs no more than this does under what is asked now.
    first
        Give the first lawful plan and stop, but where temperature, or a price on what a simulation shows, decides.
    orders
        What finds orders by another simulation than that of heat, where the profile has a price on what that shows.
    """

    engine: Engine = "portfolio"
    solver: str = GECODE
    strategy: Strategy = "ours"
    start: Plan | None = None
    first: bool = False
    orders: OrdersOf | None = None

    @property
    def is_portfolio(self) -> bool:
        """Whether all engines plan together."""
        return self.engine == "portfolio" and self.strategy == "ours"

    @property
    def named(self) -> Engine:
        """The engine that the plan names."""
        return self.engine if self.strategy == "ours" else "portfolio"

    def expect_fits(self, profile: Profile) -> None:
        """Refuse a plan to start from, a first plan or a solver of another engine, and MiniZinc where it cannot plan.

        Raises InputError if so, or MiniZinc, or its solver, is missing or broken.
        """
        if (self.start is not None or self.first) and not self.is_portfolio:
            raise InputError("a first plan, or one that goes on from another, is made by the engine portfolio alone")
        if self.engine == "minizinc":
            expect_one_torch(profile, "the engine minizinc")
            from kerfwise.rules.minizinc.installation import solver_named

            solver_named(self.solver)
        elif self.solver != GECODE:
            raise InputError(f"the solver {self.solver} is for the engine minizinc")

    def looks_at_zones(self, contours: int, profile: Profile) -> bool:
        """Whether anybody looks at zones that geometry draws: a first plan has the whole sheet in one."""
        simulates = self.orders is not None or profile.objective.heat or profile.temperature_limit() is not None
        if not self.first or self.start is not None or simulates or contours > MOST_CONTOURS:
            return True
        book = profile.rulebook()
        return not any(book[name].makes_zones and on.weight is None for name, on in profile.settings().items())


PORTFOLIO = Method()
"""All engines, from nothing, until the limit or the proof."""


def solve_by(
    method: Method,
    request: Request,
    profile: Profile,
    limits: SolveOptions,
    further: tuple[Statement, ...] = (),
    progress: Progress | None = None,
    found: Callable[[Solution], None] | None = None,
    start: Sequence[int] = (),
) -> Solution:
    """What the engine makes of the statements and further ones; MiniZinc and plain strategies know no further ones.

    The portfolio goes on from the route `start` where that is lawful.

    Raises RulesConflict if no lawful plan exists, or none was found.
    """
    facts, stated = request.facts, request.stated
    refine = lazy_statements(facts, profile)
    if method.strategy != "ours":
        from kerfwise.models.engines.baselines import solve_by as solve_plainly

        from .route_paths import RoutePaths

        burn = RoutePaths(facts, profile, stated).burn
        found_plainly = solve_plainly(method.strategy, facts, profile, stated.statements, limits, burn, progress)
        return _priced(found_plainly, facts, profile, stated.statements)
    if method.engine == "minizinc":
        from kerfwise.models.engines.minizinc_engine import solve_minizinc

        return solve_minizinc(facts, profile, stated, limits, method.solver, refine, progress)
    from kerfwise.models.engines.solve import solve

    look_s = 0.0
    if limits.time_s is not None:
        began_s = running_s()
        look_s = look_takes_s(facts, profile)
        limits = replace(limits, time_s=max(limits.time_s - (running_s() - began_s), limits.time_s / 2))
    return solve(facts, (*stated.statements, *further), limits, progress, refine, look_s, start, found)


def by_all_rules(
    route: Sequence[int], facts: Facts, profile: Profile, statements: Sequence[Statement]
) -> tuple[Problem, list[int]]:
    """The problem that a route is priced by, with all that geometry finds missing of its order, and its sites there."""
    seen = lazy_statements(facts, profile)([facts.candidates[c].contour for c in route])
    problem = make_problem(facts, (*statements, *seen), profile.home_on(facts.nest), feeds_of(profile))
    return problem, problem.candidate_site[list(route)].tolist()


def _priced(solution: Solution, facts: Facts, profile: Profile, statements: tuple[Statement, ...]) -> Solution:
    """The solution at its price under all rules, of which a plain strategy does not look at the soft ones."""
    cost_mm = route_cost(*by_all_rules(solution.route, facts, profile, statements)) / UM_PER_MM
    status: Status = "optimal" if solution.bound is not None and cost_mm <= solution.bound else "feasible"
    return replace(solution, objective=cost_mm, status=status, problem=None)


def with_less_work(
    solved: Callable[[float], Solution], contours: int, limits: SolveOptions, progress: Progress | None = None
) -> Solution:
    """What a share of the work, 1 at first, brings, or, where that is not proven, what less of it would have brought.

    More work takes other ways, and may end in a dearer plan: so it is done with each of the lower rungs, too, which
    comes to half as much again. What is proven at one of them is proven.
    """
    best = solved(1.0)
    if limits.time_s is not None or limits.gap is not None or limits.no_improvement_s is not None or contours > FEW:
        return best
    for rung in list(rungs(contours, limits.work))[:-1]:
        if best.status == "optimal" or (progress is not None and not progress("portfolio", None, None)):
            break
        try:
            other = solved(rung / limits.work)
        except RulesConflict:  # so little work may find none
            continue
        if other.left_out != best.left_out:
            continue
        cheaper = other if other.objective < best.objective else best
        known = max(best, other, key=lambda one: one.bound or 0.0)
        proven = known.bound is not None and known.bound >= cheaper.objective
        status: Status = "optimal" if proven else "feasible"
        best = replace(cheaper, bound=known.bound, proved_by=known.proved_by, status=status, notes=best.notes)
    return best
