"""The eleven rules of docs/own-rules.md: without each the best plan breaks it, with it the plan keeps it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

import kerfwise
from kerfwise import Plan, Profile, load_profile, read_nest
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.own import as_rule
from kerfwise.rules.own.demands import ASKS, PLACES
from kerfwise.rules.own.known_nest import NAMED_FACTS
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.tools.amount import full

DOCS = Path(kerfwise.__file__).parent / "docs"
PAGE = (DOCS / "own-rules.md").read_text(encoding="utf-8")
NEST = read_nest(DOCS / "own-rules.nest.json")
EXAMPLES = dict(re.findall(r"^### (\d+\. .+?)\n.*?```yaml\n(.*?)```", PAGE, re.MULTILINE | re.DOTALL))
QUIET = ("heat-lag", "no-islands", "no-narrow-strips", "no-tip-travel", "part-rigidity")
PLANT = "rules: {" + ", ".join(f"{rule}: off" for rule in QUIET) + "}\n"


def plan_of(profile: Profile, work: float = 1.0) -> Plan:
    facts = compute_facts(NEST, profile.fact_options(NEST), build_candidates(NEST, profile.lead_options()))
    stated = state_rules(facts, profile)
    solution = solve(facts, stated.statements, SolveOptions(work=work, feeds=feeds_of(profile)))
    return make_plan(facts, profile, stated, solution, "portfolio", 1)


SLOW = "10. Let a long strip cool"
BY_TITLE = [full(title) if title == SLOW else title for title in EXAMPLES]


@pytest.mark.parametrize("title", BY_TITLE)
def test_rule_changes_the_plan(title: str, tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text(PLANT + EXAMPLES[title], encoding="utf-8")
    profile = load_profile(path)
    (rule,) = profile.own_rules
    without = plan_of(replace(profile, own_rules=()))
    options = profile.settings()[rule.id].options
    assert as_rule(rule).violations(NEST, without.sequence(), options), "the rule asks nothing new"
    plan = plan_of(profile, work=8.0)
    result = check_plan(NEST, plan, profile)
    assert result.ok, result.broken()
    assert result.rule(rule.id).verdict == "holds"


def test_there_are_eleven() -> None:
    assert [title.split(".")[0] for title in EXAMPLES] == [str(k) for k in range(1, 12)]


def test_page_names_every_fact_and_demand() -> None:
    assert [name for name in (*NAMED_FACTS, *ASKS, *PLACES) if f"`{name}" not in PAGE] == []


def test_first_example_of_the_page_is_that_of_the_list() -> None:
    assert (
        PAGE.count(EXAMPLES["1. Narrow slots first"]) == 3
    )  # at the top, in the walk from an empty folder, in the list


def test_orders_of_geometry_give_way_and_are_listed(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text(PLANT + EXAMPLES["2. Priority parts first"], encoding="utf-8")
    assert [d.contours for d in plan_of(load_profile(path)).dropped] == [
        (f"{part}.outer", "C.outer") for part in ("F", "S1", "S2", "S3")
    ]
