"""Chains of exchanges: lawful at every step, priced as counted anew, never worse, the same each time."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.search.moves.lin_kernighan import stretches
from kerfwise.models.engines.search.moves.lin_kernighan_tables import detour_share, nearest_lawful, reduced_costs
from kerfwise.models.engines.search.moves.tour_merging import ChainedWalker, chained
from kerfwise.models.engines.search.state.route_state import COST, make_tables
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import scattered


def _tabled(seed: int, contours: int, pairs: int, most: int = 1000) -> Problem:
    """One site a contour and a random table of costs."""
    table = np.random.default_rng(seed).integers(0, most, (contours + 1, contours + 1))
    return replace(scattered(seed, contours, 1, pairs), matrix=table)


def _walker(problem: Problem, seed: int = 1) -> ChainedWalker:
    walker = ChainedWalker(make_tables(problem), (seed, 0))
    walker.start()
    walker.measure(1)
    return walker


@pytest.mark.parametrize("pairs", [0, 30, 200])
def test_after_every_kick_the_route_is_lawful_and_costs_what_is_counted(pairs: int) -> None:
    problem = _tabled(pairs, contours=70, pairs=pairs)
    walker = _walker(problem)
    for _ in range(200):
        walker.go(1, 500.0, 500.0)
        route = walker.stands_on().tolist()
        arrays = walker.arrays
        assert broken(problem, route) == ()
        assert arrays.number[COST] == route_cost(problem, route)
        assert arrays.line.tolist() == arrays.stood.tolist() == [70, *route, 70]
        assert arrays.place[route].tolist() == list(range(1, 71))
        assert walker.best is not None
        assert walker.best.cost == route_cost(problem, walker.best.route.tolist())


def test_without_heat_no_route_is_worse_than_the_one_before() -> None:
    problem = _tabled(5, contours=70, pairs=50)
    walker = _walker(problem)
    costs = []
    for _ in range(100):
        walker.descend(2000)
        costs.append(route_cost(problem, walker.stands_on().tolist()))
    assert all(later <= sooner for sooner, later in pairwise(costs))
    assert costs[-1] < costs[0]


@pytest.mark.parametrize("seed", range(8))
def test_tiny_problems_are_solved_to_the_optimum(seed: int) -> None:
    tiny = _tabled(seed, contours=7, pairs=seed)
    walker = _walker(tiny, seed)
    walker.cool(2_000_000)
    expected = cheapest(tiny)
    assert expected is not None
    assert walker.cost == expected.cost


def test_what_it_stands_on_is_never_lost() -> None:
    problem = _tabled(2, contours=80, pairs=60)
    first = _walker(problem)
    first.cool(3_000_000)
    assert first.best is not None
    second = _walker(problem, seed=2)
    second.stand_on(first.best.route)
    second.go(1_000_000, 1e6, 1e6)
    assert second.cost is not None
    assert second.cost <= first.best.cost
    second.take()
    assert second.cost <= first.best.cost


def test_equal_seeds_walk_equal_ways() -> None:
    problem = _tabled(3, contours=80, pairs=60)
    routes = []
    for seed in (1, 1, 2):
        walker = _walker(problem, seed)
        walker.cool(1_000_000)
        assert walker.best is not None
        routes.append(walker.best.route.tolist())
    assert routes[0] == routes[1] != routes[2]


@pytest.mark.parametrize("most", [3, 1000, 1 << 28])
def test_reduced_costs_are_never_below_zero_and_tell_tours_apart_as_costs_do(most: int) -> None:
    random = np.random.default_rng(most)
    cost, lawful = random.integers(0, most, (30, 30)), random.random((30, 30)) < 0.8
    np.fill_diagonal(lawful, False)
    around = np.arange(30)
    lawful[around, (around + 1) % 30] = True
    reduced = reduced_costs(cost, lawful)
    assert (reduced[lawful] >= 0).all()
    apart = set()
    for _ in range(5):
        tour = random.permutation(30)
        arcs = tour, np.roll(tour, -1)
        apart.add(int(cost[arcs].sum() - reduced[arcs].sum()))
    assert len(apart) == 1


def test_swapped_stretches_make_the_arcs_that_were_asked_for() -> None:
    line = list(range(12))
    seen = 0
    for p, q, c in np.ndindex(11, 12, 12):
        i, j, k = stretches.py_func(p, q, c)  # type: ignore[attr-defined]
        if i == 0:
            continue
        seen += 1
        swapped = [*line[:i], *line[j:k], *line[i:j], *line[k:]]
        made = set(pairwise(swapped)) - set(pairwise(line))
        assert sorted(swapped) == line
        assert made == {(p, q), (q - 1, c), (c - 1, p + 1)}
    assert seen == 495  # a swap for each of the three arcs of any three: 3 × 11 over 3


def test_the_first_route_keeps_orders() -> None:
    problem = _tabled(4, contours=70, pairs=300)
    route = nearest_lawful(_walker(problem).tables).tolist()
    assert broken(problem, route) == ()


def test_chains_are_for_sparse_orders_and_costs_that_are_no_distances() -> None:
    table = _tabled(1, contours=70, pairs=40)
    assert chained(make_tables(table))
    plate = scattered(1, contours=70, sites=1, pairs=40)
    assert detour_share(make_tables(plate)) < 0.02 < 0.1 < detour_share(make_tables(table))
    others = (
        plate,
        _tabled(1, contours=40, pairs=20),
        _tabled(1, contours=70, pairs=2000),
        scattered(1, contours=70, sites=2, pairs=40),
    )
    assert not any(chained(make_tables(other)) for other in others)


def test_a_search_by_chains_is_lawful_and_beats_its_first_route() -> None:
    problem = _tabled(9, contours=90, pairs=80)
    searcher = Searcher(problem)
    searcher.run(Deadline(0.2))
    assert searcher.best is not None
    assert broken(problem, searcher.best.route) == ()
    first = route_cost(problem, nearest_lawful(_walker(problem).tables).tolist())
    assert searcher.best.cost < first / 2
