"""Merged tours: the same each time, never worse than what they come from, from wherever they begin."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.search.anneal import AnnealingWalker
from kerfwise.models.engines.search.moves.tour_merging import TourMerging, merge_tours, mergeable
from kerfwise.models.engines.search.region_problem import Contractor, Region
from kerfwise.models.engines.search.state.route_state import make_tables
from kerfwise.models.engines.search.walker import CoolingPart, Elite, Pool, Walker
from kerfwise.models.engines.tuning import SIZE
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rule_kit import Lag
from kerfwise.tests.models.problems import ABOUT, problem, scattered

PLATE = scattered(11, contours=60, sites=1, pairs=40)
CONTRACTOR = Contractor(PLATE, make_tables(PLATE))


def _walker(number: int) -> Walker:
    fields = make_tables(PLATE)
    walker = AnnealingWalker(kernel_argument(fields), fields, (5, number))
    walker.start()
    walker.measure(100_000)
    return walker


def _parents() -> tuple[Walker, tuple[Elite, Elite]]:
    first, second = (_walker(number).best for number in (1, 2))
    assert first is not None
    assert second is not None
    better, worse = sorted([first, second], key=lambda elite: elite.cost)
    return _walker(3), (better, worse)


def test_a_child_is_lawful_and_no_worse_than_the_better_of_its_parents() -> None:
    walker, parents = _parents()
    child, operations = merge_tours(PLATE, CONTRACTOR, walker, parents, (5, 9), 3_000_000)
    assert operations <= 3_000_000
    assert child.cost < parents[0].cost
    assert broken(PLATE, child.route.tolist()) == ()
    assert child.cost == route_cost(PLATE, child.route.tolist())


def test_equal_seeds_give_equal_children() -> None:
    children = []
    for _ in range(2):
        walker, parents = _parents()
        children.append(merge_tours(PLATE, CONTRACTOR, walker, parents, (5, 9), 1_000_000)[0])
    assert children[0].same(children[1])


def test_of_one_route_alone_the_walker_goes_on_by_itself() -> None:
    walker, (better, _) = _parents()
    child, _ = merge_tours(PLATE, CONTRACTOR, walker, (better, better), (5, 9), 3_000_000)
    assert child.cost <= better.cost


def test_merging_may_begin_before_anything_was_annealed() -> None:
    walkers = [_walker(0), _walker(1)]
    best = min(walker.cost or 0 for walker in walkers)
    merging = TourMerging(PLATE, make_tables(PLATE), walkers, 5)
    with ThreadPoolExecutor(2) as threads:
        assert merging.step(threads, 1_000_000, CoolingPart(0.9, 0.95, 0), 1_000_000, _unasked) <= 1_000_000
    after = [walker.best for walker in walkers]
    assert all(elite is not None and np.unique(elite.route).size == PLATE.n for elite in after)
    assert min(walker.cost or 0 for walker in walkers) <= best


def _unasked(chunk: int, part: CoolingPart) -> None:
    raise AssertionError((chunk, part))


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
