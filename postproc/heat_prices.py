"""The price that a profile puts on overheats, as prices of pairs that are fitted to simulations of the very nest."""

from __future__ import annotations

from dataclasses import replace

from ..encoder.facts.facts import Facts
from ..models.baselines.random_order import random_order
from ..models.heat import simulate
from ..models.heat.grid import make_grid
from ..models.heat.pair_prices import ORDERS, PairPrices, fit_pair_prices
from ..models.heat.route_path import RoutePaths
from ..models.problem import make_problem
from ..models.timing.choose import feeds_of
from ..rules.profile import Profile
from ..rules.state import Stated


def pair_prices(facts: Facts, profile: Profile, stated: Stated) -> PairPrices:
    """What it costs in overheats that one contour comes before another, from random orders that keep the hard rules.

    Raises
    ------
    RulesConflict
        If no lawful order came of many attempts at random.
    """
    machine, heat, thickness_mm = profile.machine, profile.heat, profile.material.thickness_mm
    feeds = feeds_of(profile)
    problem = make_problem(facts, stated.statements, machine.home, feeds)
    paths = RoutePaths(facts, profile.material.kerf_mm, feeds, machine.home)
    routes = [random_order(problem, seed, first_entry=True) for seed in range(ORDERS)]
    timed = [paths.of(problem.site_candidate[list(route)].tolist()) for route in routes]
    grid = make_grid(facts.nest, heat.grid_mm)
    orders = [problem.site_contour[list(route)].tolist() for route in routes]

    def overheats(k: int) -> int:
        return simulate(facts.nest, timed[k], heat, thickness_mm, grid=grid).overheats

    return fit_pair_prices(facts.nest, heat, orders, overheats)


def with_heat_prices(facts: Facts, profile: Profile, stated: Stated) -> Stated:
    """The statements with what an overheat costs by the profile's objective; as they are where it costs nothing."""
    price_mm = profile.objective.heat
    if not price_mm or not profile.heat.absorbed_power_w:
        return stated
    found = pair_prices(facts, profile, stated).statements(facts.nest, price_mm)
    return replace(stated, statements=(*stated.statements, *found))
