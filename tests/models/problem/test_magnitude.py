"""Costs that no integer holds are refused before any engine begins; the largest that are not are added up exactly."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of
from kerfwise.models.engines.cpsat import solve_cpsat
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import MOST_COUNTED, MOST_UM, check_magnitude, dearest_um, make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import About, AtLeast, Before, Enough, IdleTravel, Pick
from kerfwise.rules.stating.state_rules import state_rules


def row(parts: int) -> Nest:
    return nest(40 + 90 * parts, 100, *(part(f"P{k}", rect(10 + 90 * k, 10, 70, 70)) for k in range(parts)))


ROW = row(4)


def posed(folder: Path, text: str, drawn: Nest = ROW) -> Problem:
    """The problem of a row, of four unless another is given, under a profile."""
    (folder / "plant.yaml").write_text(f"based_on: plasma-carbon-steel\n{text}\n", encoding="utf-8")
    profile = load_profile(str(folder / "plant.yaml"))
    facts = facts_of(drawn, profile)
    stated = state_rules(facts, profile)
    return make_problem(facts, stated.statements, profile.home_on(drawn), feeds_of(profile))


def test_travel_that_weighs_too_much_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"most of it by objective\.idle"):
        posed(tmp_path, "objective: {idle: 1e9}\nmachine: {home: [1e6, 0]}")


def test_a_rule_whose_largest_weight_is_too_much_in_sum_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="weight of heat-lag"):
        posed(tmp_path, "rules: {heat-lag: {lag: 7200 s, heat_radius: 1000, weight: 1e5}}", row(20))


def test_a_weight_is_less_than_an_excuse(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"plant\.yaml:2:28: rules\.heat-lag\.weight: .* no more than 100000 mm"):
        posed(tmp_path, "rules: {heat-lag: {weight: 100001}}")


@pytest.mark.parametrize(
    "text",
    [
        "machine: {home: [1e6, -1e6]}",
        "objective: {idle: 1e3}\nmachine: {home: [-1e5, 1e5]}",
        "rules: {no-islands: {weight: 1e5}, heat-lag: {weight: 1e5}, no-tip-travel: {weight: 1e5}}",
    ],
)
def test_the_largest_costs_are_added_up_alike_by_every_engine(tmp_path: Path, text: str) -> None:
    problem = posed(tmp_path, text)
    proof = prove(problem, None, Deadline(30.0))
    assert proof is not None
    answer = solve_cpsat(problem, Deadline(30.0), None)
    assert answer.incumbent is not None
    assert answer.incumbent.cost == proof.incumbent.cost == route_cost(problem, proof.incumbent.route)
    assert proof.incumbent.cost <= sum(dearest_um(problem).values()) <= MOST_UM


OWN = About("own", ("P0.outer",), "drawn too large")


@pytest.mark.parametrize(
    "asked",
    [
        AtLeast((Before(1, 0),), (2**63,), 1, OWN),
        AtLeast((Before(1, 0), Before(2, 0)), (2**62, -(2**62)), 0, OWN),
        AtLeast((Before(1, 0),), (1,), -(2**70), OWN),
        AtLeast((Pick(0), Before(1, 2)), (1, 2**63), 1, OWN),
        AtLeast((Enough((Before(1, 2),), (2**63,), 1), Pick(0)), (1, 1), 1, OWN),
    ],
)
def test_weights_that_no_integer_holds_are_refused_with_rule_and_contour(asked: AtLeast) -> None:
    facts = facts_of(ROW, load_profile())
    with pytest.raises(InputError, match=r"rule own counts what is asked of P0\.outer .* smaller"):
        make_problem(facts, (asked,), (0.0, 0.0))


def test_large_weights_that_can_be_counted_are_planned_by() -> None:
    facts = facts_of(ROW, load_profile())
    first = AtLeast((Before(3, 0),), (MOST_COUNTED // 2,), MOST_COUNTED // 2, OWN)
    problem = simplify(make_problem(facts, (first, IdleTravel(OWN)), (0.0, 0.0)))
    found = prove(problem, None, Deadline(5.0))
    assert found is not None
    order = problem.site_contour[list(found.incumbent.route)].tolist()
    assert order.index(3) < order.index(0)


def test_no_route_costs_more_than_the_dearest(tmp_path: Path) -> None:
    problem = posed(tmp_path, "rules: {heat-lag: {weight: 70}, no-islands: {weight: 90}}")
    dearest = sum(dearest_um(problem).values())
    rng = np.random.default_rng(3)
    for _ in range(200):
        route = [int(rng.integers(problem.first[c], problem.first[c + 1])) for c in rng.permutation(problem.n)]
        assert route_cost(problem, route) <= dearest


def test_a_table_of_costs_is_looked_at_too() -> None:
    table = np.full((3, 3), 10**15, dtype=np.int64)
    one = np.zeros(2, dtype=np.int64)
    problem = Problem(
        2, np.arange(3), np.arange(2), np.arange(2), np.arange(2), np.zeros((2, 2), dtype=np.int64),
        np.zeros((2, 2), dtype=np.int64), one, one, 1.0, np.zeros((2, 2), dtype=np.bool_), np.arange(2), (), (), (), (),
        ("A", "B"),
    )  # fmt: skip
    check_magnitude(problem)
    with pytest.raises(InputError):
        check_magnitude(replace(problem, matrix=table))


def test_one_site_of_a_contour_is_used_so_one_price_counts(tmp_path: Path) -> None:
    """A large plate may excuse every part at once: what each of its entries weighs is not added up."""
    problem = posed(tmp_path, "rules: {part-rigidity: hard}")
    priced = [c for c in problem.conditions if c.about.rule == "part-rigidity" and c.when is not None]
    assert len(priced) > 4 * problem.n  # several sites of a contour
    assert dearest_um(problem)["part-rigidity"] < sum(c.cost or 0 for c in priced) / 4
