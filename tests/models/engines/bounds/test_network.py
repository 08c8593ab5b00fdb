"""What flows go over: no plan costs more there, and what sites ask is so in every plan that uses them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.engines.bounds.network import Multipliers, block_inequalities, kinds, left_of, network_of
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rule_kit import About
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import problem, problems
from kerfwise.tests.tools.amount import examples

ABOUT = About("held", (), "")
PLACES = [[(10.0, 0.0)], [(20.0, 0.0)], [(30.0, 0.0), (30.0, 10.0)]]


@pytest.mark.slow
@examples(100)
@given(problems(contours=5))
def test_every_plan_goes_over_it_and_costs_no_more(tiny: Problem) -> None:
    for route in list(lawful(tiny))[:20]:
        network = network_of(tiny, route, 10**15, 3000)
        split = network.problem
        stops = np.array([split.m, *network.plan, split.m])
        kept = network.contours.tolist()
        contours = tiny.site_contour[list(route)].tolist()
        assert network.contours[split.site_contour[list(network.plan)]].tolist() == [i for i in contours if i in kept]
        assert network.cost[stops[:-1], stops[1:]].sum() <= route_cost(tiny, route)
        out = np.zeros(split.n, dtype=np.bool_)
        for site in network.plan:
            assert not (network.sooner[site] & ~out).any()
            assert not (network.later[site] & out).any()
            out[split.site_contour[site]] = True


def test_a_site_that_wants_a_contour_in_is_no_way_on_from_it() -> None:
    held = Condition(2, (0,), (-1,), 0, ABOUT, when=2)
    seen = problem(PLACES, conditions=[held])
    network = network_of(seen, (0, 1, 3), 10**9, 3000)
    assert network.later[2].tolist() == [True, False, False]
    assert np.isinf(network.cost[0, 2])
    assert np.isfinite(network.cost[0, 3])
    assert np.isinf(network.cost[2, 4])  # nor the last


def test_nothing_follows_at_once_where_something_is_between() -> None:
    """Site 2 wants contour 0 in, and contour 1 comes after contour 0."""
    held = Condition(2, (0,), (-1,), 0, ABOUT, when=2)
    network = network_of(problem(PLACES, pairs=[(0, 1)], conditions=[held]), (0, 1, 3), 10**9, 3000)
    assert np.isinf(network.cost[2, 1])
    assert np.isfinite(network.cost[3, 4])


def test_a_condition_can_be_paid_for_by_a_site_of_its_own() -> None:
    paid = Condition(2, (0,), (-1,), 0, ABOUT, when=2, cost=700)
    seen = problem(PLACES, conditions=[paid])
    network = network_of(seen, (0, 1, 2), 10**9, 3000)
    assert network.problem.site_contour.tolist() == [0, 1, 2, 2, 2]
    assert network.problem.site_cost.tolist() == [0, 0, 0, 700, 0]
    assert network.plan == (0, 1, 3)
    assert network_of(seen, (2, 1, 0), 10**9, 3000).plan == (2, 1, 0)


def test_what_costs_more_than_the_plan_is_not_paid_for() -> None:
    dear = Condition(2, (0,), (-1,), 0, ABOUT, when=2, cost=10**9)
    best = cheapest(problem(PLACES, conditions=[dear]))
    assert best is not None
    assert network_of(problem(PLACES, conditions=[dear]), best.route, best.cost, 3000).problem.m == 4


def test_sites_are_not_split_where_there_are_many() -> None:
    paid = Condition(2, (0,), (-1,), 0, ABOUT, when=2, cost=700)
    network = network_of(problem(PLACES, conditions=[paid]), (0, 1, 2), 10**9, 4)
    assert network.problem.m == 4
    assert network.problem.conditions == (paid,)


@pytest.mark.parametrize("seed", range(4))
def test_every_plan_costs_the_bound_and_what_is_left_of_its_moves(seed: int) -> None:
    random = np.random.default_rng(seed)
    places = random.integers(0, 100, (5, 2, 2)).astype(float).tolist()
    tiny = problem([[(x, y) for x, y in sites] for sites in places], pairs=[(0, 2)], blocks=[(1, 3, 4)])
    for route in list(lawful(tiny))[:30]:
        network = network_of(tiny, route, 10**15, 3000)
        split, cuts = network.problem, block_inequalities(network.problem)
        price, paid = random.normal(0, 1e5, split.m + 1), random.random(len(cuts)) * 1e5
        bound, least, left = left_of(network, Multipliers(price, paid, cuts))
        stops = np.array([split.m, *network.plan, split.m])
        owner = np.append(split.site_contour, split.n)
        above = (left[stops[:-1], stops[1:]] - least[owner[stops[1:]]]).sum()
        assert above >= -1e-6
        assert bound + above <= route_cost(tiny, route) + 1e-3


def test_sites_that_lie_on_the_same_sides_are_of_one_kind() -> None:
    sides = np.random.default_rng(1).random((11, 9)) < 0.5
    sides[:, [3, 7]] = sides[:, [0]]
    first, kind = kinds(sides)
    assert (sides[:, first][:, kind] == sides).all()
    assert kind[0] == kind[3] == kind[7]
    assert len(first) == len({tuple(column) for column in sides.T.tolist()})
    first, kind = kinds(sides[:0])
    assert (len(first), kind.tolist()) == (1, [0] * 9)
