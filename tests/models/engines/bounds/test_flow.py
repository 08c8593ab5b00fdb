"""The bound by flows: never above the optimum, and as high as orders and blocks make it by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools
from kerfwise.models.engines.bounds import flow, flow_bound
from kerfwise.models.engines.bounds.flow import FlowProgram, RestrictedMaster
from kerfwise.models.engines.bounds.network import Network, block_inequalities, network_of
from kerfwise.models.engines.bounds.separation import Flow, Separation
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent, flows_s
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.problem import Problem
from kerfwise.rule_kit import About
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import problem, problems, scattered
from kerfwise.tests.tools.amount import examples, few

ROW = [[(10.0, 0.0)], [(20.0, 0.0)], [(30.0, 0.0)]]


def best_of(tiny: Problem) -> Incumbent:
    best = cheapest(tiny)
    assert best is not None
    return best


@pytest.mark.slow
@examples(60)
@given(problems(contours=5))
def test_no_plan_costs_less(tiny: Problem) -> None:
    best = cheapest(tiny)
    if best is not None:
        dear = replace(best, cost=best.cost + 10**9)  # nothing but the bound itself keeps it below
        assert flow_bound(tiny, dear, Deadline(1.0)).bound <= best.cost


@pytest.mark.slow
@examples(60)
@given(problems(contours=5))
def test_moves_that_are_closed_for_a_known_plan_are_not_those_of_a_better_one(tiny: Problem) -> None:
    best = cheapest(tiny)
    for route in list(lawful(tiny))[:4]:
        assert best is not None
        known = Incumbent(route, route_cost(tiny, route))
        assert flow_bound(tiny, known, Deadline(1.0)).bound <= best.cost


@pytest.mark.slow
@examples(30)
@given(problems(contours=5), st.integers(0, 2**32 - 1))
def test_no_plan_costs_less_where_moves_cost_what_they_will(tiny: Problem, seed: int) -> None:
    matrix = np.random.default_rng(seed).integers(0, 100_000, (tiny.m + 1, tiny.m + 1))
    drawn = replace(tiny, matrix=matrix, moves=MovePrices())
    best = cheapest(drawn)
    if best is not None:
        assert flow_bound(drawn, replace(best, cost=best.cost + 10**9), Deadline(1.0)).bound <= best.cost


@pytest.mark.slow
@examples(40)
@given(problems(contours=5), st.integers(0, 2**32 - 1))
def test_cuts_hold_for_every_plan(tiny: Problem, seed: int) -> None:
    routes = list(lawful(tiny))[:20]
    seen = [network_of(tiny, route, 10**15, flow.MOST_SITES) for route in routes]
    if not seen:
        return
    split = seen[0].problem
    leave, reach = (ends.ravel() for ends in np.indices((split.m + 1, split.m + 1)))
    random = np.random.default_rng(seed)
    found = Separation(seen[0]).broken(Flow(leave, reach, random.random(len(leave)) / split.m))
    for cuts in (block_inequalities(split), found):
        for network in seen:
            stops = np.array([split.m, *network.plan, split.m])
            made = np.asarray(cuts.across(stops[:-1], stops[1:]).sum(axis=1)).ravel()
            assert (made >= cuts.least).all()


@pytest.mark.slow
def test_large_problems_by_contours(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = scattered(4, 5, 2)
    best = best_of(seen)
    by_sites = flow_bound(seen, best, Deadline(5.0)).bound
    monkeypatch.setattr(flow, "MOST_SITES", 3)
    assert 0 < flow_bound(seen, best, Deadline(5.0)).bound <= by_sites <= best.cost


@pytest.mark.slow
def test_where_a_first_bound_takes_longer_than_there_is_work_contours_stand_for_their_sites(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = scattered(4, 5, 2)
    best = best_of(seen)
    sizes: list[int] = []

    def noted(split: Problem, route: tuple[int, ...], most: int, most_sites: int, go: Callable[[], bool]) -> Network:
        sizes.append(split.m)
        return network_of(split, route, most, most_sites, go)

    monkeypatch.setattr(flow, "network_of", noted)
    for work in (0.9, 1.1):
        flow_bound(seen, best, Deadline(work * flows_s(seen.n, seen.m) / flow.SETTING_OUT))
    assert sizes == [5, 10]


@pytest.mark.slow
def test_what_is_stopped_says_nothing_or_what_was_proven_so_far() -> None:
    seen = scattered(4, 5, 2)
    best = best_of(seen)
    assert flow_bound(seen, best, Deadline(5.0, listener=lambda *_: False)).bound == 0
    whole = flow_bound(seen, best, Deadline(5.0)).bound
    for most in range(2, 40, 5):
        asked = iter(range(most))
        until = Deadline(5.0, listener=lambda *_, asked=asked: next(asked, None) is not None)
        assert 0 <= flow_bound(seen, best, until).bound <= whole


class Late(Deadline):
    """It is over, and nobody says so when asked."""

    left_s = 0.0

    def __call__(self, *_: object) -> bool:
        return True


@pytest.mark.slow
def test_a_limit_by_the_clock_breaks_the_program_off() -> None:
    seen = scattered(4, 5, 2)
    best = best_of(seen)
    assert flow_bound(seen, best, Late(5.0)).bound == 0
    assert flow_bound(seen, best, Deadline(5.0, 600.0)).bound == flow_bound(seen, best, Deadline(5.0)).bound > 0


def test_an_order_that_leads_back_and_forth_is_proven() -> None:
    crossed = problem([*ROW, [(40.0, 0.0)]], pairs=[(3, 0), (0, 2), (2, 1)])
    best = best_of(crossed)
    assert flow_bound(crossed, best, Deadline(5.0)).bound == best.cost == 40_000 + 30_000 + 20_000 + 10_000 + 20_000


def test_two_clusters_are_not_two_cycles() -> None:
    far = problem([[(1.0, 0.0)], [(500.0, 0.0)], [(501.0, 0.0)], [(502.0, 0.0)]])
    best = best_of(far)
    assert flow_bound(far, best, Deadline(5.0)).bound == best.cost == 2 * 502_000


@pytest.mark.parametrize("seed", range(5))
def test_a_contour_is_left_from_where_it_was_come_to(seed: int) -> None:
    places = np.random.default_rng(seed).integers(0, 100, (5, 2, 2)).tolist()
    far = problem([[(float(x), float(y)) for x, y in sites] for sites in places])
    best = best_of(far)
    assert flow_bound(far, best, Deadline(5.0)).bound == best.cost


def test_a_block_is_entered_once() -> None:
    mixed = problem([[(0.0, 100.0)], [(0.0, 200.0)], [(50.0, 100.0)]], blocks=[(0, 1)])
    best = best_of(mixed)
    assert flow_bound(mixed, best, Deadline(5.0)).bound == best.cost


def test_nothing_is_said_of_nothing() -> None:
    assert flow_bound(problem([]), Incumbent((), 0), Deadline(1.0)).bound == 0


def test_a_site_that_must_be_cut_early_is_not_used_late() -> None:
    """The near site of the last contour is held by the one before it, which must then wait."""
    places = [[(30.0, 0.0)], [(20.0, 20.0)], [(10.0, 0.0), (10.0, 40.0)]]
    held = Condition(2, (0, 1), (-1, -1), -1, About("held", (), ""), when=2)
    orders = [(0, 1), (0, 2)]
    best, free = (best_of(problem(places, pairs=orders, conditions=asked)) for asked in ([held], []))
    assert best.route == (0, 2, 1)
    assert (
        free.cost < flow_bound(problem(places, pairs=orders, conditions=[held]), best, Deadline(5.0)).bound == best.cost
    )


def test_an_excuse_is_in_the_bound() -> None:
    row = [[(10.0, 0.0)], [(20.0, 0.0)]]
    dear = problem(row, pairs=[(0, 1)], conditions=[Condition(1, (0,), (-1,), 0, About("held", (), ""), cost=10**9)])
    best = best_of(dear)
    assert flow_bound(dear, best, Deadline(5.0)).bound in (best.cost - 1, best.cost)


@pytest.mark.slow
@pytest.mark.parametrize("seed", few([1, 0, 2, 3]))
def test_a_bound_holds_where_dear_moves_are_dropped_again_and_again(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = scattered(seed, 5, 2, pairs=seed)
    best = best_of(seen)
    whole = flow_bound(seen, best, Deadline(5.0)).bound
    dropped: list[int] = []
    drop_dear = FlowProgram.drop_dear

    def noted(program: FlowProgram, in_use: Bools) -> Bools:
        kept = drop_dear(program, in_use)
        dropped.append(int((~kept).sum()))
        return kept

    monkeypatch.setattr(FlowProgram, "drop_dear", noted)
    monkeypatch.setattr(flow, "MANY_MOVES", 0)
    assert 0.999 * whole <= flow_bound(seen, best, Deadline(5.0)).bound <= best.cost
    assert sum(dropped) > 0


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
