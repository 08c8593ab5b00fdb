"""Conditions of a model file over several moves: the best order that keeps them, and what to do where none does."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import pytest

from kerfwise import Nest, Profile
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.conflict import find_conflict
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import AtLeast, Statement

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
pytestmark = [pytest.mark.slow, pytest.mark.minizinc]


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


def request(sheet: Nest, profile: Profile) -> Request:
    return make_request(facts_of(sheet, profile), profile)


def of_lots(request: Request) -> list[Statement]:
    return [s for s in request.stated.statements if s.about.rule == "lots"]


def kept(lots: str, places: tuple[int, ...]) -> bool:
    return all(len({lots[k] for k in three}) > 1 for three in zip(places, places[1:], places[2:], strict=False))


def test_the_plan_is_the_best_of_all_orders_that_keep_the_rule(tmp_path: Path) -> None:
    lots = "aaaabb"
    sheet, profile = row(lots), plant(tmp_path)
    asked = request(sheet, profile)
    problem = make_problem(asked.facts, asked.stated.statements, profile.machine.home)
    routes = ([problem.first[k] for k in places] for places in permutations(range(6)) if kept(lots, places))
    made = solve_and_verify(asked, profile, SolveOptions(work=1.0))
    assert made.verdict.ok
    assert made.plan.solve.status == "optimal"
    assert made.plan.solve.objective == pytest.approx(min(route_cost(problem, route) for route in routes) / UM_PER_MM)


def test_a_condition_is_about_the_contours_that_it_names(tmp_path: Path) -> None:
    """On few contours it was about all of them, as their orders tell where each of these is."""
    stated = of_lots(request(row("aaabb"), plant(tmp_path)))
    assert [sorted(s.about.contours) for s in stated] == [["P0.outer", "P1.outer", "P2.outer"]] * 6
    assert all(isinstance(s, AtLeast) and len(s.literals) == 2 for s in stated)


def test_of_a_contradiction_one_condition_gives_way(tmp_path: Path) -> None:
    """Five parts of one lot and one of another: in every order three of the five follow each other."""
    sheet, profile = row("aaaaab"), plant(tmp_path)
    facts = facts_of(sheet, profile)
    conflict = find_conflict(facts, profile, Deadline(1.0))
    assert conflict is not None
    assert {about.rule for about in conflict.clash} == {"lots"}
    assert conflict.relax
    assert [(about.rule, len(about.contours)) for about in conflict.relax] == [("lots", 3)]
    options = SolveOptions(work=1.0)
    relaxed = make_request(facts, profile, True, options)
    assert len(relaxed.stated.dropped) == 1
    assert solve_and_verify(relaxed, profile, options).verdict.ok


@pytest.mark.parametrize(("text", "count"), [(LOTS, 1), (LOTS.replace("i != k", "i != k /\\ zone[i] = zone[j]"), 2)])
def test_by_other_zones_a_file_is_read_again_only_if_it_names_zones(
    text: str, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sheet, profile, read = row("aaabbb"), plant(tmp_path, text), []
    read_anew = ModelRule._read_anew
    monkeypatch.setattr(ModelRule, "_read_anew", lambda *given: read.append(given) or read_anew(*given))
    facts = facts_of(sheet, profile)
    for of in (facts, replace(facts, zone=facts.zone + 1)):
        make_request(of, profile)
    assert len(read) == count
