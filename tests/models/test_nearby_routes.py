"""Routes near a route: lawful, not all the same, and entered as cheaply as their order allows."""

from __future__ import annotations

import random
from itertools import product

import numpy as np
import pytest

from kerfwise.jobs.cooler_orders import _cheapest, nearby
from kerfwise.models.engines.baselines import random_order
from kerfwise.models.heat_prices import HeatPrices, HeatTerms
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.tests.models.plate import PLATE, facts, plant, posed
from kerfwise.tests.models.problems import problem


def test_they_are_lawful_and_differ() -> None:
    of = HeatTerms.of(facts(), posed(), plant().heat)
    rows = of.rows([])
    prices = HeatPrices(of, np.zeros(rows.shape[1]))
    chance = random.Random(1)
    route = random_order(posed(), 5)
    found = [nearby(posed(), route, prices, 10.0, chance) for _ in range(30)]
    assert all(one is not None and not broken(posed(), one) for one in found)
    assert len(set(found)) > 10
    orders = {tuple(posed().site_contour[list(one)].tolist()) for one in found if one is not None}
    assert len(orders) > 2


def test_entries_are_the_cheapest_of_an_order() -> None:
    points = [[(0.0, 9.0), (5.0, 5.0)], [(7.0, 1.0), (9.0, 9.0)], [(3.0, 2.0), (1.0, 8.0), (6.0, 6.0)]]
    posed_by_hand = problem(points, site_cost=[0, 900, 400, 0, 2500, 0, 100])
    layers = [list(posed_by_hand.sites(k)) for k in (1, 0, 2)]
    found = _cheapest(posed_by_hand, layers, posed_by_hand.site_cost.astype(float))
    best = min(route_cost(posed_by_hand, route) for route in product(*layers))
    assert route_cost(posed_by_hand, found) == best


def test_entries_know_what_is_out_by_then(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.jobs.cooler_orders.MOST_MOVES", 0)
    monkeypatch.setattr("kerfwise.jobs.cooler_orders.MOST_PULLED", 0)
    of = HeatTerms.of(facts(), posed(), plant().heat)
    a, b = (PLATE.index[name] for name in ("A.outer", "B.outer"))
    sites = list(posed().sites(b))
    routes = [random_order(posed(), seed) for seed in range(50)]
    orders = [posed().site_contour[list(route)].tolist() for route in routes]
    after = next(r for r, order in zip(routes, orders, strict=True) if order.index(a) < order.index(b))
    before = next(r for r, order in zip(routes, orders, strict=True) if order.index(b) < order.index(a))
    for cool in sites:
        overheats = np.zeros(of.rows([]).shape[1])
        entered = of.split(overheats)[2]  # views: what is written here is a price
        for k, (site, out) in enumerate(of.entered.tolist()):
            if site in sites and site != cool and out == a:
                entered[k] = 1000.0
        prices = HeatPrices(of, overheats)
        found = nearby(posed(), after, prices, 100.0, random.Random(1))
        assert found is not None
        assert cool in found
        free = HeatPrices(of, 0 * overheats)
        both = [nearby(posed(), before, told, 100.0, random.Random(1)) for told in (prices, free)]
        assert both[0] == both[1]
