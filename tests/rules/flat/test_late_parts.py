"""Conditions of a model file that are stated only where a plan breaks them: the same plan as with all stated."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np
import pytest

from kerfwise import Nest, Profile
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.conflict import find_conflict
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.expression import late_parts
from kerfwise.rules.expression.late_parts import without_late_parts
from kerfwise.rules.expression.node import Lit, Next, Node, all_of, any_of, order
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy_statements import forbids_later, lazy_statements

LOTS = """% lots: three parts of one lot are not cut one directly after the other
array[int] of var bool: lots_holds =
  [not (directly_before(i, j) /\\ directly_before(j, k))
   | i, j, k in CONTOUR where i != j /\\ j != k /\\ i != k /\\ kind[i] = OUTER /\\ kind[j] = OUTER /\\ kind[k] = OUTER
     /\\ attribute_lot[i] = attribute_lot[j] /\\ attribute_lot[j] = attribute_lot[k]];
"""
OFF = (
    *("level-ahead", "hull-before", "zone-order", "heat-lag", "no-islands", "no-narrow-strips", "no-tip-travel"),
    *("part-rigidity", "part-contiguous"),
)


def row(lots: str) -> Nest:
    """Parts in a row, each of the lot that a letter says."""
    parts = [
        replace(part(f"P{k}", rect(95.0 * k + 10, 10, 80, 80)), attributes={"lot": lot}) for k, lot in enumerate(lots)
    ]
    return nest(95 * len(lots) + 20, 100, *parts)


def plant(folder: Path, text: str = LOTS) -> Profile:
    (folder / "lots.mzn").write_text(text)
    rules = ", ".join(f"{rule}: off" for rule in OFF)
    (folder / "plant.yaml").write_text(f"models: [lots.mzn]\nleads: {{entries: 1}}\nrules: {{{rules}}}\n")
    return load_profile(folder / "plant.yaml")


def asked(sheet: Nest, profile: Profile) -> Request:
    return make_request(facts_of(sheet, profile), profile)


def of_lots(request: Request) -> list[tuple[str, ...]]:
    return [s.about.contours for s in request.stated.statements if s.about.rule == "lots"]


def kept(lots: str, places: tuple[int, ...]) -> bool:
    return all(len({lots[k] for k in three}) > 1 for three in zip(places, places[1:], places[2:], strict=False))


@pytest.mark.slow
@pytest.mark.minizinc
def test_the_plan_is_as_good_as_with_all_of_it_stated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against every order that keeps the rule; where nothing near is stated with what is broken, in several rounds."""
    lots = "aaaabb"
    sheet, profile = row(lots), plant(tmp_path)
    whole = asked(sheet, profile)
    assert of_lots(whole)
    assert not forbids_later(whole.facts, profile)
    problem = make_problem(whole.facts, whole.stated.statements, profile.machine.home)
    routes = ([problem.first[k] for k in places] for places in permutations(range(6)) if kept(lots, places))
    least_mm = min(route_cost(problem, route) for route in routes) / UM_PER_MM

    monkeypatch.setattr(late_parts, "LAZY_FROM", 0)
    late = asked(sheet, profile)
    assert not of_lots(late)
    assert forbids_later(late.facts, profile)
    made = solve_and_verify(late, profile, SolveOptions(work=1.0))
    assert made.verdict.ok
    assert made.plan.solve.status == "optimal"
    assert made.plan.solve.objective == pytest.approx(least_mm)

    monkeypatch.setattr(late_parts, "NEAR", 0)
    look, looks = lazy_statements(late.facts, profile), []

    def refine(order: tuple[int, ...]) -> tuple[Statement, ...]:
        looks.append(look(order))
        return looks[-1]

    found = solve(late.facts, late.stated.statements, SolveOptions(work=1.0), refine=refine)
    assert (found.status, found.objective) == ("optimal", pytest.approx(least_mm))
    assert sum(map(bool, looks)) > 1


