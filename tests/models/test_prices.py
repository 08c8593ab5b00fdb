"""Prices of heat: what is put into made-up overheats is found again, and statements cost what the prices say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.baselines import random_order
from kerfwise.models.heat_prices import HEAT, HeatPrices, HeatTerms, fit_prices, near_pairs, priced_statements
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rule_kit import AtLeast, Forbid, Precede, nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.tests.models.plate import PLATE, facts, plant, posed, stated

A, B, C = (PLATE.index[name] for name in ("A.outer", "B.outer", "C.outer"))


def terms() -> HeatTerms:
    return HeatTerms.of(facts(), posed(), plant().heat)


def routes(count: int, begin: int = 0) -> list[tuple[int, ...]]:
    return [random_order(posed(), seed) for seed in range(begin, begin + count)]


def hot(route: tuple[int, ...]) -> list[int]:
    """Near B: 40 points where C is out before it, 30 where it is entered at its second site and A is out by then, and
    25 where A and C are both out before it.
    """
    order = [int(posed().site_contour[s]) for s in route]
    site = posed().sites(B)[1]
    found = [0] * 4
    found[B] = 40 * (order.index(C) < order.index(B)) + 30 * (site in route and order.index(A) < order.index(B))
    found[B] += 25 * (order.index(B) > max(order.index(A), order.index(C)))
    return found


def test_terms_hold_as_they_say() -> None:
    of, (route,) = terms(), routes(1, 7)
    place = {int(posed().site_contour[s]): k for k, s in enumerate(route)}
    pairs, sites, entered, both = (part.astype(bool) for part in of.split(of.rows([route])[0]))
    assert pairs.tolist() == [place[i] < place[j] for i, j in of.pairs.tolist()]
    assert np.flatnonzero(sites).tolist() == sorted(route)
    for (site, out), holds in zip(of.entered.tolist(), entered.tolist(), strict=True):
        assert holds == (site in route and place[out] < place[int(posed().site_contour[site])])
    for (one, other, last), holds in zip(of.both.tolist(), both.tolist(), strict=True):
        assert holds == (place[one] < place[last] and place[other] < place[last])
    speaks = of.rows([route])[0, of.around[B]]
    assert 0 < len(speaks) < of.rows([route]).shape[1]


def test_what_orders_and_entries_cost_is_found_again() -> None:
    seen, asked = routes(240), routes(60, 1000)
    prices = fit_prices(terms(), seen, np.array([hot(route) for route in seen]), np.ones(len(seen)))
    told = np.array([prices.of(route) for route in asked])
    found = np.array([sum(hot(route)) for route in asked])
    assert found.std() > 15
    assert np.corrcoef(told, found)[0, 1] > 0.98


def test_a_route_that_counts_more_is_met_better() -> None:
    seen = routes(40)
    made = np.array([hot(route) for route in seen])
    made[0, B] += 500
    weights = np.ones(len(seen))
    shy = fit_prices(terms(), seen, made, weights)
    weights[0] = 100.0
    bold = fit_prices(terms(), seen, made, weights)

    def gap(prices: HeatPrices) -> float:
        return prices.of(seen[0]) - float(np.mean([prices.of(route) for route in seen[1:]]))

    assert gap(bold) > gap(shy)


def test_statements_cost_what_the_prices_say() -> None:
    of, price_mm = terms(), 7.0
    drawn = np.random.default_rng(3).normal(0, 20, of.rows(routes(1)).shape[1])
    prices = HeatPrices(of, np.where(np.abs(drawn) < 1, 1.0, drawn))
    priced = priced_statements(facts(), posed(), prices, price_mm)
    assert {type(s) for s in priced} == {Precede, Forbid, AtLeast}
    assert all(s.weight is not None and s.weight > 0 and s.about.rule == HEAT for s in priced)
    base, home = posed(), plant().machine.home
    dearer = make_problem(facts(), (*stated().statements, *priced), home)
    gaps = []
    for route in routes(30, 50):
        sites = dearer.candidate_site[base.site_candidate[list(route)]].tolist()
        more_mm = (route_cost(dearer, sites) - route_cost(base, route)) / UM_PER_MM
        gaps.append(more_mm - price_mm * prices.of(route))
    assert max(gaps) - min(gaps) == pytest.approx(0.0, abs=0.1)
    assert np.std([prices.of(route) for route in routes(30, 50)]) > 5


def test_sentences_name_what_is_asked() -> None:
    of = terms()
    overheats = np.zeros(of.rows(routes(1)).shape[1])
    overheats[of.pairs.tolist().index([B, C])] = -12.0
    overheats[-1] = 3.0
    one, other = priced_statements(facts(), posed(), HeatPrices(of, overheats), 10.0)
    assert one.about.sentence == "B.outer is cut before C.outer, or 12 more points overheat"
    assert one.weight == pytest.approx(120)
    names = [PLATE.contours[k].id for k in of.both[-1]]
    assert other.about.sentence == f"{names[2]} is cut before {names[0]} or {names[1]}, or 3 more points overheat"


def test_sentences_name_the_entry() -> None:
    of, (site, other) = terms(), list(posed().sites(B))[:2]
    overheats = np.zeros(of.rows(routes(1)).shape[1])
    k = of.entered.tolist().index([site, C])
    overheats[len(of.pairs) + other] = 4.0
    overheats[len(of.pairs) + len(of.site_contour) + k] = 5.0
    said = {s.about.sentence for s in priced_statements(facts(), posed(), HeatPrices(of, overheats), 10.0)}

    def at(s: int) -> str:
        candidate = facts().candidates[posed().site_candidate[s]]
        return f"at ({candidate.entry[0]:.1f}, {candidate.entry[1]:.1f}) {candidate.direction}"

    assert said == {
        f"B.outer is cut before C.outer where B.outer is entered {at(site)}, or 5 more points overheat",
        f"B.outer is entered elsewhere than {at(other)}, or 4 more points overheat",
    }


def test_where_nothing_is_hot_nothing_is_asked() -> None:
    seen = routes(20)
    prices = fit_prices(terms(), seen, np.zeros((20, 4)), np.ones(20))
    assert priced_statements(facts(), posed(), prices, 20.0) == ()


PLAIN_HEAT = Heat()
ROW = nest(900, 100, *(part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABCDE")))


def test_only_near_contours_are_pairs() -> None:
    first, second = near_pairs(ROW, PLAIN_HEAT)
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == [(0, 1), (1, 2), (2, 3), (3, 4)]
    marked = nest(
        200, 100, part("A", rect(10, 10, 80, 80), marks=[[(20, 20), (40, 20)]]), part("B", rect(100, 10, 80, 80))
    )
    first, second = near_pairs(marked, PLAIN_HEAT)
    assert [(marked.contours[i].id, marked.contours[j].id) for i, j in zip(first, second, strict=True)] == [
        ("A.outer", "B.outer")
    ]
    assert len(near_pairs(ROW, replace(PLAIN_HEAT, kerf_band_mm=2.0, grid_mm=3.0))[0]) == 0
