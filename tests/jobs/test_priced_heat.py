"""A price on overheats: what the solution says of itself is what simulation and the rules say."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.heat_control import solve_priced
from kerfwise.jobs.request import Request, options_for
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.engines.solution import Solution
from kerfwise.models.engines.solve import solve
from kerfwise.models.heat_prices import HEAT
from kerfwise.models.physics.heat import simulate
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.plate import PLATE, facts, plant, posed, stated

LIMITS = options_for(PLATE, plant(), work=2.0)


@pytest.fixture(autouse=True)
def _few(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("ORDERS", 24), ("NEARBY", 8)):
        monkeypatch.setattr(f"kerfwise.jobs.cooler_orders.{name}", value)


def priced(price_mm: float) -> Profile:
    return replace(plant(), objective=replace(plant().objective, heat=price_mm))


def test_objective_and_bound_are_those_of_rules_and_simulation() -> None:
    asked, parts = Request(facts(), stated()), list[float]()

    def solved(share: float, of: Stated) -> Solution:
        parts.append(share)
        return solve(facts(), of.statements, replace(LIMITS, work=LIMITS.work * share))

    solution, last = solve_priced(asked, priced(20.0), LIMITS, solved)
    assert sum(parts) == pytest.approx(1.0)
    sites = posed().candidate_site[list(solution.route)].tolist()
    assert not broken(posed(), sites)
    profile = plant()
    path = RoutePaths(facts(), profile, stated()).of(solution.route)
    overheats = simulate(PLATE, path, profile.heat, profile.material.thickness_mm).overheats
    assert solution.objective == pytest.approx(route_cost(posed(), sites) / UM_PER_MM + 20 * overheats)
    shortest = solve(facts(), stated().statements, LIMITS)
    assert shortest.status == "optimal"
    assert solution.bound == shortest.bound
    more = last.statements[len(stated().statements) :]
    assert more
    assert all(s.about.rule == HEAT for s in more)


def test_the_plan_keeps_the_rules_and_its_bound() -> None:
    made = solve_and_verify(Request(facts(), stated()), priced(20.0), LIMITS)
    assert made.verdict.ok
    assert made.plan.solve.found_by == "simulation"
    assert made.plan.solve.bound is not None
    assert made.plan.solve.bound <= made.plan.solve.objective


def test_where_the_torch_does_not_heat_nothing_is_simulated() -> None:
    cold = replace(priced(20.0), heat=replace(plant().heat, absorbed_power_w=0.0))
    assert solve_and_verify(Request(facts(), stated()), cold, LIMITS).plan.solve.found_by != "simulation"
