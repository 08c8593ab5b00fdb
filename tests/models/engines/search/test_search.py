"""The search as a whole: lawful always, the cheapest on tiny problems, the same each time, and stopped when asked."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.search.state import travel
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Durations, Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered
from kerfwise.tests.models.solved import searched
from kerfwise.tests.tools.amount import examples

BLOCKS = [range(i, i + 3) for i in range(0, 24, 3)]


@pytest.mark.slow
@given(problems())
@examples(150, derandomize=True)
def test_tiny_problems_are_solved_to_the_optimum(drawn: Problem) -> None:
    best = searched(drawn, SolveOptions(work=0.015))
    expected = cheapest(drawn)
    if expected is None:
        assert best is None
        return
    assert best is not None
    assert broken(drawn, best.route) == ()
    assert best.cost == route_cost(drawn, best.route) == expected.cost


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_detour_that_fills_a_lag_of_seconds_is_found(seed: int) -> None:
    """Cuts take no time: two contours take sites that are out of the way, or no plan waits for 4 s."""
    ends = [[(0, 0), (0, 0), (0, 50)], [(0, 0), (0, 0), (0, 0)], [(0, 0)], [(0, 48)]]
    pierces = [[(0, 0)] * 3, [(0, 0), (0, 0), (0, 43)], [(0, 0)], [(0, 0)]]
    lag = Lag(0, 1, ABOUT, seconds=4.0)
    pace = Durations(np.array([0] * 7 + [1180], dtype=np.int64), 0.02)
    far = problem(pierces, ends_mm=ends, lags=[lag], pace=pace)
    assert _cost(far, SolveOptions(seed=seed, work=0.03)) == 141_000


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_answers_are_lawful_and_cost_what_they_say(seed: int) -> None:
    wide = scattered(seed, contours=40, sites=4, pairs=60, blocks=BLOCKS)
    best = searched(wide, SolveOptions(seed=seed, work=0.1))
    assert best is not None
    assert broken(wide, best.route) == ()
    assert best.cost == route_cost(wide, best.route)


@pytest.mark.slow
def test_two_seeds_agree_on_a_plate() -> None:
    plate = scattered(7, contours=30, sites=4, pairs=40, blocks=BLOCKS)
    costs = {_cost(plate, SolveOptions(seed=seed, work=0.4)) for seed in (1, 2)}
    assert len(costs) == 1


def test_more_work_is_never_worse() -> None:
    plate = scattered(5, contours=60, sites=4, pairs=60)
    searcher = Searcher(plate, seed=3)
    costs = []
    for _ in range(4):
        assert searcher.run(Deadline(0.05))
        assert searcher.best is not None
        costs.append(searcher.best.cost)
    assert costs == sorted(costs, reverse=True)


def test_same_seed_and_work_give_the_same_route() -> None:
    plate = scattered(2, contours=50, sites=4, pairs=50, blocks=BLOCKS)
    options = SolveOptions(seed=4, work=0.1)
    assert searched(plate, options) == searched(plate, options)


def test_another_seed_walks_another_way() -> None:
    plate = scattered(2, contours=120, sites=4)
    assert searched(plate, SolveOptions(seed=1, work=0.02)) != searched(plate, SolveOptions(seed=2, work=0.02))


@pytest.mark.slow
def test_legs_that_are_computed_are_those_of_the_matrix(monkeypatch: pytest.MonkeyPatch) -> None:
    plate = scattered(3, contours=25, sites=4, pairs=20)
    with_matrix = searched(plate, SolveOptions(work=0.3))
    monkeypatch.setattr(travel, "MATRIX_SITES", 0)
    assert with_matrix is not None
    assert _cost(plate, SolveOptions(work=0.3)) == with_matrix.cost


def test_a_matrix_of_travel_is_taken_as_it_is() -> None:
    around = np.array([[9, 1, 9, 9], [9, 9, 1, 9], [9, 9, 9, 1], [1, 9, 9, 9]])
    searcher = Searcher(replace(problem([[(0, 0)], [(0, 0)], [(0, 0)]]), matrix=around))
    searcher.run(Deadline(0.01))
    assert searcher.best is not None
    assert searcher.best.route == (0, 1, 2)
    assert searcher.best.cost == 4


def test_nothing_to_cut() -> None:
    best = searched(problem([]), SolveOptions(work=0.01))
    assert best is not None
    assert best.route == ()
    assert best.cost == 0


def test_no_lawful_route_is_no_answer() -> None:
    apart = problem([[(1, 0)], [(2, 0)]], lags=[Lag(0, 1, ABOUT, cuts=1)])
    assert searched(apart, SolveOptions(work=0.01)) is None


def test_it_stops_when_progress_says_so() -> None:
    plate = scattered(1, contours=60, sites=4, pairs=40)
    heard: list[int | None] = []

    def three_times(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        assert (engine, bound_um) == ("search", None)
        heard.append(cost_um)
        return len(heard) < 3

    best = searched(plate, SolveOptions(work=60.0), three_times)
    assert len(heard) == 3
    assert best is not None
    assert broken(plate, best.route) == ()
    assert best.cost <= min(cost for cost in heard if cost is not None)


def test_an_interrupt_leaves_the_best_so_far() -> None:
    plate = scattered(1, contours=60, sites=4, pairs=40)
    calls = 0

    def interrupted(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise KeyboardInterrupt
        return True

    searcher = Searcher(plate)
    assert not searcher.run(Deadline(60.0, listener=interrupted))
    assert searcher.best is not None
    assert broken(plate, searcher.best.route) == ()


@pytest.mark.slow
def test_time_cuts_the_work_short() -> None:
    plate = scattered(1, contours=60, sites=4)
    assert searched(plate, SolveOptions(work=1e6, time_s=0.3)) is not None


def test_it_goes_on_from_a_route_that_is_handed_in() -> None:
    line = problem([[(10, 0)], [(20, 0)], [(30, 0)]], pairs=[(1, 0)])
    searcher = Searcher(line)
    searcher.stand_on((1, 2, 0))
    assert searcher.best is not None
    assert searcher.best.route == (1, 2, 0)


def test_a_route_that_breaks_a_rule_is_not_stood_on() -> None:
    line = problem([[(10, 0)], [(20, 0)]], pairs=[(1, 0)])
    with pytest.raises(ValueError, match="C1 must be cut before C0"):
        Searcher(line).stand_on((0, 1))


def _cost(drawn: Problem, options: SolveOptions) -> int:
    best = searched(drawn, options)
    assert best is not None
    return best.cost
