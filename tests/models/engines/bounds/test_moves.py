"""What moves cost at least: lags and crossings that no order avoids are in it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.engines.bounds.flow import FAR, contract_sites
from kerfwise.models.engines.bounds.move_costs import least_moves
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.problems import ABOUT, problem, problems

ROW = [[(10.0, 0.0)], [(20.0, 0.0)], [(30.0, 0.0)]]


def over(leave: int, reach: int, contour: int, cost: int) -> Crossings:
    rows = (np.array([number], dtype=np.int64) for number in (leave, reach, contour, cost, 0))
    return Crossings(*rows)


def test_following_at_once_costs_what_the_lag_does_both_ways() -> None:
    move = least_moves(problem(ROW, lags=[Lag(0, 1, ABOUT, cuts=2, weight=7.0)]))
    assert move[0, 1] == move[1, 0] == 10_000 + 2 * 7_000
    assert move[1, 2] == 10_000


def test_what_is_out_in_every_order_is_crossed() -> None:
    ordered = [(0, 2)]
    assert least_moves(problem(ROW, pairs=ordered, crossings=over(1, 2, 0, 500)))[1, 2] == 10_500
    assert least_moves(problem(ROW, pairs=ordered, crossings=over(2, 1, 0, 500)))[2, 1] == 10_500
    assert least_moves(problem(ROW, crossings=over(1, 2, 1, 500)))[1, 2] == 10_500
    assert least_moves(problem(ROW, crossings=over(1, 3, 0, 500)))[1, 3] == 20_500
    assert least_moves(problem(ROW, crossings=over(1, 2, 1, FORBIDDEN)))[1, 2] == np.inf


def test_what_may_still_be_in_is_not() -> None:
    for leave, reach in ((1, 2), (3, 2)):
        plain = least_moves(problem(ROW))[leave, reach]
        assert least_moves(problem(ROW, crossings=over(leave, reach, 0, 500)))[leave, reach] == plain
    assert least_moves(problem(ROW, crossings=over(1, 2, 2, 500)))[1, 2] == 10_000


@pytest.mark.slow
@given(problems())
def test_a_contour_stands_for_the_best_of_its_sites(given_problem: Problem) -> None:
    move = least_moves(given_problem)
    move[:, : given_problem.m] += given_problem.site_cost
    owner = np.append(given_problem.site_contour, given_problem.n)
    apart = np.array(
        [
            [move[np.ix_(owner == i, owner == j)].min() for j in range(given_problem.n + 1)]
            for i in range(given_problem.n + 1)
        ]
    )
    assert np.array_equal(np.minimum(least_moves(contract_sites(given_problem)), FAR), np.minimum(apart, FAR))
