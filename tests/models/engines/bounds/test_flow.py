"""The bound by flows: never above the optimum, and as high as orders and blocks make it by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kerfwise.models.engines.bounds import flow, flow_bound
from kerfwise.models.engines.bounds.inequalities import block_inequalities
from kerfwise.models.engines.bounds.separation import Flow, broken_inequalities
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import problem, problems, scattered

ROW = [[(10.0, 0.0)], [(20.0, 0.0)], [(30.0, 0.0)]]


def best_of(tiny: Problem) -> Incumbent:
    best = cheapest(tiny)
    assert best is not None
    return best


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(problems(contours=5))
def test_no_plan_costs_less(tiny: Problem) -> None:
    best = cheapest(tiny)
    if best is not None:
        dear = replace(best, cost=best.cost + 10**9)  # nothing but the bound itself keeps it below
        assert flow_bound(tiny, dear, 1.0).bound <= best.cost


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(problems(contours=5), st.integers(0, 2**32 - 1))
def test_no_plan_costs_less_where_moves_cost_what_they_will(tiny: Problem, seed: int) -> None:
    matrix = np.random.default_rng(seed).integers(0, 100_000, (tiny.m + 1, tiny.m + 1))
    drawn = replace(tiny, matrix=matrix)
    best = cheapest(drawn)
    if best is not None:
        assert flow_bound(drawn, replace(best, cost=best.cost + 10**9), 1.0).bound <= best.cost


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(problems(contours=5), st.integers(0, 2**32 - 1))
def test_cuts_hold_for_every_plan(tiny: Problem, seed: int) -> None:
    leave, reach = (ends.ravel() for ends in np.indices((tiny.m + 1, tiny.m + 1)))
    amount = np.random.default_rng(seed).random(len(leave)) / tiny.m
    for cuts in (block_inequalities(tiny), broken_inequalities(tiny, Flow(leave, reach, amount))[0]):
        for route in list(lawful(tiny))[:20]:
            stops = np.array([tiny.m, *route, tiny.m])
            made = cuts.across(stops[:-1], stops[1:]).sum(axis=1)
            assert (np.asarray(made).ravel() >= cuts.sure).all()


@pytest.mark.slow
def test_large_problems_by_contours(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = scattered(4, 6, 2)
    best = best_of(seen)
    by_sites = flow_bound(seen, best, 5.0).bound
    monkeypatch.setattr(flow, "MOST_SITES", 3)
    assert 0 < flow_bound(seen, best, 5.0).bound <= by_sites <= best.cost


def test_an_order_that_leads_back_and_forth_is_proven() -> None:
    crossed = problem([*ROW, [(40.0, 0.0)]], pairs=[(3, 0), (0, 2), (2, 1)])
    best = best_of(crossed)
    assert flow_bound(crossed, best, 5.0).bound == best.cost == 40_000 + 30_000 + 20_000 + 10_000 + 20_000


def test_two_clusters_are_not_two_cycles() -> None:
    far = problem([[(1.0, 0.0)], [(500.0, 0.0)], [(501.0, 0.0)], [(502.0, 0.0)]])
    best = best_of(far)
    assert flow_bound(far, best, 5.0).bound == best.cost == 2 * 502_000


@pytest.mark.parametrize("seed", range(10))
def test_a_contour_is_left_from_where_it_was_come_to(seed: int) -> None:
    places = np.random.default_rng(seed).integers(0, 100, (5, 2, 2)).tolist()
    far = problem([[(float(x), float(y)) for x, y in sites] for sites in places])
    best = best_of(far)
    assert flow_bound(far, best, 5.0).bound == best.cost


def test_a_block_is_entered_once() -> None:
    mixed = problem([[(0.0, 100.0)], [(0.0, 200.0)], [(50.0, 100.0)]], blocks=[(0, 1)])
    best = best_of(mixed)
    assert flow_bound(mixed, best, 5.0).bound == best.cost


def test_nothing_is_said_of_nothing() -> None:
    assert flow_bound(problem([]), Incumbent((), 0), 1.0).bound == 0
