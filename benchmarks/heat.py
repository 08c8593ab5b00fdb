"""What the prices of heat predict, and what they save: on five nests, against simulation.

Usage: python benchmarks/heat.py [--limit C] [--orders N] [--work W]

First, over random lawful orders and entries that the prices were not fitted to, the rank correlation (Spearman) of
what the prices say with the overheats of the physical simulation. Then four strategies: shortest path, random, Realtime
of Verkhoturov et al., and ours, at several prices of an overheat. Only the rules of Verkhoturov et al. bind the orders:
holes before outers, nested parts first, the contours of a part together. The last two nests were looked at only when
the method stood.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr

import kerfwise
from kerfwise.benchmarks.plates import made_plate
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.cooler_orders import CoolerOrders
from kerfwise.jobs.heat_control import cooler_orders, solve_priced
from kerfwise.jobs.request import Request, facts_of, options_for
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.engines.baselines import random_order, realtime_order
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.engines.tuning import COOLER_ORDERS_DRAWN as ORDERS
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.timed_path import Grid, make_grid
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.stating.state_rules import Stated, state_rules

EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"
RULES = ("inner-before-outer", "nested-before-host-holes", "part-contiguous", "cut-direction", "pierce", "marks-first")
PRICES_MM = (10.0, 30.0, 100.0)
RANDOM_SEEDS = range(5)
UNSEEN = 10_000
"""Seeds of random orders from here on are not those that prices are fitted to."""


@dataclass(frozen=True)
class Bench:
    """One nest, ready to be ordered and simulated."""

    name: str
    profile: Profile
    facts: Facts
    stated: Stated
    problem: Problem
    paths: RoutePaths
    grid: Grid

    def overheats(self, route: Sequence[int]) -> int:
        """By simulation of a route of candidates."""
        heat, thickness_mm = self.profile.heat, self.profile.material.thickness_mm
        return simulate(self.facts.nest, self.paths.of(route), heat, thickness_mm, grid=self.grid).overheats

    def candidates(self, sites: Sequence[int]) -> list[int]:
        """The candidates that sites of the problem stand for."""
        return [int(self.problem.site_candidate[s]) for s in sites]

    def broken(self, route: Sequence[int]) -> int:
        """How many hard statements a route of candidates breaks."""
        return len(broken(self.problem, self.problem.candidate_site[list(route)].tolist()))

    def solve(self, work: float, stated: Stated) -> Solution:
        """A plan by statements."""
        options = options_for(self.facts.nest, self.profile, work=work)
        return solve(self.facts, stated.statements, options)

    def idle_mm(self, route: Sequence[int]) -> float:
        """Idle travel of a route of candidates, from home and back."""
        home = self.profile.home_on(self.facts.nest)
        ends = [home, *(self.facts.candidates[c].end for c in route)]
        starts = [*(self.facts.candidates[c].pierce for c in route), home]
        return float(np.hypot(*(np.array(ends) - np.array(starts)).T).sum())


def plant(limit_c: float) -> Profile:
    """The default profile with the rules of Verkhoturov et al. alone and another limit."""
    profile = load_profile()
    rules = {k: s if k in RULES else RuleSetting("off", None, s.options) for k, s in profile.rules.items()}
    return replace(profile, rules=rules, heat=replace(profile.heat, limit_c=limit_c))


def nests() -> Iterator[tuple[str, Nest]]:
    """Two example nests and three made plates."""
    yield "e1x_6", read_nest(EXAMPLES / "e1x_6.json")
    yield "plate40", read_nest(EXAMPLES / "plate40.json")
    for parts, seed in ((30, 2), (24, 11), (36, 12)):
        yield f"plate {parts}, seed {seed}", made_plate(parts, seed)


def bench(name: str, nest: Nest, profile: Profile) -> Bench:
    """Facts, statements and problem of a nest."""
    facts, feeds = facts_of(nest, profile), feeds_of(profile)
    stated = state_rules(facts, profile)
    problem = make_problem(facts, stated.statements, profile.home_on(facts.nest), feeds)
    paths = RoutePaths(facts, profile, stated)
    return Bench(name, profile, facts, stated, problem, paths, make_grid(nest, profile.heat.grid_mm))


def correlation(case: Bench, cooler: CoolerOrders, count: int) -> str:
    """A row: rank correlation over random orders."""
    prices = cooler.prices()
    routes = [random_order(case.problem, seed) for seed in range(UNSEEN, UNSEEN + count)]
    found = np.array([case.overheats(case.candidates(route)) for route in routes])
    rho = spearmanr([prices.of(route) for route in routes], found).statistic
    return f"| {case.name} | {case.facts.n} | {found.min()} … {found.max()} | {found.mean():.1f} | {rho:.3f} |"


def strategies(case: Bench, cooler: CoolerOrders, work: float) -> Iterator[str]:
    """A row for every strategy."""
    heat, thickness_mm = case.profile.heat, case.profile.material.thickness_mm
    shortest = case.solve(work, case.stated).route
    least_mm, first = case.idle_mm(shortest), case.overheats(shortest)

    def row(name: str, *routes: Sequence[int]) -> str:
        """Means over routes; what they break in all."""
        overheats = float(np.mean([case.overheats(route) for route in routes]))
        idle_mm = float(np.mean([case.idle_mm(route) for route in routes]))
        fewer = 1 - overheats / first if first else 0.0
        shares = f"{fewer:.0%} | {idle_mm / least_mm:.2f} | {sum(map(case.broken, routes))}"
        return f"| {case.name} | {name} | {overheats:.0f} | {idle_mm / 1000:.3f} | {shares} |"

    yield row("shortest path", shortest)
    routes = [case.candidates(random_order(case.problem, seed)) for seed in RANDOM_SEEDS]
    yield row(f"random, mean of {len(routes)}", *routes)
    coolest = realtime_order(case.problem, case.facts, heat, thickness_mm, case.paths.burn)
    yield row("Realtime", case.candidates(coolest))
    asked, limits = Request(case.facts, case.stated), SolveOptions(work=work)
    for price_mm in PRICES_MM:
        profile = replace(case.profile, objective=replace(case.profile.objective, heat=price_mm))
        found, _ = solve_priced(
            asked, profile, limits, lambda share, stated: case.solve(work * share, stated), orders=cooler
        )
        yield row(f"ours, {price_mm:g} mm an overheat", found.route)


def main() -> None:
    """Print both tables."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--limit", type=float, default=90.0, help="°C above which a point is an overheat")
    arguments.add_argument("--orders", type=int, default=200, help="random orders that the correlation is over")
    arguments.add_argument("--work", type=float, default=5.0, help="deterministic limit of a solve")
    given = arguments.parse_args()
    profile = plant(given.limit)
    cases = [bench(name, nest, profile) for name, nest in nests()]
    coolers = [cooler_orders(case.facts, profile, case.stated) for case in cases]
    print(f"{given.orders} random lawful orders, prices fitted to {ORDERS} others, limit {given.limit:g} °C\n")
    print("| nest | contours | overheats | mean | rank correlation |\n|---|---:|---:|---:|---:|")
    for case, cooler in zip(cases, coolers, strict=True):
        cooler.start()
        print(correlation(case, cooler, given.orders), flush=True)
    print("\n| nest | strategy | overheats | idle travel, m | fewer overheats | idle travel, times | orders broken |")
    print("|---|---|---:|---:|---:|---:|---:|")
    for case, cooler in zip(cases, coolers, strict=True):
        for line in strategies(case, cooler, given.work):
            print(line, flush=True)


if __name__ == "__main__":
    main()
