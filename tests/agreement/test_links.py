"""With links, trying every plan, the proofs and MiniZinc find the same cost, in nests whose best plan takes a link."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.solve import solve
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import links_on
from kerfwise.rules.statements import Statement, by_kind
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.agreement.cases import judged_case
from kerfwise.tests.agreement.engines import default_pipeline
from kerfwise.tests.models.engines.agree import disagreements
from kerfwise.tests.models.engines.cases import Case, linked_case
from kerfwise.tests.models.solved import searched
from kerfwise.tests.tools.amount import few

LINKED = (0, 1, 3, 5, 12, 16)
"""Seeds of nests whose best plan takes a link."""
OTHERS = (2, 4, 6, 14, 18)
"""Seeds of nests where it takes none, or where there is no plan."""


def asked(case: Case) -> tuple[Statement, ...]:
    return state_rules(case.facts, case.profile).statements


def taken(case: Case, route: tuple[int, ...]) -> int:
    links = links_on(case.facts.candidates, asked(case), route, case.options.home_mm)
    return sum(link is not None for link in links)


@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few(LINKED, 2))
def test_every_plan_the_proofs_and_minizinc_agree(seed: int) -> None:
    assert disagreements(linked_case(seed)) == ("solved", [])


@pytest.mark.minizinc
@pytest.mark.slow
@pytest.mark.parametrize("seed", few(OTHERS))
def test_they_agree_where_no_link_is_taken(seed: int) -> None:
    assert disagreements(linked_case(seed))[1] == []


@pytest.mark.parametrize("seed", LINKED[:3])
def test_the_best_plan_takes_a_link_and_costs_more_without(seed: int) -> None:
    case = linked_case(seed)
    options = replace(case.options, work=0.3)
    found = solve(case.facts, asked(case), options)
    assert found.status == "optimal"
    assert taken(case, found.route) > 0
    without = solve(case.facts, tuple(s for s in asked(case) if not by_kind([s]).link), options)
    assert without.objective > found.objective + 0.01


@pytest.mark.slow
@pytest.mark.parametrize("seed", LINKED[:2])
def test_the_search_finds_what_is_proven_also_where_it_keeps_no_matrix(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = linked_case(seed)
    problem = make_problem(case.facts, asked(case), case.options.home_mm, case.options.feeds)
    proof = prove(problem, None, Deadline(10))
    assert proof is not None
    assert proof.incumbent is not None
    for sites in (3000, 0):
        monkeypatch.setattr("kerfwise.models.engines.search.state.travel.MATRIX_SITES", sites)
        found = searched(problem, replace(case.options, work=0.2))
        assert found is not None
        assert found.cost == proof.incumbent.cost


@pytest.mark.full
def test_a_plan_is_proven_of_which_geometry_finds_three_times_what_is_wrong() -> None:
    """Each round ends with a proof by CP-SAT, and the rounds before leave enough for the next."""
    case = judged_case(68, "links")
    answer = default_pipeline(case, state_rules(case.facts, case.profile))
    assert answer.says == "optimal"
    assert answer.mm == pytest.approx(1_006_232.276, abs=0.01)
