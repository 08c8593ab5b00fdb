"""Branching proves what a flow alone leaves open, and loses no plan."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.engines.bounds import flow_bound
from kerfwise.models.engines.bounds.flow import branch_cases
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import scattered
from kerfwise.tests.tools.amount import examples


@pytest.mark.slow
@examples(30)
@given(st.integers(0, 2**31 - 1), st.integers(0, 4))
def test_orders_and_entries_are_proven_exactly_whatever_plan_is_known(seed: int, pairs: int) -> None:
    tiny = scattered(seed, contours=5, sites=2, pairs=pairs)
    best = cheapest(tiny)
    assert best is not None
    assert flow_bound(tiny, best, Deadline(20.0)).bound == best.cost
    for route in list(lawful(tiny))[:2]:
        assert flow_bound(tiny, Incumbent(route, route_cost(tiny, route)), Deadline(20.0)).bound <= best.cost


@pytest.mark.slow
def test_25_contours_of_4_entries_without_any_order_are_proven() -> None:
    given_ = scattered(1, contours=25, sites=4)
    searcher = Searcher(given_)
    searcher.run(Deadline(0.5))
    best = searcher.best
    assert best is not None
    assert flow_bound(given_, best, Deadline(20.0)).bound == best.cost
    assert flow_bound(given_, Incumbent(best.route, best.cost + 1000), Deadline(20.0)).bound <= best.cost


@pytest.mark.parametrize("seed", range(5))
def test_every_plan_is_in_one_of_two_cases(seed: int) -> None:
    """Flows over contours 0 (sites 0, 1), 1 (sites 2, 3) and home, open in one place."""
    random = np.random.default_rng(seed)
    owner = np.array([0, 0, 1, 1, 2])
    used = np.eye(3)
    i, j = random.integers(0, 3, 2)
    used[i, j] = 0.5
    cases = branch_cases(np.ones((5, 5), dtype=np.bool_), used, np.ones(5), owner)
    by_sites = branch_cases(np.ones((5, 5), dtype=np.bool_), np.eye(3), np.array([0.5, 0.5, 1.0, 0.0, 1.0]), owner)
    for a in (0, 1):
        for b in (2, 3):
            for route in ([4, a, b, 4], [4, b, a, 4]):
                assert sum(case[route[:-1], route[1:]].all() for case in cases) == 1
                assert sum(case[route[:-1], route[1:]].all() for case in by_sites) == 1


def test_nothing_is_split_where_all_is_whole() -> None:
    assert branch_cases(np.ones((3, 3), dtype=np.bool_), np.eye(3), np.ones(3), np.arange(3)) == []
