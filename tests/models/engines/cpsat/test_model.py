"""CP-SAT against every route tried one by one, on problems drawn at random."""

from __future__ import annotations

import pytest
from hypothesis import given

from kerfwise.models.engines.cpsat import model, solve_cpsat
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import VARIABLES_LOOKS as LOOKS
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import problems, scattered
from kerfwise.tests.tools.amount import examples


@pytest.mark.slow
@given(problems())
@examples(60)
def test_same_optimum_as_by_trying_every_route(drawn: Problem) -> None:
    best = cheapest(drawn)
    outcome = solve_cpsat(drawn, Deadline(20.0), None)
    assert outcome.infeasible == (best is None)
    if best is not None:
        assert outcome.incumbent is not None
        assert outcome.incumbent.cost == outcome.bound == best.cost
        assert outcome.proven_optimal


class Reached(Exception):
    """The solver would have run."""


@pytest.fixture(name="best")
def a_plan() -> Incumbent:
    best = cheapest(scattered(1, 5, 2))
    assert best is not None
    return best


def test_with_a_deadline_in_the_past_nothing_is_begun(best: Incumbent, monkeypatch: pytest.MonkeyPatch) -> None:
    def begun(*_: object) -> None:
        raise AssertionError("arcs are listed although there is no time")

    monkeypatch.setattr(model, "site_arcs", begun)
    outcome = solve_cpsat(scattered(1, 5, 2), Deadline(time_s=0.0), best, 17)
    assert (outcome.incumbent, outcome.bound, outcome.proven_optimal) == (best, 17, False)


def test_told_no_at_any_step_it_goes_no_further(best: Incumbent, monkeypatch: pytest.MonkeyPatch) -> None:
    def reached(*_: object) -> None:
        raise Reached

    seen = scattered(1, 5, 2)
    monkeypatch.setattr(model, "run_solver", reached)
    questions = 0

    def count(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        nonlocal questions
        questions += 1
        return questions != last

    last = 0  # never told no
    with pytest.raises(Reached):
        solve_cpsat(seen, Deadline(30.0, listener=count), best)
    families, whole = 15, questions
    assert whole >= 2 + families  # arcs, and every family of constraints
    for last in range(1, whole + 1):
        questions = 0
        outcome = solve_cpsat(seen, Deadline(30.0, listener=count), best)
        assert (outcome.incumbent, questions) == (best, last)
        assert outcome.bound is not None
        assert outcome.bound <= best.cost


def test_long_lists_of_arcs_are_asked_for_in_between() -> None:
    """More than twice so many pairs of contours: three questions."""
    many = scattered(1, 47, 1)
    asked: list[None] = []
    model.site_arcs(many, many.successors(), lambda: asked.append(None))
    assert len(asked) == -(-int(many.successors().sum()) // LOOKS) == 3
