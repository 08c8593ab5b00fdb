"""Links as sparse rows: laid over tables of moves, looked up one by one, numbered anew, and part of routes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import Ints
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost, times_ms
from kerfwise.models.problem.problem import Durations, Links, links_on
from kerfwise.rules.statements import About, Crossing, IdleTravel, Lag, Link, Statement
from kerfwise.tests.models.every_kind import FEEDS, TRACK
from kerfwise.tests.models.plan.conflict.statements import row
from kerfwise.tests.models.problems import linked, problem

ABOUT = About("links", ("P0.outer", "P1.outer"), "the torch stays on")
TRAVEL = IdleTravel(About("objective", (), ""))
ROW = [[(0.0, 0.0)], [(10.0, 0.0)], [(20.0, 0.0), (30.0, 0.0)]]
HOME = (0.0, 0.0)
SITES = 6


def offer(leave: tuple[int, ...], reach: tuple[int, ...], weight: float, seconds: float = 0.0) -> Link:
    return Link(leave, reach, ((0.0, 0.0), (1.0, 0.0)), ABOUT, weight, seconds)


def dense(links: Links) -> Ints:
    """The rows as a table, -1 for none."""
    table = np.full((links.sites + 1, links.sites + 1), -1, dtype=np.int64)
    table[links.leave, links.reach] = np.arange(len(links))
    return table


MOVES = st.lists(st.tuples(*(st.integers(0, SITES - 1),) * 2, st.integers(-9, 9), st.integers(-9, 9)), max_size=12)
PLACES = st.lists(st.integers(0, SITES), max_size=9)


@given(MOVES, PLACES, PLACES)
def test_rows_laid_over_a_table_are_those_of_the_dense_one(
    moves: list[tuple[int, int, int, int]], leave: list[int], reach: list[int]
) -> None:
    links = linked(SITES, moves)
    table = np.full((len(leave), len(reach)), 99, dtype=np.int64)
    links.laid_over(table, np.array(leave, dtype=np.int64), np.array(reach, dtype=np.int64))
    for i, a in enumerate(leave):
        for j, b in enumerate(reach):
            k = int(dense(links)[a, b])
            assert table[i, j] == (99 if k < 0 else links.cost[k])


@given(MOVES, st.lists(st.tuples(st.integers(0, SITES), st.integers(0, SITES)), max_size=9))
def test_single_moves_are_found(moves: list[tuple[int, int, int, int]], asked: list[tuple[int, int]]) -> None:
    links = linked(SITES, moves)
    leave, reach = np.array(asked, dtype=np.int64).reshape(-1, 2).T
    assert links.rows_of(leave, reach).tolist() == [int(dense(links)[a, b]) for a, b in asked]


def test_sites_that_are_gone_take_their_links_along() -> None:
    links = linked(4, [(0, 2, -5, 1), (1, 3, -6, 2), (2, 3, -7, 3)])
    left = links.renumbered(np.array([0, -1, 1, 2]), 3)
    assert (left.leave.tolist(), left.reach.tolist(), left.cost.tolist()) == ([0, 1], [1, 2], [-5, -7])


def test_of_several_offers_the_cheapest_counts_and_forbidden_candidates_have_none() -> None:
    links = Links.of([offer((0, 1), (2,), -4.0), offer((0,), (2, 3), -9.0)], np.array([0, 1, 2, -1]), 3)
    assert list(zip(links.leave.tolist(), links.reach.tolist(), links.cost.tolist(), strict=True)) == [
        (0, 2, -9000),
        (1, 2, -4000),
    ]
    assert links.path.tolist() == [1, 0]


def test_a_route_pays_for_a_link_in_place_of_travel_and_its_cut_begins_at_once() -> None:
    plain = replace(problem(ROW, site_cost=[9000] * 4), pace=Durations(np.array([2000, 3000, 4000, 5000]), 0.1))
    with_link = replace(plain, links=linked(4, [(0, 1, -8000, -700)]))
    assert route_cost(plain, [0, 1, 2]) - route_cost(with_link, [0, 1, 2]) == 10_000 + 8000
    assert route_cost(plain, [1, 0, 2]) == route_cost(with_link, [1, 0, 2])
    times = times_ms(with_link, [0, 1, 2])
    assert times[0] == (0, 2000)
    assert times[1] == (2000, 4300)
    assert times[2] == (5300, 9300)


def test_a_link_dearer_than_idle_travel_is_not_taken() -> None:
    facts = row(2)
    idle = float(np.hypot(*np.subtract(facts.candidates[0].end, facts.candidates[2].pierce)))
    for weight, taken in ((idle + 0.1, False), (idle - 0.1, True)):
        statements: tuple[Statement, ...] = (TRAVEL, offer((0,), (2,), weight))
        made = make_problem(facts, statements, HOME)
        assert bool(len(made.links)) is taken
        assert (links_on(facts.candidates, statements, [0, 2], HOME)[1] is not None) is taken


def test_of_two_links_of_one_cost_the_plan_has_the_one_that_was_compiled() -> None:
    """They cost the same to the micrometre, and the time of a plan is that of the one that was compiled."""
    facts = row(2)
    statements = (TRAVEL, offer((0,), (2,), -9.0, 1.0), offer((0,), (2,), -9.0000001, 2.0))
    assert make_problem(facts, statements, HOME).links.ms.tolist() == [1000]
    assert links_on(facts.candidates, statements, [0, 2], HOME)[1] is statements[1]


def test_a_lag_in_seconds_keeps_two_contours_from_being_linked() -> None:
    facts = row(2)
    statements = (TRAVEL, offer((0,), (2,), -9.0), Lag(1, 0, ABOUT, seconds=1.0, weight=5.0))
    assert not len(make_problem(facts, statements, HOME, FEEDS).links)
    assert links_on(facts.candidates, statements, [0, 2], HOME) == [None, None]


def test_a_hard_lag_of_cuts_does_too() -> None:
    statements = (TRAVEL, offer((0,), (2,), -9.0), Lag(1, 0, ABOUT, cuts=1))
    assert not len(make_problem(row(2), statements, HOME).links)


def test_what_a_linked_move_crosses_is_of_no_account() -> None:
    facts = row(4)
    crossing = Crossing(1, TRACK, ABOUT, 40.0)
    moves = make_problem(facts, (TRAVEL, crossing), HOME).crossings
    reach = int(moves.reach[moves.leave == 0][0])
    left = make_problem(facts, (TRAVEL, crossing, offer((0,), (reach,), -9.0)), HOME).crossings
    assert len(left) < len(moves)
    assert not ((left.leave == 0) & (left.reach == reach)).any()


def test_rows_grow_with_the_links_alone() -> None:
    """10,000 ways to cut, and some links: nothing here is as large as their square."""
    m = 10_000
    links = linked(m, [(k, (7 * k + 13) % m, -k, 0) for k in range(3000)])
    held = sum(column.nbytes for column in (links.leave, links.reach, links.cost, links.ms, links.path))
    assert held == 5 * 8 * 3000
    assert links.rows_of(np.array([5]), np.array([48])).tolist() == [5]


def test_facts_without_links_are_as_ever() -> None:
    assert compute_facts(row(2).nest, FactOptions(), row(2).candidates).links == ()
