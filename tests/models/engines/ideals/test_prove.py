"""The dynamic program over ideals against brute force, and on problems that fall apart into zones."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import assume, given

from kerfwise.models import jit
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.ideals.stretch import series
from kerfwise.models.engines.ideals.stretches.stretch_tables import NARROW
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.jit import Kernel
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem, SoftGroup
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.engines.ideals.chains import chains
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered
from kerfwise.tests.tools.amount import examples


@pytest.mark.slow
@examples(150)
@given(problems())
def test_same_optimum_as_brute_force(drawn: Problem) -> None:
    tiny = replace(drawn, general=(), lags=tuple(lag for lag in drawn.lags if lag.cuts <= 1 and not lag.seconds))
    best, proof = cheapest(tiny), prove(tiny, None, Deadline(10))
    assert proof is not None
    if best is None:
        assert proof.incumbent is None
        return
    assert proof.incumbent is not None
    assert proof.incumbent.cost == best.cost
    assert broken(tiny, proof.incumbent.route) == ()
    assert route_cost(tiny, proof.incumbent.route) == best.cost


@pytest.mark.slow
@examples(60)
@given(problems())
def test_the_same_proof_in_plain_python_as_compiled(drawn: Problem) -> None:
    tiny = replace(drawn, general=(), lags=tuple(lag for lag in drawn.lags if lag.cuts <= 1 and not lag.seconds))
    compiled = prove(tiny, None, Deadline(10))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Kernel, "made", False)
        patch.setattr(jit._process, "plain_steps", math.inf)
        patch.setattr(Kernel, "dispatcher", None)
        plain = prove(tiny, None, Deadline(10))
    assert compiled is not None
    assert plain is not None
    assert plain.incumbent == compiled.incumbent


@pytest.mark.slow
@examples(40)
@given(problems())
def test_plans_that_cost_more_than_narrow_numbers_hold_are_found_too(drawn: Problem) -> None:
    assume(drawn.n > 0)
    tiny = replace(drawn, general=(), lags=(), site_cost=drawn.site_cost + NARROW)
    best, proof = cheapest(tiny), prove(tiny, None, Deadline(10))
    assert proof is not None
    assert (proof.incumbent and proof.incumbent.cost) == (best and best.cost)
    assert best is None or best.cost >= NARROW


@pytest.mark.slow
@examples(60)
@given(problems())
def test_an_incumbent_changes_nothing_but_the_work(drawn: Problem) -> None:
    tiny = replace(drawn, general=(), lags=())
    free = prove(tiny, None, Deadline(10))
    assert free is not None
    assume(free.incumbent is not None)
    assert free.incumbent is not None
    assert prove(tiny, free.incumbent, Deadline(10)) == free
    dearer = Incumbent(free.incumbent.route, free.incumbent.cost + 7)
    assert prove(tiny, dearer, Deadline(10)) == free


@pytest.mark.slow
@examples(60)
@given(problems())
def test_with_and_without_the_bound_by_walks_it_finds_the_same(drawn: Problem) -> None:
    tiny = replace(drawn, general=(), lags=())
    free = prove(tiny, None, Deadline(10))
    assume(free is not None and free.incumbent is not None)
    assert free is not None
    assert free.incumbent is not None
    dearer = Incumbent(free.incumbent.route, free.incumbent.cost + 7)
    assert prove(tiny, dearer, Deadline(10), stages=()) == free
    assert prove(tiny, dearer, Deadline(10)) == free


def zones(count: int, size: int, sites: int) -> Problem:
    """Zones of contours from left to right, each before the next."""
    ranked = [(i, j) for i in range(count * size) for j in range(count * size) if i // size + 1 == j // size]
    bare = scattered(5, count * size, sites)
    where = [
        [(x / 1000, y / 1000) for x, y in bare.pierce_um[list(bare.sites(i))].tolist()] for i in range(count * size)
    ]
    return problem(where, pairs=ranked)


def test_zones_are_swept_one_after_the_other() -> None:
    many = zones(10, 8, 8)
    assert [len(group) for group in series(many)] == [8] * 10
    proof = prove(many, None, Deadline(10))
    assert proof is not None
    assert proof.incumbent is not None
    assert broken(many, proof.incumbent.route) == ()
    assert route_cost(many, proof.incumbent.route) == proof.incumbent.cost


def test_a_soft_group_across_two_zones_joins_them() -> None:
    two = replace(zones(2, 2, 1), soft_groups=(SoftGroup((1, 2), 1000, ABOUT),))
    assert [len(group) for group in series(two)] == [1, 2, 1] or len(series(two)) < 3
    proof, best = prove(two, None, Deadline(10)), cheapest(two)
    assert proof is not None
    assert proof.incumbent is not None
    assert best is not None
    assert proof.incumbent.cost == best.cost


@pytest.mark.slow
def test_says_so_when_it_does_not_fit() -> None:
    assert prove(scattered(1, 20, 4), None, Deadline(0.001)) is None
    assert prove(scattered(1, 70, 1), None, Deadline(10)) is None


def test_does_not_claim_what_a_state_cannot_hold() -> None:
    lagged = replace(scattered(1, 4, 1), lags=(Lag(0, 1, ABOUT, cuts=2),))
    assert not lagged.looks_one_back
    assert prove(lagged, None, Deadline(10)) is None


def test_no_contours_at_all_is_not_a_proof() -> None:
    empty = problem([])
    assert series(empty) == []
    assert prove(empty, None, Deadline(1)) is None
    assert np.size(empty.before) == 0


def cheapest_of_chains(two: Problem) -> int:
    """The least cost of two chains, contours 0, 2, 4 … and 1, 3, 5 …, by how far each is cut and the last site."""
    half = two.n // 2
    best = {(0, 0, two.m): 0}
    for done in range(two.n):
        grown: dict[tuple[int, int, int], int] = {}
        for (a, b, last), cost in best.items():
            for place, chain in ((a, 0), (b, 1)):
                if place == half:
                    continue
                sites = list(two.sites(2 * place + chain))
                for site, leg in zip(sites, two.legs([last] * len(sites), sites), strict=True):
                    key = (a + 1 - chain, b + chain, site)
                    grown[key] = min(grown.get(key, 1 << 60), cost + int(leg))
        best = grown
        assert all(a + b == done + 1 for a, b, _ in best)
    return min(cost + int(two.legs([last], [two.m])[0]) for (_, _, last), cost in best.items())


@pytest.mark.slow
def test_more_contours_in_a_stretch_than_a_word_has_bits() -> None:
    two = chains(2, 35)
    proof = prove(two, None, Deadline(10))
    assert proof is not None
    assert proof.incumbent is not None
    assert broken(two, proof.incumbent.route) == ()
    assert proof.incumbent.cost == route_cost(two, proof.incumbent.route) == cheapest_of_chains(two)
    assert prove(two, Incumbent(proof.incumbent.route, proof.incumbent.cost + 1), Deadline(10)) == proof


def test_costs_that_need_wide_integers() -> None:
    far = problem([[(400_000.0 * (x % 3), 300_000.0 * (x % 2))] for x in range(6)], pairs=[(3, 0)])
    proof, best = prove(far, None, Deadline(10)), cheapest(far)
    assert proof is not None
    assert proof.incumbent is not None
    assert best is not None
    assert proof.incumbent.cost == best.cost > 2**31


def test_it_stops_when_it_is_told_to() -> None:
    asked: list[str] = []

    def stop(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        asked.append(engine)
        return len(asked) < 5

    assert prove(scattered(1, 16, 2), None, Deadline(10, listener=stop)) is None
    assert asked == ["ideals"] * 5


def test_what_does_not_fit_into_the_memory_is_not_begun() -> None:
    """Layers are paid for in bytes before they are made, and so are the tables of the bound."""
    given = scattered(1, contours=9, sites=2)
    found = prove(given, None, Deadline(10))
    assert found is not None
    assert found.incumbent is not None
    assert prove(given, None, Deadline(10, most_bytes=2000)) is None
    assert prove(given, found.incumbent, Deadline(10, most_bytes=2000)) is None
    assert prove(given, None, Deadline(10, most_bytes=1e6)) == found


def test_a_move_pays_for_every_statement_of_a_contour_that_it_crosses() -> None:
    """A move over C0 pays twice where two areas come with it: no plan is proven for half of that."""
    points = [[(10.0, 0.0)], [(20.0, 0.0)], [(30.0, 0.0)], [(10.0, 30.0)]]
    wants = [Condition(contour, (0,), (1,), 1, ABOUT, cost=25_000) for contour in (2, 3)]
    moves = list(permutations((1, 2, 3), 2))
    rows = np.array([(*move, 0, 15_000, statement) for move in moves for statement in (0, 1)])
    twice = problem(points, conditions=wants, crossings=Crossings(*rows.T.copy()))
    proof, best = prove(twice, None, Deadline(1.0)), cheapest(twice)
    assert proof is not None
    assert proof.incumbent is not None
    assert best is not None
    assert proof.incumbent.cost == best.cost
