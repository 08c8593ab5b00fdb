"""Tables of a problem: what is the same as in another one is taken over, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.search.state import travel
from kerfwise.models.engines.search.state.chains import chains_made, make_chains
from kerfwise.models.engines.search.state.conditions import literals_unmet, make_literals
from kerfwise.models.engines.search.state.route_state import TablesOf, make_tables
from kerfwise.models.jit import plain
from kerfwise.models.problem import moves
from kerfwise.models.problem.evaluate import general_holds
from kerfwise.models.problem.moves import PairTable
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About, AtLeast, Before, Enough, Literal, Pick, Steps
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


def _random_sum(rng: np.random.Generator, n: int, m: int, depth: int) -> tuple[list[Literal], list[int]]:
    """Orders, entries, positions, which are all orders of one contour, steps, and sums within the sum."""
    weights: dict[Literal, int] = {}
    for _ in range(int(rng.integers(1, 5))):
        i, j = rng.choice(n, 2, replace=False).tolist()
        weight, kind = int(rng.integers(-2, 4)), rng.integers(5 if depth else 4)
        if kind == 0:
            weights[Before(i, j)] = weights.get(Before(i, j), 0) + weight
        elif kind == 1:
            weights[Pick(int(rng.integers(m)))] = weight
        elif kind == 2:
            for k in set(range(n)) - {j}:
                pair = Before(k, j) if i % 2 else Before(j, k)
                weights[pair] = weights.get(pair, 0) + weight
        elif kind == 3:
            weights[Steps(i, j, -1, int(rng.integers(1, 3)))] = weight
        else:
            within, own = _random_sum(rng, n, m, depth - 1)
            weights[Enough(tuple(within), tuple(own), int(rng.integers(-2, 5)))] = weight
    return list(weights), list(weights.values())


def test_sums_are_met_by_the_routes_that_meet_the_statements() -> None:
    rng, n, m = np.random.default_rng(7), 6, 12
    met = 0
    for _ in range(25):
        rows = []
        for _ in range(5):
            literals, weights = _random_sum(rng, n, m, 2)
            price = None if rng.random() < 0.5 else float(rng.integers(1, 9))
            when = int(rng.integers(m)) if rng.random() < 0.3 else None
            bound = int(rng.integers(-4, 9))
            rows.append(AtLeast(tuple(literals), tuple(weights), bound, About("r", (), ""), when, price))
        seen = replace(scattered(1, n, 2), general=tuple(rows))
        order = rng.permutation(n)
        route = [int(seen.first[c] + rng.integers(2)) for c in order.tolist()]
        position, site = np.argsort(order), np.array(route)[np.argsort(order)]
        place, picked = {c: int(position[c]) for c in range(n)}, set(route)
        wrong = [s.weight for s in rows if not general_holds(seen, s, place, picked)]
        found = plain(literals_unmet)(make_literals(seen), seen.site_contour, position, site)
        assert found == (sum(round(w * UM_PER_MM) for w in wrong if w is not None), sum(w is None for w in wrong))
        met += len(rows) - len(wrong)
    assert 25 < met < 100


def test_chains_are_made_by_the_routes_that_break_the_statements() -> None:
    """None of them is a sum besides; one move, two, and two that do not touch."""
    rng, n = np.random.default_rng(3), 6
    made = 0
    for _ in range(60):
        rows = []
        for _ in range(8):
            moves = rng.permutation(n)[:6].reshape(-1, 2)[: int(rng.integers(1, 3))].tolist()
            moves += [[moves[-1][1], int(rng.integers(n))]] * int(rng.integers(2))
            steps = tuple(dict.fromkeys(Steps(i, j) for i, j in moves if i != j))
            price = None if rng.random() < 0.5 else float(rng.integers(1, 9))
            rows.append(AtLeast(steps, (-1,) * len(steps), 1 - len(steps), About("r", (), ""), weight=price))
        seen, order = replace(scattered(1, n, 2), general=tuple(rows)), rng.permutation(n)
        position = np.argsort(order)
        wrong = [s.weight for s in rows if not general_holds(seen, s, dict(enumerate(position.tolist())), set())]
        found = plain(chains_made)(make_chains(seen), order, position)
        assert found == (sum(round(w * UM_PER_MM) for w in wrong if w is not None), sum(w is None for w in wrong))
        assert not len(make_literals(seen).bound)
        made += len(wrong)
    assert 20 < made < 200
