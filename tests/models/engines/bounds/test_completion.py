"""Bounds by walks against brute force: never above what any lawful plan costs, from any state on."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.engines.bounds import Completion, TooMuch, complete, completion
from kerfwise.models.engines.bounds.flow import contract_sites
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import problems, scattered
from kerfwise.tests.tools.amount import examples


def to_go(bound: Completion, tiny: Problem, route: tuple[int, ...], k: int) -> float:
    """What the plan still costs at least after the first k sites of a route."""
    left = {int(tiny.site_contour[s]) for s in route[k:]}
    near = bound.near[tiny.site_contour[route[k - 1]]]
    free = sum(1 << j for j, c in enumerate(near.tolist()) if c in left)
    return float(bound.to_go[k, free, route[k - 1]]) + sum(float(bound.price[c]) for c in left)


def spent(tiny: Problem, route: tuple[int, ...], k: int) -> int:
    """Travel and sites alone: what a plan costs at least up to its k-th cut."""
    sites = list(route[:k])
    return int(tiny.legs([tiny.m, *sites[:-1]], sites).sum() + tiny.site_cost[sites].sum())


@pytest.mark.slow
@examples(60)
@given(problems(contours=5), st.integers(0, 3))
def test_no_plan_costs_less_from_any_state_on(tiny: Problem, neighbours: int) -> None:
    best = cheapest(tiny)
    if best is None:
        return
    bound = complete(tiny, best.cost, Deadline(0.0001), most_neighbours=neighbours)
    assert bound.root <= best.cost
    for number, route in enumerate(lawful(tiny)):
        if number == 50:
            break
        total = spent(tiny, route, tiny.n) + int(tiny.legs([route[-1]], [tiny.m])[0])
        assert total <= route_cost(tiny, route)
        for k in range(1, tiny.n + 1):
            assert spent(tiny, route, k) + to_go(bound, tiny, route, k) <= route_cost(tiny, route)


@pytest.mark.slow
@examples(40)
@given(problems(contours=4))
def test_contours_for_all_their_sites_cost_no_more(tiny: Problem) -> None:
    best = cheapest(tiny)
    if best is not None:
        assert complete(contract_sites(tiny), best.cost, Deadline(0.0001)).root <= best.cost


def test_a_walk_that_remembers_all_is_a_plan() -> None:
    tiny = scattered(3, 5, 2)
    best = cheapest(tiny)
    assert best is not None
    assert np.ceil(complete(tiny, best.cost, Deadline(0.5)).root) == best.cost


def test_remembering_more_bounds_better() -> None:
    seen = scattered(2, 10, 3)
    roots = [complete(seen, None, Deadline(0.1), most_neighbours=g).root for g in (0, 3, 7)]
    assert roots == sorted(roots)
    assert np.isfinite(roots).all()
    assert roots[0] < roots[2]


def test_a_round_that_takes_too_much_is_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor are its tables made: those of a large nest take longer than the limit."""
    monkeypatch.setattr(completion, "ng_sets", lambda *_: pytest.fail("tables were made"))
    with pytest.raises(TooMuch):
        complete(scattered(2, 40, 4), None, Deadline(0.0), most=1e-6)
