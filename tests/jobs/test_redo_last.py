"""A cut breaks off, at every stop of a nest with zones: it is cut again first, and the rest keeps its zones."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise import CheckResult, Nest, Plan, Profile, load_profile, read_nest
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.plan_without_zones import searched
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.jobs.resume import lock_broken_cut_first, stopped_plan
from kerfwise.pipeline import plan_of, solve_and_verify
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import few

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
CASES = Path(__file__).parent.parent / "metal" / "cases"
PLANT = """
name: plant
based_on: plasma-carbon-steel
machine: {dialect: linuxcnc, home: [0, 300]}
rules: {zone-order: ZONES, level-ahead: off, hull-before: off, start-side: {side: left}}
"""


def profile(tmp_path: Path, zones: str) -> Profile:
    path = tmp_path / "plant.yaml"
    path.write_text(PLANT.replace("ZONES", zones), encoding="utf-8")
    return load_profile(path)


def planned(nest: Nest, plant: Profile, work: float) -> Plan:
    return solve_and_verify(
        make_request(package.facts(nest, plant), plant), plant, options_for(nest, plant, work=work)
    ).plan


def expect_redone(nest: Nest, old: Plan, plant: Profile, upto: int) -> None:
    """The rest after cut `upto` broke off, planned under a profile with zones: that cut comes first, zones in turn."""
    already = stopped_plan(old, nest, upto, redo_last=True)
    locked = lock_broken_cut_first(plant, already)
    found = solve_and_verify(
        make_request(facts_of(nest, locked, already), locked), locked, options_for(nest, locked, work=0.1)
    )
    expect_in_step(found.plan, found.verdict, old, upto)


def expect_in_step(rest: Plan, verdict: CheckResult, old: Plan, upto: int) -> None:
    assert verdict.ok, (upto, verdict.broken())
    cuts = [row.cut for row in rest.cuts]
    expect_first_and_in_turn([cut.contour for cut in cuts], [cut.zone for cut in cuts], old, upto)


def expect_first_and_in_turn(contours: Sequence[str], zones: Sequence[int], old: Plan, upto: int) -> None:
    assert contours[0] == old.cuts[upto - 1].cut.contour
    assert zones == sorted(zones), upto


@pytest.mark.parametrize("step", few([4, 1]))
def test_every_stop_of_a_plan_that_had_other_zones(tmp_path: Path, step: int) -> None:
    """It was made without any: no stop is in step with zones of four contours. Every fourth; each one with `--all`."""
    nest = read_nest(NEST)
    old, plant = planned(nest, profile(tmp_path, "off"), 0.3), profile(tmp_path, "{zone_contours: 4}")
    for upto in range(1, len(old.cuts) + 1, step):
        expect_redone(nest, old, plant, upto)


@pytest.mark.full
@pytest.mark.slow
def test_every_stop_of_300_contours_whose_zones_have_moved(tmp_path: Path) -> None:
    """The rest is planned by a short search that pays for no crossing; every 7th is judged, one planned whole."""
    path = tmp_path / "g300.json"
    path.write_text(json.dumps(make_sheet(11, 280, (6000.0, 2500.0), 12.0)), encoding="utf-8")
    nest, plant = read_nest(path), load_profile()
    asked = make_request(package.facts(nest, plant), plant)
    old = solve_and_verify(asked, plant, options_for(nest, plant, work=1), move_zones=True).plan
    zones = [asked.facts.zone[nest.index[row.cut.contour]] for row in old.cuts]
    assert zones != sorted(zones)  # they have moved
    for upto in range(1, len(old.cuts) + 1):
        already = stopped_plan(old, nest, upto, redo_last=True)
        locked = lock_broken_cut_first(plant, already)
        request = make_request(facts_of(nest, locked, already), locked)
        limits = options_for(nest, locked, work=0.01)
        found = searched(request.facts, request.stated, locked, (), limits, moves=False)
        assert found is not None, upto
        rest = [request.facts.candidates[c].contour for c in found.solution.route]
        contours, zones = [request.facts.nest.contours[c].id for c in rest], [request.facts.zone[c] for c in rest]
        expect_first_and_in_turn(contours, zones, old, upto)
        if upto % 7 == 1:
            plan = plan_of(request, locked, found.solution, limits, (), reasons=False)
            expect_in_step(plan, check_plan(nest, plan, locked), old, upto)
    expect_redone(nest, old, plant, len(old.cuts) // 2)


def test_an_operator_is_told_without_names_of_rules(tmp_path: Path) -> None:
    words = [CASES / "17-resume-conflict.json", "-p", CASES / "17-resume-conflict.yaml", "--work", "0.2"]
    words += ["--lock-from", CASES / "17-resume-conflict.nc", "--upto", "3", "--redo-last", "-o", tmp_path / "rest.nc"]
    result = kerfwise("solve", *words, "--conflict-picture", tmp_path / "conflict.svg")
    assert result.code == 1
    assert "what is left after cut 2 cannot be cut as the plant asks; these do not go together:" in result.err
    assert "it can be cut if this is not kept:" in result.err
    plant = load_profile(CASES / "17-resume-conflict.yaml")
    assert [name for name in plant.rulebook() if f"{name}:" in result.err or f"relax {name}" in result.err] == []
