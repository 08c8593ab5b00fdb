"""Merged tours: the same each time, never worse than what they come from, from wherever they begin."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from kerfwise.models.engines.search.anneal import AnnealingWalker
from kerfwise.models.engines.search.moves.tour_merging import TourMerging, merge_tours
from kerfwise.models.engines.search.region_problem import Contractor
from kerfwise.models.engines.search.state.route_state import make_tables
from kerfwise.models.engines.search.walker import CoolingPart, Elite, Walker
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.tests.models.problems import scattered

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
