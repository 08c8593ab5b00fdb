"""With common cuts, trying every plan, the proofs, the search, CP-SAT and MiniZinc find the same cost."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.models.engines.cpsat import solve_cpsat
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.engines.agree import disagreements
from kerfwise.tests.models.engines.cases import Case, common_case
from kerfwise.tests.models.solved import searched
from kerfwise.tests.tools.amount import few

SOLVED = (0, 1, 2, 4)
"""Seeds of blocks that there is a plan of."""
NO_PLAN = 3
"""That of one whose hard rules leave no order in which all can be cut."""


def problem_of(case: Case) -> Problem:
    stated = state_rules(case.facts, case.profile)
    return make_problem(case.facts, stated.statements, case.options.home_mm, case.options.feeds)


@pytest.mark.minizinc
@pytest.mark.parametrize("seed", [*few(SOLVED, 2), NO_PLAN])
def test_the_proofs_and_minizinc_agree(seed: int) -> None:
    assert disagreements(common_case(seed)) == ("no plan" if seed == NO_PLAN else "solved", [])


@pytest.mark.parametrize("seed", few([2, NO_PLAN, 0, 1], 2))
def test_every_engine_finds_what_trying_every_plan_of_four_parts_finds(seed: int) -> None:
    case = common_case(seed, one_way=True)
    problem = problem_of(case)
    best, proof = cheapest(problem), prove(problem, None, Deadline(10))
    exact = solve_cpsat(problem, Deadline(20), None)
    assert proof is not None
    assert (best is None, proof.incumbent is None, exact.infeasible) == (seed == NO_PLAN,) * 3
    if best is not None:
        found = searched(problem, replace(case.options, work=0.2))
        costs = [one.cost for one in (proof.incumbent, found, exact.incumbent) if one is not None]
        assert costs == [best.cost] * 3
        assert exact.proven_optimal


@pytest.mark.parametrize("seed", SOLVED)
def test_the_best_plan_follows_stretches(seed: int) -> None:
    """But for the first part, and what stands apart where one was left out."""
    case = common_case(seed)
    problem = problem_of(case)
    proof = prove(problem, None, Deadline(10))
    assert proof is not None
    assert proof.incumbent is not None
    used = [case.facts.candidates[c] for c in problem.site_candidate[list(proof.incumbent.route)].tolist()]
    assert sum(candidate.span is not None for candidate in used) in (len(used) - 1, len(used) - 2)
