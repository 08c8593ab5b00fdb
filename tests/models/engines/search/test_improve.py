"""Regions of a route with all rules on: what comes back is lawful, no dearer, and the same each time."""

from __future__ import annotations

from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pytest

from kerfwise.arrays import Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher, searcher
from kerfwise.models.engines.search.moves.tour_merging import merge_tours
from kerfwise.models.engines.search.searcher import Contractor, Regions, Stage, regional
from kerfwise.models.engines.search.state.route_state import make_tables
from kerfwise.models.engines.search.walker import Elite
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.problems import ABOUT, scattered, with_lags

CONTOURS = 60
BLOCKS = [range(i, i + 3) for i in range(0, 24, 3)]


@pytest.fixture(autouse=True)
def small_ones_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searcher, "LEAST_CONTOURS", 30)
    few, more = Stage(4.0, 12, 20_000, 2.0), Stage(inf, 24, 20_000, 4.0)
    monkeypatch.setattr(searcher, "STAGES", (few, more))


def plate(seed: int) -> Problem:
    """Contours with orders, blocks, conditions of contours and of sites, and lags."""
    bare = scattered(seed, CONTOURS, sites=3, pairs=40, blocks=BLOCKS)
    random = np.random.default_rng(seed)
    conditions = []
    for _ in range(40):
        contour, member = random.choice(CONTOURS, 2, replace=False).tolist()
        when = int(bare.first[contour] + random.integers(3)) if random.random() < 0.5 else None
        weight = int(random.choice([-1, 1]))
        conditions.append(Condition(contour, (member,), (weight,), (weight + 1) // 2, ABOUT, when, 20_000))
    near = [Lag(c, c + 1, ABOUT, cuts=1, weight=30.0) for c in range(0, CONTOURS - 1, 4)]
    return with_lags(replace(bare, conditions=tuple(conditions)), near)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_route_becomes_cheaper_and_stays_lawful(seed: int) -> None:
    problem = plate(seed)
    assert regional(problem)
    search = Searcher(problem, seed)
    search.run(Deadline(0.001))
    assert search.best is not None
    route, fields = np.array(search.best.route), make_tables(problem)
    ways = []
    with ThreadPoolExecutor(2) as threads:
        for _ in range(2):
            regions, now, costs = Regions(problem, fields, seed), route, [search.best.cost]
            for _ in range(4):
                now, work = regions.step(threads, now, 8_000_000)
                assert work >= 8_000_000
                assert broken(problem, now.tolist()) == ()
                costs.append(route_cost(problem, now.tolist()))
            assert costs == sorted(costs, reverse=True)
            assert costs[-1] < costs[0]
            ways.append(now.tolist())
    assert ways[0] == ways[1]


def test_routes_from_nothing_are_merged_into_the_best(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("REGIONS", 1_000_000), ("FIRST_ROUTE", 6_000), ("LATER_ROUTES", 3_000), ("EACH", 20_000)):
        monkeypatch.setattr(searcher, name, value)
    problem, merge, merged, found = plate(1), searcher.merge_tours, list[Elite](), []

    def noted(*given: Any) -> tuple[Elite, int]:
        child, work = merge(*given)
        merged.append(child)
        return child, work

    monkeypatch.setattr(searcher, "merge_tours", noted)
    for _ in range(2):
        search = Searcher(problem, 1)
        search.run(Deadline(0.02))
        assert search.best is not None
        found.append(search.best)
    assert found[0] == found[1]
    assert len(merged) >= 2
    assert found[0].cost <= min(child.cost for child in merged)


def test_a_child_of_two_routes_keeps_blocks_and_conditions() -> None:
    problem = plate(1)
    fields, gained = make_tables(problem), []
    searches = [Searcher(problem, seed, fields=fields) for seed in (1, 2, 3)]
    for search in searches:
        search.run(Deadline(0.0005))
    parents = sorted((one for search in searches if (one := search._elite())), key=lambda one: one.cost)
    for other in parents[1:]:
        child, _ = merge_tours(
            problem, Contractor(problem, fields), searches[0]._walkers[0], (parents[0], other), (1, 9), 2_000_000
        )
        assert broken(problem, child.route.tolist()) == ()
        assert child.cost == route_cost(problem, child.route.tolist())
        gained.append(parents[0].cost - child.cost)
    assert min(gained) >= 0
    assert max(gained) > 0


@pytest.mark.slow
def test_the_search_goes_by_regions_where_it_can(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searcher, "REGIONS", 4_000_000)
    step, begun = Regions.step, []

    def noted(
        regions: Regions, threads: Executor, route: Ints, operations: int, most: int, ends_s: float
    ) -> tuple[Ints, int]:
        begun.append(route_cost(problem, route.tolist()))
        return step(regions, threads, route, operations, most, ends_s)

    monkeypatch.setattr(Regions, "step", noted)
    problem, found = plate(3), []
    for _ in range(2):
        search = Searcher(problem, 1)
        for _ in range(2):
            search.run(Deadline(0.1))
        assert search.best is not None
        assert broken(problem, search.best.route) == ()
        found.append(search.best)
    assert found[0] == found[1]
    assert found[0].cost == route_cost(problem, found[0].route)
    assert len(begun) > 4
    assert min(begun) >= found[0].cost


def test_where_no_region_fits_all_that_was_asked_for_is_annealed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = 2_000_000
    monkeypatch.setattr(searcher, "REGIONS", asked + 1)
    problem, ways = plate(7), []
    for _ in range(2):
        search, costs, before = Searcher(problem, 1), [], 0
        for _ in range(3):
            search.run(Deadline(asked / searcher.WORK_PER_S))
            done = min(walker.work for walker in search._walkers)
            assert done - before >= 0.9 * asked
            before = done
            assert search.best is not None
            costs.append(search.best.cost)
        assert costs == sorted(costs, reverse=True)
        ways.append((costs, search.best))
    assert ways[0] == ways[1]


def test_a_longer_search_by_regions_goes_the_way_of_a_shorter_one() -> None:
    problem = plate(4)
    search = Searcher(problem, 1)
    search.run(Deadline(0.001))
    assert search.best is not None
    start, fields, ways = np.array(search.best.route), make_tables(problem), []
    with ThreadPoolExecutor(2) as threads:
        for steps in (6, 12):
            regions, now, costs = Regions(problem, fields, 1), start, []
            for _ in range(steps):
                now, _ = regions.step(threads, now, 2_000_000, 10**12)
                costs.append(route_cost(problem, now.tolist()))
            ways.append(costs)
    assert ways[1][:6] == ways[0]
    assert ways[1][-1] <= ways[0][-1]


def test_no_region_takes_much_more_than_what_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("SETTING_UP", "PER_SITE", "PER_MOVE"):
        monkeypatch.setattr(searcher, name, 0)
    problem = plate(5)
    search = Searcher(problem, 1)
    search.run(Deadline(0.001))
    assert search.best is not None
    fields, route = make_tables(problem), np.array(search.best.route)
    with ThreadPoolExecutor(2) as threads:
        _, whole = Regions(problem, fields, 1).step(threads, route, 1)
        _, part = Regions(problem, fields, 1).step(threads, route, 1, 24_000)
    assert part <= 0.06 * whole


def test_a_region_is_left_when_the_time_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searcher, "STAGES", (Stage(inf, 12, 10**15, 2.0),))
    monkeypatch.setattr(searcher, "CHUNK", 100_000)
    problem = plate(6)
    search = Searcher(problem, 1)
    search.run(Deadline(0.001))
    assert search.best is not None
    seconds = iter(range(10**6))
    monkeypatch.setattr(searcher, "running_s", lambda: float(next(seconds)))
    with ThreadPoolExecutor(2) as threads:
        route, _ = Regions(problem, make_tables(problem), 1).step(
            threads, np.array(search.best.route), 10**18, ends_s=20.0
        )
    assert broken(problem, route.tolist()) == ()
    assert next(seconds) < 40


def test_what_counts_further_is_not_taken_apart() -> None:
    assert not regional(replace(plate(1), lags=(Lag(0, 1, ABOUT, cuts=2),)))
    assert not regional(replace(plate(1), lags=(Lag(0, 1, ABOUT, seconds=1.0),)))
    assert not regional(scattered(1, contours=20, sites=2))
