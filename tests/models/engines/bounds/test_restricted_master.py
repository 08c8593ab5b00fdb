"""A linear program that is solved on from its last basis has the optimum of one that scipy solves from nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

from kerfwise.models.engines.bounds.flow import RestrictedMaster
from kerfwise.tests.tools.amount import examples


@pytest.mark.slow
@examples(60)
@given(st.integers(0, 2**32 - 1))
def test_going_on_and_starting_anew_find_the_same_cost(seed: int) -> None:
    random = np.random.default_rng(seed)
    right = random.integers(1, 5, 3).astype(np.float64)
    program = RestrictedMaster(right)
    cost, least = np.zeros(0), np.zeros(0)
    table = np.zeros((3, 0))
    for _ in range(5):
        change = random.integers(3)
        if change == 0 or not len(cost):  # columns, among them one that meets each equation alone
            more = np.hstack([np.eye(3), random.integers(-1, 2, (3, 4))])
            entries = np.vstack([more, random.integers(0, 2, (len(least), 7))])
            price = random.integers(0, 9, 7).astype(np.float64)
            program.add_columns(price, csr_matrix(entries))
            cost, table = np.append(cost, price), np.hstack([table, entries])
        elif change == 1:
            rows, asked = random.integers(0, 2, (2, len(cost))), random.integers(-1, 2, 2).astype(np.float64)
            program.add_rows(csr_matrix(rows.astype(np.float64)), asked)
            least, table = np.append(least, asked), np.vstack([table, rows])
        elif len(least):
            gone = int(random.integers(len(least)))
            program.drop_rows(np.array([3 + gone]))
            least, table = np.delete(least, gone), np.delete(table, 3 + gone, axis=0)
        solved = program.solve(1000)
        many = len(least) > 0
        anew = linprog(
            cost, -table[3:] if many else None, -least if many else None, table[:3], right, method="highs-ipm"
        )
        assert (solved is None) == (anew.status != 0)
        if solved is None:
            continue
        assert cost @ solved.value == pytest.approx(anew.fun, abs=1e-6)
        assert np.allclose(table[:3] @ solved.value, right)  # lawful, and proven by its multipliers
        assert (table[3:] @ solved.value >= least - 1e-6).all()
        assert (solved.value >= -1e-9).all()
        assert (cost - solved.multiplier @ table >= -1e-6).all()
        assert np.allclose(solved.reduced, cost - solved.multiplier @ table, atol=1e-6)
        assert solved.multiplier @ np.append(right, least) == pytest.approx(cost @ solved.value, abs=1e-6)


def test_columns_can_be_limited_and_priced_anew() -> None:
    program = RestrictedMaster(np.array([4.0]))
    program.add_columns(np.array([2.0, 3.0]), csr_matrix([[1.0, 1.0]]))
    program.limit(np.array([0]), np.zeros(1))
    solved = program.solve(100)
    assert solved is not None
    assert solved.value.tolist() == [0.0, 4.0]
    program.limit(np.array([0]), np.array([3.0]))
    program.price(np.array([0, 1]), np.array([5.0, 3.0]))
    solved = program.solve(100)
    assert solved is not None
    assert solved.value.tolist() == [0.0, 4.0]
    program.price(np.array([1]), np.array([9.0]))
    solved = program.solve(100)
    assert solved is not None
    assert solved.value.tolist() == [3.0, 1.0]


def test_no_optimum_within_the_rounds_is_said() -> None:
    program = RestrictedMaster(np.full(30, 2.0))
    random = np.random.default_rng(1)
    program.add_columns(random.random(200), csr_matrix(np.hstack([np.eye(30), random.random((30, 170))])))
    assert program.solve(1) is None
    assert program.solve(1000) is not None


def test_no_optimum_within_the_seconds_is_said() -> None:
    program = RestrictedMaster(np.full(30, 2.0))
    random = np.random.default_rng(1)
    program.add_columns(random.random(200), csr_matrix(np.hstack([np.eye(30), random.random((30, 170))])))
    assert program.solve(1000, 0.0) is None
    assert program.solve(1000, 60.0) is not None
    program.add_columns(np.zeros(1), csr_matrix(np.ones((30, 1))))
    assert program.solve(1000, -1.0) is None
    assert program.solve(1000) is not None


def test_what_was_broken_off_is_gone_on_with() -> None:
    """By the dual way after rows and by the primal one after columns alone, a few rounds at a time."""
    random = np.random.default_rng(2)
    right = random.integers(1, 5, 20).astype(np.float64)
    apart, whole = RestrictedMaster(right), RestrictedMaster(right)
    for turn in range(4):
        columns = np.hstack([np.eye(20), random.integers(-1, 2, (20, 60))])
        rows = random.integers(0, 2, (2 * turn, 80))
        cost = random.integers(1, 50, 80).astype(np.float64)
        for program in (apart, whole):
            program.add_columns(cost, csr_matrix(np.vstack([columns, rows])))
        if turn != 2:
            assert _in_steps(apart) == pytest.approx(_in_steps(whole, 10**6))
        asked = random.integers(0, 2, (2, 80 * (turn + 1))).astype(np.float64)
        for program in (apart, whole):
            program.add_rows(csr_matrix(asked), np.ones(2))
        assert _in_steps(apart) == pytest.approx(_in_steps(whole, 10**6))


def _in_steps(program: RestrictedMaster, most: int = 3) -> float:
    """The optimum, by the multipliers of all rows, of a program whose rounds are taken so many at a time."""
    for _ in range(10_000):
        solved = program.solve(most)
        if solved is not None:
            return float(program._highs.getInfo().objective_function_value)
        assert program.iterations == most
    raise AssertionError("no end")


def test_columns_that_are_not_in_use_can_be_dropped() -> None:
    program = RestrictedMaster(np.array([4.0]))
    program.add_columns(np.array([5.0, 2.0, 9.0, 3.0]), csr_matrix([[1.0, 1.0, 1.0, 1.0]]))
    solved = program.solve(100)
    assert solved is not None
    assert solved.reduced.tolist() == [3.0, 0.0, 7.0, 1.0]
    program.drop_columns(np.array([0, 2]))
    program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    program.add_columns(np.array([1.0]), csr_matrix([[1.0], [0.0]]), 2.0)
    solved = program.solve(100)
    assert solved is not None
    assert solved.value.tolist() == [1.0, 1.0, 2.0]
