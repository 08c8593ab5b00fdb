"""Simplifying: by hand, and against every route tried one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.statements import AtLeast, Pick
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import ABOUT, problem, problems
from kerfwise.tests.tools.amount import examples

TWICE = [[(10.0, 0.0), (10.0, 0.0)], [(20.0, 0.0)], [(30.0, 0.0)]]


def unless_out(site: int, other: int, cost: int | None) -> Condition:
    """Contour 0 is cut by this site only while the other contour is in."""
    return Condition(0, (other,), (-1,), 0, ABOUT, site, cost)


def test_what_the_orders_decide_becomes_a_cost_and_the_dearer_site_goes() -> None:
    simple = simplify(problem(TWICE, pairs=[(1, 0)], conditions=[unless_out(0, 1, 5000)]))
    assert simple.conditions == ()
    assert simple.site_candidate.tolist() == [1, 2, 3]


def test_a_site_that_is_never_lawful_goes() -> None:
    simple = simplify(problem(TWICE, pairs=[(1, 0)], conditions=[unless_out(1, 1, None)]))
    assert simple.site_candidate.tolist() == [0, 2, 3]
    assert simple.conditions == ()


def test_a_contour_without_any_lawful_site_stays_impossible() -> None:
    given = problem(TWICE, pairs=[(1, 0)], conditions=[unless_out(0, 1, None), unless_out(1, 1, None)])
    assert simplify(given).m == 4
    assert cheapest(simplify(given)) is None


def test_a_condition_that_is_always_met_goes() -> None:
    simple = simplify(problem(TWICE, pairs=[(0, 1)], conditions=[unless_out(0, 1, None)]))
    assert simple.conditions == ()


def test_members_that_the_orders_decide_leave_a_condition() -> None:
    """Contour 1 comes before 0, so that its weight counts, 2 behind; what says nothing of others goes as well."""
    stops = [[(10.0 * k, 0.0)] for k in range(1, 7)]
    asked = Condition(0, (0, 1, 2, 3, 4, 5), (7, 2, 4, 1, -3, 0), 3, ABOUT)
    decided = Condition(0, (3, 4), (1, -3), 1, ABOUT)
    others = [Condition(3, (4, 5), (1, 1), 1, ABOUT), Condition(4, (), (), 0, ABOUT), Condition(5, (), (), 1, ABOUT)]
    simple = simplify(problem(stops, pairs=[(1, 0), (0, 2)], conditions=[asked, *others]))
    assert simple.conditions == (decided, others[0], others[2])


def test_what_no_order_decides_stays() -> None:
    given = problem(TWICE, conditions=[unless_out(0, 1, 5000), unless_out(1, 2, 5000)])
    assert simplify(given).conditions == given.conditions
    assert simplify(given).m == 4


def test_of_two_sites_the_one_with_a_condition_more_goes() -> None:
    given = problem(TWICE, conditions=[unless_out(0, 1, 5000), unless_out(0, 2, None), unless_out(1, 1, 5000)])
    assert simplify(given).site_candidate.tolist() == [1, 2, 3]


def test_a_site_that_costs_more_but_is_asked_less_stays() -> None:
    given = problem(TWICE, conditions=[unless_out(0, 1, 5000)], site_cost=[0, 4000, 0, 0])
    assert simplify(given).m == 4
    dearer = replace(given, site_cost=np.array([0, 5000, 0, 0]))
    assert simplify(dearer).site_candidate.tolist() == [0, 2, 3]


def test_a_site_that_a_general_statement_names_stays() -> None:
    named = AtLeast((Pick(1),), (1,), 1, ABOUT)
    assert simplify(problem(TWICE, general=[named])).m == 4


def gathered(drawn: Problem) -> Problem:
    """The problem with all sites of a contour at the same place, as for two ways round."""
    at = drawn.first[drawn.site_contour]
    return replace(drawn, pierce_um=drawn.pierce_um[at], end_um=drawn.end_um[at])


@pytest.mark.slow
@given(problems())
@examples(60)
def test_the_optimum_stays_and_routes_cost_the_same(drawn: Problem) -> None:
    drawn = gathered(drawn)
    simple = simplify(drawn)
    best, same = cheapest(drawn), cheapest(simple)
    assert (best is None) == (same is None)
    if best is not None and same is not None:
        route = [int(simple.site_candidate[s]) for s in same.route]  # sites and candidates are the same in `drawn`
        assert same.cost == best.cost == route_cost(drawn, route)
        assert not broken(drawn, route)
