"""CP-SAT against every route tried one by one, on problems drawn at random."""

from __future__ import annotations

import pytest
from hypothesis import given

from kerfwise.models.engines.cpsat import solve_cpsat
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import problems
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
