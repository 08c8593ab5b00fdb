"""Arcs and positions that CP-SAT's model has variables for."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.engines.cpsat.variables import (
    OutByThen,
    arc_of_move,
    distances,
    out_by_then,
    site_arcs,
    windows,
    windows_of_steps,
)
from kerfwise.models.engines.solution import count_site_arcs
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import lawful
from kerfwise.tests.models.problems import problem, problems
from kerfwise.tests.tools.amount import examples

LINE = [[(10.0, 0.0)], [(20.0, 0.0), (20.0, 5.0)], [(30.0, 0.0)]]
HOME = 4


def crossing(leave: int, reach: int, over: int, cost: int) -> Crossings:
    row = (np.array([number], dtype=np.int64) for number in (leave, reach, over, cost, 0))
    return Crossings(*row)


def legs(given: Problem) -> dict[tuple[int, int], int]:
    arcs = site_arcs(given, given.successors())
    return dict(zip(zip(arcs.tail.tolist(), arcs.head.tolist(), strict=True), arcs.cost.tolist(), strict=True))


def test_every_leg_of_a_chain_is_there_and_no_other() -> None:
    chain = problem(LINE, pairs=[(0, 1), (1, 2)])
    assert legs(chain) == {
        (HOME, 0): 10_000,
        (0, 1): 10_000,
        (0, 2): 11_180,
        (1, 3): 10_000,
        (2, 3): 11_180,
        (3, HOME): 30_000,
    }
    assert count_site_arcs(chain) == 6


def test_arcs_of_two_contours_lie_together() -> None:
    chain = problem(LINE, pairs=[(0, 1), (1, 2)])
    spans = list(site_arcs(chain, chain.successors()).spans())
    assert [(i, j, span.stop - span.start) for i, j, span in spans] == [(0, 1, 2), (1, 2, 2), (2, 3, 1), (3, 0, 1)]


@pytest.mark.parametrize(
    ("leave", "reach", "over", "out"),
    [
        (HOME, 1, 0, OutByThen.NO),  # nothing is out at the start
        (3, HOME, 0, OutByThen.YES),  # everything is at the end
        (0, 1, 0, OutByThen.YES),  # the contour just cut
        (0, 1, 1, OutByThen.NO),  # the contour cut next
        (1, 3, 0, OutByThen.YES),  # an earlier one by the orders
        (0, 3, 1, OutByThen.NO),  # a later one
        (0, 1, 2, OutByThen.OPEN),
    ],
)
def test_what_the_orders_say_of_a_crossing(leave: int, reach: int, over: int, out: OutByThen) -> None:
    given = problem(LINE, pairs=[(0, 1)], crossings=crossing(leave, reach, over, 1))
    assert out_by_then(given).tolist() == [out]


def test_what_is_crossed_in_any_order_is_in_the_cost() -> None:
    given = problem(LINE, pairs=[(0, 1)], crossings=crossing(1, 3, 0, 700))
    assert legs(given)[1, 3] == 10_700


def test_what_is_forbidden_in_any_order_is_no_arc() -> None:
    given = problem(LINE, pairs=[(0, 1)], crossings=crossing(1, 3, 0, FORBIDDEN))
    assert (1, 3) not in legs(given)
    assert len(legs(given)) == count_site_arcs(given) - 1


def test_a_step_whose_only_arc_is_forbidden_is_no_group() -> None:
    given = problem(LINE, pairs=[(0, 1)], crossings=crossing(3, HOME, 0, FORBIDDEN))
    arcs = site_arcs(given, given.successors())
    assert [2, 3] not in arcs.groups.tolist()
    assert arcs.first[-1] == len(arcs.cost)


def test_a_move_that_is_not_made_has_no_arc() -> None:
    tail, head = np.array([2, 0]), np.array([0, 1])
    assert arc_of_move(2, tail, head, np.array([0, 1, 2]), np.array([1, 0, 0])).tolist() == [1, -1, 0]


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
