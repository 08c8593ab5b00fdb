"""Windows of positions, against every lawful order of tiny problems."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given

from kerfwise.models.engines.cpsat.variables import distances, windows, windows_of_steps
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import lawful
from kerfwise.tests.models.problems import problem, problems
from kerfwise.tests.tools.amount import examples

POINTS = [[(float(x), 0.0)] for x in range(5)]


def test_blocks_are_left_whole_and_entered_at_their_start() -> None:
    first, last = windows_of_steps(problem(POINTS, blocks=[(0, 1), (2, 3)]))
    assert (first[0, 2], last[0, 2]) == (1, 3)  # 1 before 0; after 2 still 3
    assert (first[0, 1], last[0, 1]) == (0, 4)


def test_what_must_lie_between_keeps_apart() -> None:
    apart = distances(problem(POINTS, pairs=[(0, 1), (0, 2), (1, 3), (2, 3)]))
    assert apart[0].tolist() == [0, 1, 1, 3, 0]


@pytest.mark.slow
@given(problems())
@examples(40)
def test_every_lawful_order_keeps_them(drawn: Problem) -> None:
    first, last = windows(drawn)
    first_if, last_if = windows_of_steps(drawn)
    apart = distances(drawn)
    for route in lawful(drawn):
        order = [int(drawn.site_contour[s]) for s in route]
        for k, i in enumerate(order):
            assert first[i] <= k <= last[i]
            assert all(order.index(j) - k >= apart[i, j] for j in range(drawn.n) if apart[i, j])
        assert all(order.index(i) >= first_if[i, j] and order.index(j) <= last_if[i, j] for i, j in pairwise(order))
