"""The loop of planning and simulating: what it takes is the best of what it saw, and lawful."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from kerfwise.encoder.errors import RulesConflict
from kerfwise.jobs.cooler_orders import CoolerOrders
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.evaluate import broken
from kerfwise.rules.statements import Statement
from kerfwise.tests.models.plate import PLATE, facts, plant, posed, stated


@pytest.fixture(autouse=True)
def _few(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("ORDERS", 24), ("NEARBY", 8), ("ROUNDS", 2)):
        monkeypatch.setattr(f"kerfwise.jobs.cooler_orders.{name}", value)


def paths() -> RoutePaths:
    return RoutePaths(facts(), plant(), stated())


def cooler() -> CoolerOrders:
    profile = plant()
    return CoolerOrders(facts(), posed(), profile.heat, profile.material.thickness_mm, paths())


def planned(k: int, further: tuple[Statement, ...]) -> Sequence[int]:
    assert bool(further) == (k > 0)
    options = SolveOptions(work=1.0, home_mm=plant().machine.home, feeds=feeds_of(plant()))
    return solve(facts(), (*stated().statements, *further), options).route


def overheats(route: Sequence[int]) -> int:
    return simulate(PLATE, paths().of(route), plant().heat, plant().material.thickness_mm).overheats


@pytest.mark.slow
def test_the_best_is_lawful_told_right_and_no_worse_than_the_plan_without_prices() -> None:
    price_mm, first = 20.0, planned(0, ())
    found = cooler().find(price_mm, planned)
    assert not broken(posed(), posed().candidate_site[list(found.route)].tolist())
    assert found.shown == overheats(found.route)
    dearest = cooler().find(price_mm, lambda k, further: first, judge=lambda route: 0.0 if route == first else None)
    assert dearest.route == first
    assert found.shown < dearest.shown
    again = cooler().find(price_mm, planned)
    assert (again.route, again.cost_mm) == (found.route, found.cost_mm)


def test_what_was_simulated_for_a_low_price_helps_a_high_one() -> None:
    shared = cooler()
    low, high = shared.find(5.0, planned), shared.find(500.0, planned)
    assert high.shown <= low.shown
    assert high.cost_mm + 500 * high.shown <= low.cost_mm + 500 * low.shown


def test_without_time_the_plan_without_prices_is_there() -> None:
    rounds: list[int] = []

    def planner(k: int, further: tuple[Statement, ...]) -> Sequence[int]:
        rounds.append(k)
        return planned(k, further)

    cooler().find(20.0, planner, going=lambda: False)
    assert rounds == [0]


def test_a_round_without_a_plan_is_the_last() -> None:
    def planner(k: int, further: tuple[Statement, ...]) -> Sequence[int]:
        if k:
            raise RulesConflict("no time left")
        return planned(k, further)

    assert cooler().find(20.0, planner).shown >= 0
