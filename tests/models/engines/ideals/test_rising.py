"""Limits that rise, and proofs by them where no orders make the sets few: against every order, and against CP-SAT."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from functools import partial
from itertools import pairwise, permutations
from math import exp

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise.models.engines.bounds import complete
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.ideals.lattice import TooLarge
from kerfwise.models.engines.ideals.stretches import stretch_bounds
from kerfwise.models.engines.ideals.stretches.stretch_bounds import Arena, limits_within_work, rising_limits
from kerfwise.models.engines.solution import Incumbent, SolveOptions
from kerfwise.models.engines.tuning import STRETCH_DEARER as DEARER
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.routing import Instance, solve_instance
from kerfwise.tests.tools.amount import examples, few, share_of

WORK = (3e-5, 2e-4, 10.0)
"""Too little for most, enough for some, and plenty."""


def without_orders(n: int, sites: int, seed: int) -> Instance:
    """Any cost from anywhere to anywhere: bounds are far below such tours."""
    random, m = np.random.default_rng((n, sites, seed)), n * sites
    clusters = (*(tuple(range(i * sites, (i + 1) * sites)) for i in range(n)), (m,))
    orders = np.empty((0, 2), dtype=np.int64)
    return Instance("made", random.integers(0, 1001, (m + 1, m + 1)), clusters, orders, start=m, closed=True)


def least_of_every_order(instance: Instance) -> int:
    """The best tour's cost: every order of the clusters, each with the best vertex of every cluster."""
    cost, (home,) = instance.cost.tolist(), instance.clusters[-1]
    least = 1 << 60
    for order in permutations(instance.clusters[:-1]):
        row = {home: 0}
        for members in (*order, (home,)):
            row = {t: min(value + cost[s][t] for s, value in row.items()) for t in members}
        least = min(least, row[home])
    return least


@pytest.fixture
def nothing_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Walks that may come back to any contour, so that bounds of small problems are low, too."""
    forgetful = partial(complete, most_neighbours=0)
    module = importlib.import_module("kerfwise.models.engines.ideals.prove")
    monkeypatch.setattr(module.bounds, "complete", forgetful)


@pytest.mark.slow
@pytest.mark.usefixtures("nothing_remembered")
@pytest.mark.parametrize("sites", few([3, 1, 2]))
def test_without_orders_the_proof_is_the_best_of_every_order(sites: int) -> None:
    proven = left = 0
    seeds = range(share_of(360))
    for seed in seeds:
        instance = without_orders(6 - sites // 3, sites, seed)
        problem, least = instance.problem, least_of_every_order(instance)
        route = tuple(int(problem.first[c]) for c in range(problem.n))
        far = Incumbent(route, route_cost(problem, route))
        found = prove(problem, far, Deadline(WORK[seed % len(WORK)]))
        if found is None or found.incumbent is None:
            assert found is None or (found.least is not None and found.least <= least)
            left += 1
            continue
        assert found.incumbent.cost == least == route_cost(problem, found.incumbent.route)
        assert sorted(int(problem.site_contour[s]) for s in found.incumbent.route) == list(range(problem.n))
        proven += 1
    assert proven >= len(seeds) // 3
    assert left > 0


@pytest.mark.parametrize(("n", "sites"), [(9, 1), (8, 2), (7, 3)])
def test_without_orders_the_proof_is_what_cp_sat_proves(n: int, sites: int) -> None:
    instance = without_orders(n, sites, seed=7)
    ours = solve_instance(instance, SolveOptions(work=5.0, member="ideals"))
    theirs = solve_instance(instance, SolveOptions(work=60.0, member="cp-sat"))
    assert ours.proven
    assert theirs.proven
    assert ours.cost == theirs.cost


def limits(least: float, known: int, rate: float, work: float = 1e4) -> Iterator[tuple[int, float]]:
    """Limits, and what a sweep of each takes where that rises by `rate` a unit, up to what all states take."""
    spent: list[float] = []
    for limit in rising_limits(least, known, lambda: work - sum(spent)):
        assert limit is not None
        taken = min(work / 50, exp(min(700.0, rate * (limit - least))))
        yield limit, taken
        spent.append(taken)


@examples(300)
@example(200.0, 202, 1.0)
@given(st.floats(1.0, 1e9), st.integers(1, 1 << 40), st.floats(1e-9, 1.0))
def test_limits_rise_to_what_is_known(least: float, known: int, rate: float) -> None:
    found = [limit for limit, _ in limits(least, known, min(rate, 60.0 / known))]
    assert found[-1] == known
    assert all(a < b for a, b in pairwise(found))


def test_far_from_the_bound_no_sweep_takes_far_more_than_the_one_before() -> None:
    taken = [work for limit, work in limits(1000.0, 1600, rate=0.014) if limit >= 1100]
    assert len(taken) >= 3
    assert all(b <= 1.1 * DEARER * a for a, b in pairwise(taken))


def test_where_limits_drop_nothing_it_is_to_the_known_plan_at_once() -> None:
    assert [limit for limit, _ in limits(1000.0, 5000, rate=1.0, work=300.0)][-2] < 1200


def test_limits_that_rose_by_one_rise_faster_once_sweeps_hardly_grow() -> None:
    """From 322 to 347 each unit takes twelve times as much work, from there on a tenth more."""
    spent: list[float] = []
    found = []
    for limit in rising_limits(300.0, 420, lambda: 1e4 - sum(spent)):
        assert limit is not None
        found.append(limit)
        spent.append(1e3 * exp(2.5 * min(max(limit - 322, 0), 25) + 0.1 * max(limit - 347, 0)))
    steep = [limit for limit in found if 326 <= limit <= 347]
    assert steep == list(range(326, 348))
    assert found[found.index(347) + 1 :][:2] == [348, 362]


@pytest.mark.parametrize("work", [3.0, 30.0, 300.0])
def test_every_sweep_ends_where_what_they_take_rises_as_a_power(work: float) -> None:
    """And they go to the known plan where there is work enough for that."""
    least, known, left = 1_000_000.0, 1_020_000, [work]
    limits: list[int] = []
    whole = True
    try:
        for limit in limits_within_work(least, known, lambda: left[0]):
            left[0] -= exp((limit - least) / 4000) / 2
            assert left[0] > 0.0
            limits.append(limit)
    except TooLarge:
        whole = False
    assert all(one < other for one, other in pairwise(limits))
    assert whole == (work > exp(5) / 2)
    assert (limits[-1] == known) == whole


def test_tables_stay_as_they_were(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stretch_bounds, "PIECE", 50)
    rng = np.random.default_rng(1)
    tables = [rng.random((k % 4 + 1, 2, k % 5 + 1)) for k in range(30)] + [rng.random((9, 9))]
    kept = Arena()
    put = [kept.put(table) for table in tables]
    for table, copy in zip(tables, put, strict=True):
        assert copy.tolist() == table.tolist()
        assert copy.flags.c_contiguous
    assert len({id(copy.base) for copy in put}) < len(tables) / 2
