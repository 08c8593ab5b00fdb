"""A linear program that is solved on from its last basis has the optimum of one that is solved from nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix

from kerfwise.models.engines.bounds.restricted_master import Anew, GoesOn, RestrictedMaster, restricted_master
from kerfwise.tests.tools.amount import examples


def test_the_installed_scipy_goes_on_from_its_last_basis() -> None:
    assert isinstance(restricted_master(np.ones(2)), GoesOn)


@pytest.mark.slow
@examples(60)
@given(st.integers(0, 2**32 - 1))
def test_going_on_and_starting_anew_find_the_same_cost(seed: int) -> None:
    random = np.random.default_rng(seed)
    right = random.integers(1, 5, 3).astype(np.float64)
    programs: list[RestrictedMaster] = [GoesOn(right), Anew(right)]
    cost, least = np.zeros(0), np.zeros(0)
    table = np.zeros((3, 0))
    for _ in range(5):
        change = random.integers(3)
        if change == 0 or not len(cost):  # columns, among them one that meets each equation alone
            more = np.hstack([np.eye(3), random.integers(-1, 2, (3, 4))])
            entries = np.vstack([more, random.integers(0, 2, (len(least), 7))])
            price = random.integers(0, 9, 7).astype(np.float64)
            for program in programs:
                program.add_columns(price, csr_matrix(entries))
            cost, table = np.append(cost, price), np.hstack([table, entries])
        elif change == 1:
            rows, asked = random.integers(0, 2, (2, len(cost))), random.integers(-1, 2, 2).astype(np.float64)
            for program in programs:
                program.add_rows(csr_matrix(rows.astype(np.float64)), asked)
            least, table = np.append(least, asked), np.vstack([table, rows])
        elif len(least):
            gone = int(random.integers(len(least)))
            for program in programs:
                program.drop_rows(np.array([3 + gone]))
            least, table = np.delete(least, gone), np.delete(table, 3 + gone, axis=0)
        on, anew = (program.solve(1000) for program in programs)
        assert (on is None) == (anew is None)
        if on is None or anew is None:
            continue
        assert cost @ on.value == pytest.approx(cost @ anew.value, abs=1e-6)
        for solved in (on, anew):  # lawful, and proven by its multipliers
            assert np.allclose(table[:3] @ solved.value, right)
            assert (table[3:] @ solved.value >= least - 1e-6).all()
            assert (solved.value >= -1e-9).all()
            assert (cost - solved.multiplier @ table >= -1e-6).all()
            assert np.allclose(solved.reduced, cost - solved.multiplier @ table, atol=1e-6)
            assert solved.multiplier @ np.append(right, least) == pytest.approx(cost @ solved.value, abs=1e-6)


@pytest.mark.parametrize("kind", [GoesOn, Anew])
def test_columns_can_be_limited_and_priced_anew(kind: type[RestrictedMaster]) -> None:
    program = kind(np.array([4.0]))  # type: ignore[call-arg]
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
    program = restricted_master(np.full(30, 2.0))
    random = np.random.default_rng(1)
    program.add_columns(random.random(200), csr_matrix(np.hstack([np.eye(30), random.random((30, 170))])))
    assert program.solve(1) is None
    assert program.solve(1000) is not None


@pytest.mark.parametrize("kind", [GoesOn, Anew])
def test_no_optimum_within_the_seconds_is_said(kind: type[RestrictedMaster]) -> None:
    program = kind(np.full(30, 2.0))  # type: ignore[call-arg]
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
    apart, whole = GoesOn(right), GoesOn(right)
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


def _in_steps(program: GoesOn, most: int = 3) -> float:
    """The optimum, by the multipliers of all rows, of a program whose rounds are taken so many at a time."""
    for _ in range(10_000):
        solved = program.solve(most)
        if solved is not None:
            return float(program._highs.getInfo().objective_function_value)
        assert program.iterations == most
    raise AssertionError("no end")


@pytest.mark.parametrize("kind", [GoesOn, Anew])
def test_columns_that_are_not_in_use_can_be_dropped(kind: type[RestrictedMaster]) -> None:
    program = kind(np.array([4.0]))  # type: ignore[call-arg]
    program.add_columns(np.array([5.0, 2.0, 9.0, 3.0]), csr_matrix([[1.0, 1.0, 1.0, 1.0]]))
    solved = program.solve(100)
    assert solved is not None
    assert solved.reduced.tolist() == [3.0, 0.0, 7.0, 1.0]
    program.drop_columns(np.array([0, 2]), np.zeros(0, dtype=np.int64))
    program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    program.add_columns(np.array([1.0]), csr_matrix([[1.0], [0.0]]), 2.0)
    solved = program.solve(100)
    assert solved is not None
    assert solved.value.tolist() == [1.0, 1.0, 2.0]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [GoesOn, Anew])
@pytest.mark.parametrize("seed", range(6))
def test_equations_can_be_left_without_a_column(kind: type[RestrictedMaster], seed: int) -> None:
    """Two equations of a column each besides those that share them: one that nothing goes by is emptied, and filled."""
    random = np.random.default_rng(seed)
    right, goes = np.array([2.0, 0.0, 0.0]), np.array([[1, 0, 1, 0, 1], [1, -1, 0, 0, 0], [0, 0, 1, -1, 0]])
    cost = np.append(random.integers(1, 9, 4), random.integers(1, 20)).astype(np.float64)
    program = kind(right)  # type: ignore[call-arg]
    program.add_columns(cost, csr_matrix(goes.astype(np.float64)))
    solved = program.solve(100)
    assert solved is not None
    best = solved.value @ cost
    ways = {1: [0, 1], 2: [2, 3]}
    column, row = program.basic()
    for equation, columns in ways.items():
        if column[columns].sum() + row[equation] == 1 and not solved.value[columns].any():
            program.drop_columns(np.array(columns), np.array([equation]))
            left = [k for k in range(5) if k not in columns]
            again = program.solve(100)
            assert again is not None
            assert again.value @ cost[left] == best
            program.add_columns(cost[columns] - 8, csr_matrix(goes[:, columns].astype(np.float64)))
            cheaper = program.solve(100)
            assert cheaper is not None
            assert cheaper.value @ np.append(cost[left], cost[columns] - 8) <= best
            return
    raise AssertionError("every equation is in use")
