"""A plan laid out from its end keeps all deadlines that can be kept, and is lawful whenever there is one."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest

from kerfwise.models.engines.first_plan import impossible, route_from_its_end, wants_early
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.problems import ABOUT, problem


def with_deadlines(seed: int, n: int) -> Problem:
    """Contours in a row with orders, and sums of lengths that must not be out before some of them."""
    random = np.random.default_rng(seed)
    lengths = random.integers(1, 20, n).tolist()
    pairs = {tuple(sorted(random.choice(n, 2, replace=False).tolist())) for _ in range(n // 2)}
    asked = []
    for contour in random.choice(n, n // 2, replace=False).tolist():
        others = [k for k in range(n) if k != contour]
        most = int(random.integers(0, sum(lengths)))
        asked.append(Condition(contour, tuple(others), tuple(-lengths[k] for k in others), -most, ABOUT))
    points = [[(float(x), float(y))] for x, y in random.integers(0, 100, (n, 2))]
    return problem(points, pairs=sorted((int(a), int(b)) for a, b in pairs), conditions=asked)


@pytest.mark.parametrize("seed", range(30))
def test_there_is_a_plan_from_the_end_where_there_is_one_at_all(seed: int) -> None:
    drawn = with_deadlines(seed, 6)
    found = route_from_its_end(drawn)
    lawful = any(not broken(drawn, order) for order in permutations(range(6)))
    assert (found is not None) == lawful
    if found is not None:
        assert not broken(drawn, found)


def test_a_route_that_breaks_a_lag_is_one_to_go_on_from() -> None:
    """There was none, and the search began from nothing."""
    drawn = with_deadlines(1, 6)
    found = route_from_its_end(drawn)
    assert found is not None
    near = replace(drawn, lags=(Lag(found[0], found[1], ABOUT, cuts=2),))
    assert route_from_its_end(near) == found
    assert broken(near, found)


def test_it_is_tried_where_long_sums_want_contours_early() -> None:
    assert wants_early(with_deadlines(1, 30))
    assert not wants_early(with_deadlines(1, 8))


def with_sums(seed: int) -> Problem:
    """Five contours, some with two ways to cut them, and sums of either sign, of some ways alone."""
    random = np.random.default_rng(seed)
    points = [[(float(x), float(y)) for x, y in random.integers(0, 9, (k, 2))] for k in random.integers(1, 3, 5)]
    first = np.cumsum([0, *(len(of) for of in points)])
    asked = []
    for contour in random.integers(0, 5, 5).tolist():
        others = tuple(k for k in range(5) if k != contour)
        weights = tuple(random.integers(-3, 4, 4).tolist())
        when = int(random.integers(first[contour], first[contour + 1])) if random.random() < 0.5 else None
        asked.append(Condition(contour, others, weights, int(random.integers(-3, 5)), ABOUT, when))
    return problem(points, pairs=[(0, 1)] if random.random() < 0.5 else [], conditions=asked)


def lawful(drawn: Problem) -> bool:
    return any(
        not broken(drawn, route)
        for order in permutations(range(drawn.n))
        for route in product(*(drawn.sites(contour) for contour in order))
    )


def test_what_is_shown_to_be_impossible_has_no_plan_and_much_of_that_is_shown() -> None:
    drawn = [with_sums(seed) for seed in range(30)]
    without = [one for one in drawn if not lawful(one)]
    shown = [one for one in drawn if impossible(one)]
    assert all(one in without for one in shown)
    assert len(without) > len(shown) > len(without) / 3
    assert all(set(impossible(one)) <= set(one.conditions) for one in shown)


@pytest.mark.parametrize("seed", range(30))
def test_deadlines_that_cannot_be_kept_are_shown_to_be_such(seed: int) -> None:
    drawn = with_deadlines(seed, 6)
    assert bool(impossible(drawn)) == (route_from_its_end(drawn) is None)


def test_the_portfolio_says_that_no_plan_keeps_a_sum() -> None:
    drawn = next(one for one in (with_deadlines(seed, 30) for seed in range(50)) if impossible(one))
    known = run_portfolio(drawn, SolveOptions(work=0.1))
    assert known.infeasible
    assert known.incumbent is None
    assert known.against
