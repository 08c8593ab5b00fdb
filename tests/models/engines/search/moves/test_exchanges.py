"""Problems of orders and arcs alone, which exchanges search by the million: lawful, priced right, the cheapest."""

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.search.state.travel import make_arcs, make_legs
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import ABOUT, scattered, with_lags


def _tabled(seed: int, contours: int, pairs: int, even: bool) -> Problem:
    """One site a contour and a random table of costs, the same both ways if `even`."""
    table = np.random.default_rng(seed).integers(0, 1000, (contours + 1, contours + 1))
    return replace(scattered(seed, contours, 1, pairs), matrix=np.minimum(table, table.T) if even else table)


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_tiny_problems_are_solved_to_the_optimum(seed: int, even: bool) -> None:
    tiny = _tabled(seed, contours=7, pairs=seed, even=even)
    searcher = Searcher(tiny, seed)
    searcher.run(Deadline(0.02))
    expected = cheapest(tiny)
    assert expected is not None
    assert searcher.best is not None
    assert searcher.best.cost == expected.cost


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize("pairs", [0, 30, 400])
def test_answers_are_lawful_and_cost_what_they_say(pairs: int, even: bool) -> None:
    wide = _tabled(pairs, contours=60, pairs=pairs, even=even)
    searcher = Searcher(wide)
    searcher.run(Deadline(0.1))
    assert searcher.best is not None
    assert broken(wide, searcher.best.route) == ()
    assert searcher.best.cost == route_cost(wide, searcher.best.route)


def test_what_a_site_costs_is_paid() -> None:
    dear = replace(_tabled(3, contours=6, pairs=2, even=True), site_cost=np.arange(6) * 100)
    searcher = Searcher(dear)
    searcher.run(Deadline(0.01))
    expected = cheapest(dear)
    assert searcher.best is not None
    assert expected is not None
    assert searcher.best.cost == expected.cost


@pytest.mark.slow
def test_a_way_round_a_circle_is_found() -> None:
    around = np.full((81, 81), 1000)
    around[np.arange(81), (np.arange(81) * 1 + 1) % 81] = 1
    mixed = np.append(np.random.default_rng(1).permutation(80), 80)
    searcher = Searcher(replace(_tabled(1, 80, 0, False), matrix=around[np.ix_(mixed, mixed)]))
    searcher.run(Deadline(0.3))
    assert searcher.best is not None
    assert searcher.best.cost == 81


def test_only_orders_and_arcs_are_plain() -> None:
    plate = scattered(1, contours=10, sites=1, pairs=5)
    assert make_arcs(plate, make_legs(plate)).plain == 1
    others = (
        scattered(1, contours=10, sites=2),
        scattered(1, contours=10, sites=1, blocks=[range(3)]),
        with_lags(plate, [Lag(0, 1, ABOUT, cuts=1)]),
        replace(plate, matrix=np.full((11, 11), 1 << 40)),
    )
    assert [make_arcs(other, make_legs(other)).plain for other in others] == [0, 0, 0, 0]


def test_whether_arcs_cost_the_same_both_ways() -> None:
    for even in (False, True):
        made = _tabled(1, contours=30, pairs=0, even=even)
        assert make_arcs(made, make_legs(made)).even == even
