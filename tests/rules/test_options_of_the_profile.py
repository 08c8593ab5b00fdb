"""Whoever judges by a rule has the options that the profile gives it, and never a rule's defaults.

Each rule is given one option more, which the profile sets: whoever calls a rule with options that lack it, or that have
its default, has made options of its own.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Iterator
from dataclasses import field, make_dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise.encoder.cut import CutSequence
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import check_cuts, check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.flat.model_rule import ModelRule, options_in_place
from kerfwise.rules.options.kind import Number
from kerfwise.rules.options.option import option
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleSetting

PLATE = nest(
    500,
    250,
    part("A", rect(20, 20, 200, 200), [rect(60, 60, 100, 100)]),
    part("B", rect(80, 80, 60, 60)),
    part("C", rect(250, 20, 90, 90)),
    part("D", rect(370, 120, 90, 90)),
)
FACTS = "[before(i, j) | i, j in CONTOUR where {} /\\ false]"
GIVEN = 7


@pytest.fixture
def marked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every rule of the catalogue has one option more."""
    for rule in RULES.values():
        base = rule.Options
        more = ("marked", int, field(default=0, metadata=option(Number(whole=True), "made for a test")))
        monkeypatch.setattr(type(rule), "Options", make_dataclass(base.__name__, [more], bases=(base,), frozen=True))
    options_in_place.cache_clear()


@pytest.fixture
def heard(marked: None, monkeypatch: pytest.MonkeyPatch) -> dict[str, set[tuple[str, int]]]:
    """Rule id → each hook that was called with options, and what the added option was."""
    found: dict[str, set[tuple[str, int]]] = {}
    for rule in RULES.values():
        for name, hook in _hooks(type(rule)):
            monkeypatch.setattr(type(rule), name, _listening(hook, name, rule.id, found))
    return found


def _hooks(kind: type) -> Iterator[tuple[str, Any]]:
    for name, hook in inspect.getmembers(kind, inspect.isfunction):
        if "options" in inspect.signature(hook).parameters:
            yield name, hook


def _listening(hook: Any, name: str, rule: str, found: dict[str, set[tuple[str, int]]]) -> Callable[..., Any]:
    signature = inspect.signature(hook)

    def listening(*given: Any, **named: Any) -> Any:
        options = signature.bind(*given, **named).arguments["options"]
        found.setdefault(rule, set()).add((name, getattr(options, "marked", 0)))
        return hook(*given, **named)

    return listening


def strict(profile: Profile) -> Profile:
    """The profile with every rule on, and the added option set."""
    known = profile.known_rules()

    def setting(name: str, before: RuleSetting) -> RuleSetting:
        options = known[name].Options(**{f.name: getattr(before.options, f.name) for f in _own(before.options)})
        if any(f.name == "marked" for f in dataclasses.fields(options)):
            options = replace(options, marked=GIVEN)
        strength = next(s for s in known[name].strengths if s != "off")
        return RuleSetting(strength, 100.0 if strength == "soft" else None, options)

    return replace(profile, rules={name: setting(name, before) for name, before in profile.rules.items()})


def _own(options: Any) -> list[Any]:
    return [f for f in dataclasses.fields(options) if f.name != "marked"]


@pytest.fixture(scope="module")
def planned() -> tuple[CutSequence, str]:
    """Cuts of the plate and their program, under the default profile."""
    profile = load_profile()
    made = solve_and_verify(make_request(facts_of(PLATE, profile), profile), profile, SolveOptions(work=0.5))
    return made.plan.sequence(profile.machine.home), made.program


def test_the_check_judges_every_rule_by_its_options(
    planned: tuple[CutSequence, str], heard: dict[str, set[tuple[str, int]]]
) -> None:
    profile = strict(load_profile())
    heard.clear()
    cuts, program = planned
    check_cuts(PLATE, cuts, profile)
    check_program(PLATE, program, profile)
    assert set(heard) == set(RULES)
    assert _by_others(heard) == []


@pytest.mark.minizinc
@pytest.mark.parametrize("fact", ["parent[j] == i", "level_ahead[i, j]", "in_hull[i, j]", "contains[i, j]"])
def test_the_facts_that_a_model_file_reads_are_measured_by_those_options(
    tmp_path: Path, planned: tuple[CutSequence, str], heard: dict[str, set[tuple[str, int]]], fact: str
) -> None:
    (tmp_path / "plant.mzn").write_text(
        f"% plant: asked\narray[int] of var bool: plant_holds = {FACTS.format(fact)};\n"
    )
    path = tmp_path / "plant.yaml"
    path.write_text("models: plant.mzn\n")
    profile = strict(load_profile(path))
    heard.clear()
    cuts, _ = planned
    rule = profile.rulebook()["plant"]
    assert isinstance(rule, ModelRule)
    rule.violations(PLATE, cuts, profile.settings()["plant"].options)
    assert heard
    assert _by_others(heard) == []


@pytest.mark.minizinc
def test_a_file_in_the_place_of_a_shipped_rule_changes_none_of_that(
    tmp_path: Path, planned: tuple[CutSequence, str], heard: dict[str, set[tuple[str, int]]]
) -> None:
    (tmp_path / "level_ahead.mzn").write_text(
        f"% level-ahead: asked\narray[int] of var bool: level_ahead_holds = {FACTS.format('level_ahead[i, j]')};\n"
    )
    path = tmp_path / "plant.yaml"
    path.write_text("models: level_ahead.mzn\n")
    profile = strict(load_profile(path))
    heard.clear()
    check_cuts(PLATE, planned[0], profile)
    assert "level-ahead" in heard
    assert _by_others(heard) == []


def test_options_that_a_profile_has_not_given_are_heard_of(heard: dict[str, set[tuple[str, int]]]) -> None:
    rule: Rule[Any] = RULES["inner-before-outer"]
    rule.pairs(PLATE, CutSequence(()), rule.Options())
    assert _by_others(heard) == [("inner-before-outer", "pairs")]


def _by_others(heard: dict[str, set[tuple[str, int]]]) -> list[tuple[str, str]]:
    return sorted((rule, hook) for rule, calls in heard.items() for hook, value in calls if value != GIVEN)
