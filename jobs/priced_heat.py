"""The price that a profile puts on overheats: prices of orders and entries, and the plan that is best by simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.heat_prices.cooler_orders import ROUNDS, CoolerOrders
from kerfwise.models.kernels import running_s
from kerfwise.models.physics.heat.route_path import RoutePaths
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy import afterthoughts
from kerfwise.rules.stating.state_rules import Stated

from .ask import Asked

FIRST = 0.4
"""Share of the limits for the plan without prices: what is proven is proven there."""
LATER = (1 - FIRST) / ROUNDS
"""Share for each plan with prices."""

SolveStated = Callable[[float, Stated], Solution]
"""Solves with a share of the limits."""


def cooler_orders(facts: Facts, profile: Profile, stated: Stated) -> CoolerOrders:
    """What finds cooler orders that keep the statements; nothing is simulated yet."""
    home, feeds = profile.home_on(facts.nest), feeds_of(profile)
    problem = make_problem(facts, stated.statements, home, feeds)
    paths = RoutePaths(facts, profile.material.kerf_mm, feeds, home)
    return CoolerOrders(facts, problem, profile.heat, profile.material.thickness_mm, paths)


def with_heat_prices(facts: Facts, profile: Profile, stated: Stated) -> Stated:
    """The statements with the prices that random orders tell; as they are where overheats cost nothing.

    The prices that a plan was made with in the end are fitted to routes near to it as well, and so differ somewhat.

    Raises
    ------
    RulesConflict
        If no lawful order came of many attempts at random.
    """
    if not profile.objective.heat or not profile.heat.absorbed_power_w:
        return stated
    cooler = cooler_orders(facts, profile, stated)
    cooler.start()
    found = cooler.statements(cooler.prices(), profile.objective.heat)
    return replace(stated, statements=(*stated.statements, *found))


def solve_priced(
    asked: Asked,
    profile: Profile,
    limits: SolveOptions,
    solved: SolveStated,
    progress: Progress | None = None,
    cooler: CoolerOrders | None = None,
) -> tuple[Solution, Stated]:
    """The best plan by simulation at the profile's price of an overheat, and the statements with the last prices.

    The objective is what the plan costs by the rules, with its overheats as simulated. A sheet might have none of
    those, so the bound is that of the rules alone. A time limit ends the simulations, too.

    Raises
    ------
    RulesConflict
        If no lawful plan exists, or none was found.
    """
    facts, stated, price_mm = asked.facts, asked.stated, profile.objective.heat
    cooler = cooler or cooler_orders(facts, profile, stated)
    began_s, made = running_s(), list[Solution]()

    def going() -> bool:
        in_time = limits.time_s is None or running_s() - began_s < limits.time_s * (1 - LATER)
        return in_time and (progress is None or progress("heat", None, None))

    def planner(k: int, further: tuple[Statement, ...]) -> Sequence[int]:
        part = replace(stated, statements=(*stated.statements, *further))
        made.append(solved(LATER if k else FIRST, part))
        return made[-1].route

    def judge(route: Sequence[int]) -> float | None:
        order = [facts.candidates[c].contour for c in route]
        rules = (*stated.statements, *afterthoughts(facts, profile)(order))
        problem = make_problem(facts, rules, profile.home_on(facts.nest), feeds_of(profile))
        sites = problem.candidate_site[list(route)].tolist()
        return None if broken(problem, sites) else route_cost(problem, sites) / UM_PER_MM

    found = cooler.find(price_mm, planner, judge, going, limits.seed)
    first, objective = made[0], found.cost_mm + price_mm * found.overheats
    bound = None if first.bound is None else min(first.bound, objective)
    solution = replace(
        first,
        route=found.route,
        objective=objective,
        bound=bound,
        status="optimal" if bound is not None and objective <= bound else "feasible",
        found_by="simulation",
        seconds=sum(one.seconds for one in made),
        notes=tuple(note for one in made for note in one.notes),
    )
    further = cooler.statements(found.prices, price_mm)
    return solution, replace(stated, statements=(*stated.statements, *further))
