"""What moves cost at least, between sites and along passages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, permutations, product

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.engines.bounds.flow import FAR, contract_sites, flow_bound
from kerfwise.models.engines.bounds.move_costs import (
    Moves,
    contract_condition,
    least_moves,
    passage_costs,
    passages_of,
    size_without_inner,
)
from kerfwise.models.engines.bounds.network import network_of
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rule_kit import About, Lag
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import ABOUT, problem, problems
from kerfwise.tests.tools.amount import few

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


STATED = About("held", (), "")


def blocks(
    seed: int, sizes: Sequence[int], pairs: Sequence[tuple[int, int]] = (), held: Sequence[Condition] = ()
) -> Problem:
    """Blocks of so many contours, the last of each after the others, of two sites each; moves cost what they will."""
    ends = np.cumsum(sizes).tolist()
    of_block = [list(range(end - size, end)) for end, size in zip(ends, sizes, strict=True)]
    inside = [(i, members[-1]) for members in of_block for i in members[:-1]]
    places = [[(float(i), 0.0), (float(i), 1.0)] for i in range(ends[-1])]
    made = problem(places, pairs=[*inside, *pairs], blocks=of_block, conditions=held, site_cost=[0, 7] * ends[-1])
    matrix = np.random.default_rng(seed).integers(10, 1000, (made.m + 1, made.m + 1))
    return replace(made, matrix=matrix)


@pytest.mark.parametrize("seed", few(range(4), 2))
def test_the_cheapest_way_through_a_block(seed: int) -> None:
    seen = blocks(seed, [4, 1])
    (passage,) = passages_of(seen)
    assert (passage.last, passage.inner.tolist()) == (3, [0, 1, 2])
    found = passage_costs(seen, passage, Moves(seen), np.array([6, 7]), np.array([100.0, 200.0]))
    assert seen.matrix is not None
    for k, began in enumerate(range(6)):
        for end in (6, 7):
            others = [i for i in range(3) if i != began // 2]
            cost = [
                sum(int(seen.matrix[a, b]) for a, b in pairwise(way)) + sum(int(seen.site_cost[s]) for s in way[:-1])
                for order in permutations(others)
                for sites in product((0, 1), repeat=2)
                for way in [(began, *(2 * i + s for i, s in zip(order, sites, strict=True)), end)]
            ]
            assert found[k, end - 6] == min(cost) + (100, 200)[end - 6]


@pytest.mark.slow
@pytest.mark.parametrize("seed", few(range(6)))
def test_no_plan_is_cheaper_for_it_and_the_best_costs_the_same(seed: int) -> None:
    """The best way over the last contours, by trying all, costs what the best plan of the whole problem does."""
    seen = blocks(seed, [2, 1, 3], pairs=[(2, 4)] if seed % 2 else [])
    best = cheapest(seen)
    assert best is not None
    network = network_of(seen, best.route, 10**15, 3000)
    assert network.contours.tolist() == [1, 2, 5]
    m, split = network.problem.m, network.problem
    cost = [
        sum(network.cost[a, b] for a, b in zip((m, *way), (*way, m), strict=True))
        for order in permutations(range(3))
        for way in product(*(split.sites(i) for i in order))
    ]
    assert min(cost) == best.cost
    for route in lawful(seen):
        over = network_of(seen, route, 10**15, 3000).plan
        assert sum(network.cost[a, b] for a, b in zip((m, *over), (*over, m), strict=True)) <= route_cost(seen, route)


@pytest.mark.parametrize("seed", few(range(6), 3))
def test_a_bound_over_last_contours_holds_and_knows_conditions_on_blocks(seed: int) -> None:
    """The first contour of another block is what a site asks to be still in, at a price: its last one stands for it.

    Of seed 3 the bound is that without the conditions: nothing is branched on.
    """
    held = Condition(2, (0, 3), (-1, -1), -1, STATED, when=4, cost=300)
    seen = blocks(seed, [2, 1, 2], held=[held, Condition(2, (0,), (-1,), 0, STATED, when=5, cost=200)])
    best, free = cheapest(seen), cheapest(blocks(seed, [2, 1, 2]))
    assert best is not None
    assert free is not None
    bound = flow_bound(seen, replace(best, cost=best.cost + 10**6), Deadline(2.0)).bound
    assert free.cost <= bound <= best.cost
    if seed != 3:
        assert bound > 0.9 * best.cost
        assert flow_bound(seen, best, Deadline(2.0)).bound == best.cost
    if seed == 2:
        assert bound > free.cost  # the others have a best plan that costs no condition


def test_what_is_asked_of_an_inner_contour_keeps_its_block_whole() -> None:
    asked = Condition(0, (2,), (-1,), 0, STATED, when=0, cost=300)
    assert passages_of(blocks(1, [2, 1])) != ()
    assert passages_of(blocks(1, [2, 1], held=[asked])) == ()
    assert size_without_inner(blocks(1, [3, 1])) == (2, 4)
    assert size_without_inner(blocks(1, [3, 1], held=[asked])) == (4, 8)
    assert passages_of(problem([[(0.0, 0.0)], [(1.0, 0.0)]], blocks=[(0, 1)])) == ()  # neither is the last


def test_a_condition_on_inner_contours_says_the_same_of_the_last() -> None:
    """In every order that keeps blocks together it is met or not as before."""
    last_of = np.array([1, 1, 3, 3, 4])  # blocks 0 1, 2 3, and 4
    condition = Condition(3, (0, 1, 2, 4), (1, 2, 5, -4), 3, STATED)
    same = contract_condition(condition, last_of)
    assert set(same.members) == {1, 4}
    for order in permutations([(0, 1), (2, 3), (4,)]):
        cuts = [i for block in order for i in block]
        out = set(cuts[: cuts.index(3)])
        assert condition.met(out) == same.met(out)
