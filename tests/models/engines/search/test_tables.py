"""Tables of a problem: what is the same as in another one is taken over, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.models.engines.search.state import travel
from kerfwise.models.engines.search.state.route_state import TablesOf, make_tables
from kerfwise.models.problem import moves
from kerfwise.models.problem.moves import PairTable
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.problems import scattered

PLATE = scattered(3, contours=20, sites=3, pairs=15)


def _moved(problem: Problem) -> Problem:
    ends = problem.end_um.copy()
    ends[4] += 1000
    return replace(problem, end_um=ends)


def _reversed(problem: Problem) -> Problem:
    return replace(problem, before=np.ascontiguousarray(problem.before.T))


@pytest.mark.parametrize("most", [0, 3000])
def test_what_statements_do_not_change_is_taken_over(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(travel, "MATRIX_SITES", most)
    known = TablesOf(PLATE, make_tables(PLATE))
    later = make_tables(replace(PLATE, site_cost=PLATE.site_cost + 7), known)
    assert later.legs.travel is known.tables.legs.travel
    assert later.orders is known.tables.orders
    assert (later.legs.site_cost == PLATE.site_cost + 7).all()


@pytest.mark.parametrize("most", [0, 3000])
@pytest.mark.parametrize("other", [_moved(PLATE), _reversed(PLATE), scattered(4, contours=20, sites=3, pairs=15)])
def test_tables_are_those_made_from_nothing(most: int, other: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(travel, "MATRIX_SITES", most)
    made, anew = make_tables(other, TablesOf(PLATE, make_tables(PLATE))), make_tables(other)
    for part, expected in ((made.legs, anew.legs), (made.orders, anew.orders)):
        for name, value in zip(part._fields, part, strict=True):
            assert np.array_equal(value, getattr(expected, name)), name


def test_a_matrix_made_in_parts_is_that_of_the_single_moves() -> None:
    wide = scattered(1, contours=120, sites=3, pairs=0)
    sites = np.arange(wide.m + 1)
    whole = wide.travel(sites, sites)
    assert whole.size > 3 * 30_000
    for site in (0, 100, wide.m - 1, wide.m):
        assert (whole[site] == wide.legs(np.full(wide.m + 1, site), sites)).all()


@pytest.mark.parametrize("sparse", [1, 10**9])
def test_prices_are_added_alike_place_by_place_and_all_at_once(sparse: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(moves, "SPARSE", sparse)
    groups = [(np.array([0, 1, 2]), np.array([4, 5]), 5), (np.array([1, 2]), np.array([5, 7]), 7)]
    table, leave, reach = PairTable.of(9, groups), np.array([2, 8, 1, 2]), np.array([5, 0, 7])
    priced = np.ones((4, 3), dtype=np.int64)
    table.add_to(priced, leave, reach)
    assert (priced == 1 + table.between(leave, reach)).all()
    assert priced.max() == 13
