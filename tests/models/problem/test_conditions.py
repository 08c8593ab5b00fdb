"""Simplifying: by hand, and against every route tried one by one."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.problem.conditions import Condition, LoweredStatements, lower_statements
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify, sites_of
from kerfwise.rule_kit import AtLeast, Before, Enough, NoGood, Pick, Precede, Statement
from kerfwise.rules.statements import Link, Literal
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


COUNT = 7
NUMBER = st.integers(0, COUNT - 1)
POINT = st.tuples(st.sampled_from([0.0, -0.0, 0.1, 0.1 + 1e-17, 0.3]), st.just(1.5))


@given(problems(), st.integers(0, 12))
@examples(20)
def test_of_a_further_round_only_its_new_conditions_are_looked_at(drawn: Problem, known: int) -> None:
    simplify(replace(drawn, conditions=drawn.conditions[:known]))
    one, other = simplify(drawn), simplify(replace(drawn, before=drawn.before.copy()))
    assert one.conditions == other.conditions
    assert one.site_cost.tolist() == other.site_cost.tolist()
    simplify(replace(drawn, conditions=drawn.conditions[1:]))
    assert simplify(drawn).conditions == other.conditions


def candidates(places: list[tuple[int, Any, Any]]) -> list[Any]:
    ordered = sorted(places, key=lambda place: place[0])
    return [SimpleNamespace(contour=contour, pierce=pierce, end=end) for contour, pierce, end in ordered]


PLACES = st.lists(st.tuples(st.integers(0, 1), POINT, POINT), min_size=COUNT, max_size=COUNT).map(candidates)
CONDITIONS = st.lists(st.builds(lambda c, cost: Condition(0, (1,), (1,), 1, ABOUT, c, cost), NUMBER, st.integers(0, 1)))
LITERAL: st.SearchStrategy[Literal] = st.one_of(st.builds(Pick, NUMBER), st.just(Before(0, 1)))
WITHIN = st.builds(lambda literal: Enough((literal,), (1,), 1), LITERAL)
GENERAL = st.lists(
    st.builds(lambda x, when: AtLeast((x,), (1,), 1, ABOUT, when), LITERAL | WITHIN, st.none() | NUMBER), max_size=2
)
LINKS = st.lists(st.builds(lambda a, b: Link((a,), (b,), ((0, 0), (1, 0)), ABOUT, 1.0), NUMBER, NUMBER), max_size=2)


def picked(literal: Literal) -> set[int]:
    if isinstance(literal, Enough):
        return set().union(*map(picked, literal.literals))
    return {literal.c} if isinstance(literal, Pick) else set()


def one_by_one(
    some: list[Any], allowed: Any, costs: Any, conditions: list[Condition], general: list[AtLeast], links: list[Link]
) -> tuple[list[int], list[int]]:
    site, stands_for, keys = [-1] * len(some), list[int](), list[object]()
    for c, candidate in enumerate(some):
        if allowed[c]:
            key = (
                candidate.contour,
                candidate.pierce,
                candidate.end,
                costs[c],
                [(k.members, k.weights, k.bound, k.cost) for k in conditions if k.when == c],
                [k for k, s in enumerate(general) if s.when == c or c in set().union(*map(picked, s.literals))],
                [(k, c in link.leave, c in link.reach) for k, link in enumerate(links) if c in link.leave + link.reach],
            )
            if key not in keys:
                keys.append(key)
                stands_for.append(c)
            site[c] = keys.index(key)
    return site, stands_for


@given(
    PLACES,
    st.lists(st.booleans(), min_size=COUNT, max_size=COUNT),
    st.lists(st.sampled_from([0, 0, 0, 5]), min_size=COUNT, max_size=COUNT),
    CONDITIONS,
    GENERAL,
    LINKS,
)
def test_sites_are_those_told_apart_one_by_one(
    some: list[Any],
    allowed: list[bool],
    costs: list[int],
    conditions: list[Condition],
    general: list[AtLeast],
    links: list[Link],
) -> None:
    site, stands_for = sites_of(some, np.array(allowed), np.array(costs), conditions, general, links)
    assert (site.tolist(), stands_for.tolist()) == one_by_one(some, allowed, costs, conditions, general, links)


def test_of_no_candidates_there_are_no_sites() -> None:
    site, stands_for = sites_of([], np.zeros(0, dtype=np.bool_), np.zeros(0, dtype=np.int64), [], [])
    assert (len(site), len(stands_for)) == (0, 0)


CONTOUR_OF = (0, 0, 1, 2)
FIRST: tuple[Statement, ...] = (
    Precede(0, 1, ABOUT),
    Precede(1, 2, ABOUT, 3.0),
    AtLeast((Before(1, 0), Before(2, 0)), (1, 1), 1, ABOUT, when=0),
    AtLeast((Pick(0), Pick(2)), (1, 1), 1, ABOUT),
)
MORE: tuple[Statement, ...] = (
    NoGood(frozenset({0, 1}), frozenset({2}), ABOUT),
    Precede(0, 2, ABOUT),
    AtLeast((Pick(3),), (1,), 1, ABOUT, weight=2.0),
)


def assert_alike(one: LoweredStatements, other: LoweredStatements) -> None:
    for name in (field.name for field in fields(LoweredStatements)):
        a, b = getattr(one, name), getattr(other, name)
        assert np.array_equal(a, b) if name == "pairs" else a == b, name


def test_statements_come_to_pairs_conditions_and_the_rest() -> None:
    told = lower_statements(FIRST, CONTOUR_OF, LoweredStatements())
    assert told.pairs.tolist() == [[0, 1]]
    assert [(c.contour, c.members, c.bound, c.when) for c in told.conditions] == [(1, (2,), 0, None), (0, (1, 2), 1, 0)]
    assert told.general == FIRST[3:]


def test_a_further_round_comes_to_the_same_as_one_from_scratch() -> None:
    first = lower_statements(FIRST, CONTOUR_OF, LoweredStatements())
    further = lower_statements((*FIRST, *MORE), CONTOUR_OF, first)
    assert_alike(further, lower_statements((*FIRST, *MORE), CONTOUR_OF, LoweredStatements()))
    assert further.conditions[0] is first.conditions[0]
    assert len(further.conditions) == 4


@pytest.mark.parametrize("other", [MORE, FIRST[:2], (MORE[1], *FIRST[1:], *MORE), (*FIRST[::-1], *MORE)], ids=str)
def test_of_other_statements_nothing_is_taken_over(other: tuple[Statement, ...]) -> None:
    first = lower_statements(FIRST, CONTOUR_OF, LoweredStatements())
    assert_alike(lower_statements(other, CONTOUR_OF, first), lower_statements(other, CONTOUR_OF, LoweredStatements()))