@pytest.mark.slow
@pytest.mark.minizinc
def test_a_look_states_each_thing_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(late_parts, "LAZY_FROM", 0)
    sheet, profile = row("aaabbbb"), plant(tmp_path)
    look = lazy_statements(facts_of(sheet, profile), profile)
    assert look([0, 3, 1, 4, 2, 5, 6]) == ()
    first = look([0, 1, 2, 3, 5, 4, 6])
    assert {s.about.rule for s in first} == {"lots"}
    assert look([0, 1, 2, 4, 3, 5, 6]) == ()
    assert make_problem(facts_of(sheet, profile), first, profile.machine.home).general


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize(("text", "count"), [(LOTS, 1), (LOTS.replace("i != k", "i != k /\\ zone[i] = zone[j]"), 2)])
def test_by_other_zones_a_file_is_read_again_only_if_it_names_zones(
    text: str, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sheet, profile, read = row("aaabbb"), plant(tmp_path, text), []
    read_anew = ModelRule._read_anew
    monkeypatch.setattr(ModelRule, "_read_anew", lambda *given: read.append(given) or read_anew(*given))
    facts = facts_of(sheet, profile)
    for of in (facts, replace(facts, zone=np.array([1, 1, 1, 2, 2, 2]))):
        lazy_statements(of, profile)([0, 1, 2, 3, 4, 5])
    assert len(read) == count


@pytest.mark.slow
@pytest.mark.minizinc
def test_a_contradiction_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Five parts of one lot and one of another: three of the five follow each other in every order."""
    monkeypatch.setattr(late_parts, "LAZY_FROM", 0)
    sheet, profile = row("aaaaaab"), plant(tmp_path)
    conflict = find_conflict(facts_of(sheet, profile), profile)
    assert conflict is not None
    assert {about.rule for about in conflict.clash} == {"lots"}
    assert conflict.relax is None
    assert "soft or off" in conflict.stuck


def chain(i: int, j: int, k: int) -> Node:
    return any_of([Lit(Next(i, j), False), Lit(Next(j, k), False)])


ROW_MM = np.array([[0, 0], [1, 0], [2.5, 0], [4, 0], [9, 0], [10, 0]])


def test_short_parts_and_the_nearest_are_stated_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    elements = [all_of([chain(0, 1, 4), order(3, 4)]), Lit(Next(0, 3), False), chain(2, 1, 0), chain(1, 2, 4)]
    assert without_late_parts(elements, [], ROW_MM)[0] == elements
    monkeypatch.setattr(late_parts, "LAZY_FROM", 2 * (2 * 6))
    left, _, late = without_late_parts(elements, [], ROW_MM)
    assert left == [order(3, 4), Lit(Next(0, 3), False), chain(2, 1, 0), True]
    assert sorted(late.element) == [0, 3]
    assert late.broken([3, 0, 1, 2, 4, 5], ROW_MM)[0] == late.element.index(3)
    assert late.broken([0, 1, 3, 2, 4, 5], ROW_MM) == []


def test_what_is_near_to_a_broken_part_is_stated_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(late_parts, "LAZY_FROM", 0)
    monkeypatch.setattr(late_parts, "NEAR", 1)
    elements = [chain(*three) for three in permutations(range(6), 3)]
    late = without_late_parts(elements, [], ROW_MM)[2]
    stated = late.broken([0, 1, 2, 4, 3, 5], ROW_MM)
    near = [{0, 1, 2}, {1, 2, 3}, {0, 2, 3}, {0, 1, 3}]
    of_others = [{1, 2, 4}, {2, 3, 4}, {3, 4, 5}]
    broken = [chain(*three) for three in [(0, 1, 2), (1, 2, 4), (2, 4, 3), (4, 3, 5)]]
    assert [late.nodes[k] for k in stated[:4]] == broken
    assert {frozenset(late_parts.contours_of(late.nodes[k])) for k in stated} >= {
        frozenset(s) for s in near + of_others
    }
    assert len(stated) == len(set(stated)) < len(elements)


def test_an_order_is_told_as_the_conditions_say() -> None:
    for places in permutations(range(4)):
        steps = set(pairwise(places))
        place = [places.index(k) for k in range(4)]
        assert late_parts.holds_in(chain(0, 1, 2), place) == (not {(0, 1), (1, 2)} <= steps)
