"""Prices of pairs: what is put into made-up overheats is found again, and becomes soft orders."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from kerfwise.models.conditions import of_soft_precede
from kerfwise.models.heat.pair_prices import fit_pair_prices, near_pairs
from kerfwise.rules.heat_section import Heat
from kerfwise.tests.nests import nest, part, rect

HEAT = Heat()
ROW = nest(900, 100, *(part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABCDE")))


def orders(count: int, seed: int) -> list[list[int]]:
    chance = random.Random(seed)
    return [chance.sample(range(5), 5) for _ in range(count)]


def hot(order: list[int]) -> int:
    """Forty points overheat where B is cut before A, ten where C is cut before D, fifty in any order."""
    at = order.index
    return 50 + 40 * (at(1) < at(0)) + 10 * (at(2) < at(3))


def test_only_near_contours_are_pairs() -> None:
    first, second = near_pairs(ROW, HEAT)
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == [(0, 1), (1, 2), (2, 3), (3, 4)]
    marked = nest(
        200, 100, part("A", rect(10, 10, 80, 80), marks=[[(20, 20), (40, 20)]]), part("B", rect(100, 10, 80, 80))
    )
    first, second = near_pairs(marked, HEAT)
    assert [(marked.contours[i].id, marked.contours[j].id) for i, j in zip(first, second, strict=True)] == [
        ("A.outer", "B.outer")
    ]
    assert len(near_pairs(ROW, replace(HEAT, kerf_band_mm=2.0, grid_mm=3.0))[0]) == 0


def test_what_orders_cost_is_found_again() -> None:
    seen = orders(80, 1)
    prices = fit_pair_prices(ROW, HEAT, seen, lambda k: hot(seen[k]))
    assert prices.overheats.tolist() == pytest.approx([-40, 0, 10, 0], abs=3)
    told = [prices.of(order) for order in orders(40, 2)]
    found = [hot(order) for order in orders(40, 2)]
    shift = told[0] - found[0]
    assert [t - shift for t in told] == pytest.approx(found, abs=4)


def test_prices_become_soft_orders() -> None:
    seen = orders(80, 1)
    stated = fit_pair_prices(ROW, HEAT, seen, lambda k: hot(seen[k])).statements(ROW, 20.0)
    dear = [s for s in stated if s.weight is not None and s.weight > 100]
    assert [(s.before, s.after) for s in dear] == [(0, 1), (3, 2)]
    assert dear[0].weight == pytest.approx(800, rel=0.08)
    assert dear[0].about.rule == "objective.heat"
    assert dear[0].about.contours == ("A.outer", "B.outer")
    assert "A.outer is cut before B.outer" in dear[0].about.sentence
    condition = of_soft_precede(dear[0], 800_000)
    assert condition.met(set())
    assert not condition.met({1})


def test_where_nothing_is_hot_nothing_is_asked() -> None:
    seen = orders(40, 1)
    assert fit_pair_prices(ROW, HEAT, seen, lambda k: 0).statements(ROW, 20.0) == ()
