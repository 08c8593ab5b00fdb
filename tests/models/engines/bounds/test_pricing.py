"""What multipliers prove over all moves: it holds whatever they are."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.models.engines.bounds.network import Multipliers, block_inequalities, kinds, left_of, network_of
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.tests.models.brute import lawful
from kerfwise.tests.models.problems import problem


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
