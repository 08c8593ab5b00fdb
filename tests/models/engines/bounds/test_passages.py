"""Last contours that stand for their blocks: what is left out of a program is worked out as brute force does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, permutations, product

import numpy as np
import pytest

from kerfwise.models.engines.bounds.flow import flow_bound
from kerfwise.models.engines.bounds.move_costs import (
    Moves,
    contract_condition,
    passage_costs,
    passages_of,
    size_without_inner,
)
from kerfwise.models.engines.bounds.network import network_of
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import problem
from kerfwise.tests.tools.amount import few

ABOUT = About("held", (), "")


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
    held = Condition(2, (0, 3), (-1, -1), -1, ABOUT, when=4, cost=300)
    seen = blocks(seed, [2, 1, 2], held=[held, Condition(2, (0,), (-1,), 0, ABOUT, when=5, cost=200)])
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
    asked = Condition(0, (2,), (-1,), 0, ABOUT, when=0, cost=300)
    assert passages_of(blocks(1, [2, 1])) != ()
    assert passages_of(blocks(1, [2, 1], held=[asked])) == ()
    assert size_without_inner(blocks(1, [3, 1])) == (2, 4)
    assert size_without_inner(blocks(1, [3, 1], held=[asked])) == (4, 8)
    assert passages_of(problem([[(0.0, 0.0)], [(1.0, 0.0)]], blocks=[(0, 1)])) == ()  # neither is the last


def test_a_condition_on_inner_contours_says_the_same_of_the_last() -> None:
    """In every order that keeps blocks together it is met or not as before."""
    last_of = np.array([1, 1, 3, 3, 4])  # blocks 0 1, 2 3, and 4
    condition = Condition(3, (0, 1, 2, 4), (1, 2, 5, -4), 3, ABOUT)
    same = contract_condition(condition, last_of)
    assert set(same.members) == {1, 4}
    for order in permutations([(0, 1), (2, 3), (4,)]):
        cuts = [i for block in order for i in block]
        out = set(cuts[: cuts.index(3)])
        assert condition.met(out) == same.met(out)
