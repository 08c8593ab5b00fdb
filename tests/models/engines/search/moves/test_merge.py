"""What two routes share is taken for granted: lawful, at the same price but for the stretches, sites kept."""

import numpy as np
import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.search.moves.tour_merging import mergeable
from kerfwise.models.engines.search.region_problem import Contractor, Region
from kerfwise.models.engines.search.state.route_state import make_tables
from kerfwise.models.engines.search.walker import Elite, Pool
from kerfwise.models.engines.tuning import SIZE
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.problems import ABOUT, problem, scattered


def merge(problem: Problem, route: np.ndarray, other: np.ndarray) -> Region:
    return Contractor(problem, make_tables(problem)).merged(route, other)


def test_what_follows_each_other_in_both_is_one_contour() -> None:
    line = problem([[(10, 0)], [(20, 0)], [(30, 0)], [(40, 0)]], pairs=[(1, 3)])
    merged = merge(line, np.array([0, 1, 2, 3]), np.array([2, 0, 1, 3]))
    assert merged.problem.n == 3
    assert merged.problem.before.tolist() == [[False, False, True], [False] * 3, [False] * 3]
    assert merged.route.tolist() == [0, 1, 2]
    assert merged.whole(np.array([1, 0, 2])).tolist() == [2, 0, 1, 3]


def test_one_contour_alone_keeps_its_sites_and_what_they_cost() -> None:
    two = problem([[(10, 0), (11, 0)], [(20, 0)], [(30, 0)]], site_cost=[1, 2, 3, 4])
    merged = merge(two, np.array([0, 2, 3]), np.array([2, 3, 1]))
    assert np.diff(merged.problem.first).tolist() == [2, 1]
    assert merged.problem.site_cost.tolist() == [1, 2, 0]
    assert merged.whole(np.array([2, 1])).tolist() == [2, 3, 1]


def test_the_same_contours_by_other_sites_are_not_shared() -> None:
    two = problem([[(10, 0), (11, 0)], [(20, 0)]])
    assert merge(two, np.array([0, 2]), np.array([1, 2])).problem.n == 2


@pytest.mark.parametrize("seed", range(4))
def test_smaller_routes_are_whole_ones_less_their_stretches(seed: int) -> None:
    plate = scattered(seed, contours=40, sites=3, pairs=30)
    routes = [_found(plate, number) for number in (1, 2)]
    merged = merge(plate, *routes)
    left_out = route_cost(plate, routes[0].tolist()) - route_cost(merged.problem, merged.route.tolist())
    searcher = Searcher(merged.problem, seed)
    searcher.run(Deadline(0.005))
    assert searcher.best is not None
    whole = merged.whole(np.array(searcher.best.route)).tolist()
    assert broken(plate, whole) == ()
    assert route_cost(plate, whole) == searcher.best.cost + left_out


def test_only_orders_may_say_who_stands_where() -> None:
    assert mergeable(scattered(1, contours=5, sites=2, pairs=3))
    assert not mergeable(scattered(1, contours=6, sites=2, blocks=[range(3)]))
    assert not mergeable(problem([[(1, 0)], [(2, 0)]], lags=[Lag(0, 1, ABOUT, cuts=2)]))


def test_a_pool_holds_different_routes_the_cheapest_first() -> None:
    pool = Pool(1)
    for cost in (*range(20, 0, -1), 1):
        pool.add(Elite(cost, np.array([cost])))
    assert [member.cost for member in pool.members] == list(range(1, SIZE + 1))


def test_a_child_takes_the_place_of_its_elder_unless_worse_or_there_already() -> None:
    pool = Pool(1)
    first, second = Elite(5, np.array([0, 1])), Elite(7, np.array([1, 0]))
    pool.add(first)
    pool.add(second)
    pool.succeed(second, Elite(8, np.array([2, 0])))
    pool.succeed(second, Elite(5, np.array([0, 1])))
    assert [member.cost for member in pool.members] == [5, 7]
    pool.succeed(second, Elite(4, np.array([2, 1])))
    assert [member.cost for member in pool.members] == [4, 5]


def _found(plate: Problem, seed: int) -> np.ndarray:
    searcher = Searcher(plate, seed)
    searcher.run(Deadline(0.002))
    assert searcher.best is not None
    return np.array(searcher.best.route)
