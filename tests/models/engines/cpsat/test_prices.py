"""Prices on sites: bounds that hold, and that are worth it."""

from __future__ import annotations

import pytest
from hypothesis import given

from kerfwise.models.engines.cpsat.solve import NEVER, price_sites
from kerfwise.models.engines.cpsat.variables import site_arcs
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered
from kerfwise.tests.tools.amount import examples


def priced_bound(given: Problem, target_um: int | None = None) -> int:
    return price_sites(given, site_arcs(given, given.successors()), target_um).bound


def test_no_route_comes_to_one_end_and_leaves_from_the_other_for_nothing() -> None:
    """A slot of 100 mm with a site at each end: whoever comes to one must leave from it."""
    slot = problem([[(0.0, 0.0), (100.0, 0.0)]], home_mm=(50.0, 0.0), site_cost=[0, 10])
    assert priced_bound(slot) == 100_000
    two = problem([[(0.0, 0.0), (100.0, 0.0)], [(100.0, 1.0), (0.0, 1.0)]], pairs=[(0, 1)])
    best = cheapest(two)
    assert best is not None
    assert priced_bound(two, best.cost) == best.cost == 2_000


def test_prices_raise_the_bound_of_a_dozen_contours() -> None:
    dozen = scattered(5, 12, 8, pairs=20)
    proof = prove(dozen, None, Deadline(10))
    assert proof is not None
    assert proof.incumbent is not None
    arcs = site_arcs(dozen, dozen.successors())
    rounds = [price_sites(dozen, arcs, proof.incumbent.cost, rounds=k).bound for k in (1, 30, 200)]
    assert rounds[0] < rounds[1] <= rounds[2] <= proof.incumbent.cost
    assert rounds[2] > 1.05 * rounds[0]


def test_contours_that_no_step_joins_have_no_assignment() -> None:
    assert priced_bound(problem([[(1.0, 0.0)], [(2.0, 0.0)]], lags=[Lag(0, 1, ABOUT, cuts=1)])) >= NEVER


@pytest.mark.slow
@given(problems())
@examples(40)
def test_no_route_is_cheaper_than_the_bound(drawn: Problem) -> None:
    best = cheapest(drawn)
    if best is not None:
        assert priced_bound(drawn, best.cost) <= best.cost
        assert priced_bound(drawn) <= best.cost
