"""Sweeps of the most promising states against brute force, and what they claim when they had to drop some."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove, widen
from kerfwise.models.engines.ideals.prove import Proof
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import problem, problems, scattered
from kerfwise.tests.tools.amount import examples


def within_reach(drawn: Problem) -> Problem:
    """Without what a state does not hold."""
    return replace(drawn, general=(), lags=tuple(lag for lag in drawn.lags if lag.cuts <= 1 and not lag.seconds))


def one_sweep(asked: Problem, width: int, known: Incumbent | None = None) -> Proof:
    """What a single sweep of so many states says."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(import_module("kerfwise.models.engines.ideals.prove"), "WIDENED", 1e9)
        return widen(asked, known, Deadline(5.0), width=width)


@pytest.mark.slow
@examples(100)
@given(problems(), st.integers(1, 4))
def test_whatever_it_starts_with_it_ends_with_the_best_plan(drawn: Problem, width: int) -> None:
    tiny = within_reach(drawn)
    best = cheapest(tiny)
    told = None if best is None else Incumbent(best.route, best.cost + 1)
    for found in (
        widen(tiny, None, Deadline(5.0), width=width),
        *(() if told is None else (widen(tiny, told, Deadline(5.0), width=width),)),
    ):
        assert found.least is None
        assert (found.incumbent is None) == (best is None)
        if found.incumbent is not None and best is not None:
            assert found.incumbent.cost == best.cost == route_cost(tiny, found.incumbent.route)
            assert broken(tiny, found.incumbent.route) == ()


@pytest.mark.slow
@examples(100)
@given(problems(), st.integers(1, 4))
def test_a_narrow_sweep_claims_no_more_than_it_knows(drawn: Problem, width: int) -> None:
    tiny = within_reach(drawn)
    best, found = cheapest(tiny), one_sweep(tiny, width)
    plan = found.incumbent or found.better
    if best is None:
        assert plan is None
        return
    assert found.least is None or found.least <= best.cost
    if plan is not None:
        assert broken(tiny, plan.route) == ()
        assert best.cost <= plan.cost == route_cost(tiny, plan.route)
    if found.least is None:
        assert found.incumbent is not None
        assert found.incumbent.cost == best.cost


def test_a_narrow_sweep_does_drop_states() -> None:
    plain = scattered(3, 12, 2)
    narrow, wide = one_sweep(plain, 2), widen(plain, None, Deadline(5.0), width=2)
    assert narrow.incumbent is None
    assert narrow.better is not None
    assert wide.incumbent is not None
    assert narrow.least is not None
    assert narrow.least < wide.incumbent.cost <= narrow.better.cost


@pytest.mark.parametrize("seed", range(4))
def test_same_optimum_as_the_whole_program(seed: int) -> None:
    plain = scattered(seed, 12, 3, pairs=8, blocks=[(2, 3, 4), (7, 8)])
    proof, found = prove(plain, None, Deadline(10)), widen(plain, None, Deadline(10.0))
    assert proof is not None
    assert proof.incumbent is not None
    assert found.incumbent is not None
    assert found.incumbent.cost == proof.incumbent.cost


def test_a_plan_that_is_known_is_no_worse_for_it_and_proven_with_less() -> None:
    plain = scattered(2, 12, 2, pairs=6)
    free = widen(plain, None, Deadline(5.0), width=4)
    assert free.incumbent is not None
    told = widen(plain, free.incumbent, Deadline(5.0), width=4)
    assert told.incumbent == free.incumbent
    assert told.work < free.work


def zones(count: int, size: int) -> Problem:
    """Zones of contours from left to right, each before the next."""
    bare = scattered(5, count * size, 2)
    pairs = [(i, j) for i in range(count * size) for j in range(count * size) if i // size + 1 == j // size]
    where = [[(x / 1000, y / 1000) for x, y in bare.pierce_um[list(bare.sites(i))].tolist()] for i in range(bare.n)]
    return problem(where, pairs=pairs)


def test_stretches_one_after_the_other_with_more_contours_than_a_word_has_bits() -> None:
    many = zones(14, 5)
    proof, found = prove(many, None, Deadline(10)), widen(many, None, Deadline(10.0), width=8)
    assert proof is not None
    assert proof.incumbent is not None
    assert found.incumbent is not None
    assert found.incumbent.cost == proof.incumbent.cost


def test_without_work_it_says_nothing() -> None:
    plain = scattered(3, 12, 2)
    known = Incumbent(tuple(range(0, plain.m, 2)), 10**9)
    assert widen(plain, known, Deadline(0.0)).incumbent is None
    assert widen(plain, known, Deadline(0.0)).better == known
    assert widen(plain, None, Deadline(5.0, listener=lambda *_: False)).least == 0


@pytest.mark.parametrize("seed", range(3))
def test_moves_that_cross_for_several_prices_cost_what_they_say(seed: int) -> None:
    plain = scattered(seed, 6, 2, pairs=3)
    rng = np.random.default_rng(seed)
    rows = np.unique(np.column_stack([rng.integers(0, plain.m + 1, (400, 2)), rng.integers(0, plain.n, 400)]), axis=0)
    leave, reach, over = np.concatenate([rows, rows[::3]]).T  # some cross the same contour by two statements
    cost = rng.choice([20_000, 50_000, 90_000], len(leave))
    crossed = replace(plain, crossings=Crossings(leave, reach, over, cost, np.zeros(len(leave), dtype=np.int64)))
    best, proof = cheapest(crossed), prove(crossed, None, Deadline(10))
    assert best is not None
    assert proof is not None
    assert proof.incumbent is not None
    assert proof.incumbent.cost == best.cost == route_cost(crossed, proof.incumbent.route)
    assert best.cost != route_cost(plain, best.route), "something is crossed"
    found = widen(crossed, Incumbent(best.route, best.cost + 1), Deadline(5.0), width=3)
    assert found.incumbent is not None
    assert found.incumbent.cost == best.cost
