"""MiniZinc is told of every option that changes what a rule states: one that it is not told of is named, with its file.

Two values of an option are drawn from what it declares. Where what the rule states differs by them, over the same
facts, so must the model or its data."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np
import pytest

from kerfwise import InputError, Lock, Profile, RulesConflict
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.export import facts_dzn
from kerfwise.encoder.minizinc_data import Fields
from kerfwise.models.engines.minizinc_model import condition_arrays, conditions, data_text, model_text, rules_in_files
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.rule_kit import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Facts,
    Forbid,
    Lag,
    NoGood,
    Pick,
    Precede,
    RuleSetting,
    Statement,
)
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.heat_lag.model_data import HeatLagTwin
from kerfwise.rules.minizinc.twin import TwinCase, rule_file, twin_of
from kerfwise.rules.options.option import Option, options_of
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.stating.state_rules import Stated, state_rules
from kerfwise.tests.drawn_options import contradicts, drawn_value
from kerfwise.tests.models.engines.cases import profile_of, random_nest

EACH = [(name, option) for name, rule in RULES.items() for option in options_of(rule.Options)]
TRIES, TRIES_IN_VAIN = 40, 6
"""Nests that are tried for an option, and for one that none of them is known to show."""
ENOUGH = 2
"""Nests that show an option."""
STATE_NOTHING = {"no-narrow-strips", "t-max"}
"""Rules whose options are looked at by geometry or by simulation alone, once there is an order."""
NOT_SHOWN = {
    ("hold-small-parts", "count"): "a torch of plasma leaves one tab, where its cut ends",
    ("hold-small-parts", "slats"): "all parts of these nests are short both ways",
    ("locks", "entry_tolerance"): "the locked point is among the entries, and no other is so near",
    ("start-side", "long_ratio"): "no part of these nests is so long",
    ("zone-order", "square_ratio"): "so few parts make the same zones; every engine gets them from the facts",
}
"""Options that these nests do not show."""


@pytest.mark.slow
@pytest.mark.parametrize(("rule", "option"), EACH, ids=[f"{rule}-{option.key}" for rule, option in EACH])
def test_minizinc_is_told(rule: str, option: Option) -> None:
    seen = untold(rule, option)
    file = f"rules/catalogue/{rule.replace('-', '_')}/model_data.py (or the .mzn beside it)"
    assert not [told for told in seen if told is False], f"{rule}: {option.key} changes nothing in MiniZinc: {file}"
    assert seen or rule in STATE_NOTHING or (rule, option.key) in NOT_SHOWN, (
        f"no nest shows what {rule}: {option.key} changes: does statements() in rules/catalogue read it?"
    )


def test_an_option_that_minizinc_ignores_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    (option,) = (o for o in options_of(HeatLagOptions) if o.key == "lag_cuts")
    rightly = HeatLagTwin.data

    def ignoring(self: HeatLagTwin, case: TwinCase, options: HeatLagOptions) -> Fields:
        return rightly(self, case, replace(options, lag_cuts=1))

    monkeypatch.setattr(HeatLagTwin, "data", ignoring)
    assert type(twin_of("heat-lag")) is HeatLagTwin
    assert False in untold("heat-lag", option)


def untold(rule: str, option: Option) -> list[bool]:
    """For each try in which the option changes facts or statements, whether it changes what MiniZinc is given."""
    seen: list[bool] = []
    in_vain = 1 if rule in STATE_NOTHING else TRIES_IN_VAIN
    for seed in range(in_vain if rule in STATE_NOTHING or (rule, option.key) in NOT_SHOWN else TRIES):
        rng = np.random.default_rng([seed, 7])
        nest = random_nest(rng, 8)
        base = alone(rule, nest.contours[-1].id)
        profiles = []
        for value in two_values(option, rng):
            options = replace(base.rules[rule].options, **{option.name: value})
            rules = dict(base.rules) | {rule: replace(base.rules[rule], options=options)}
            if not contradicts(rule, base, rules):
                profiles.append(replace(base, rules=rules))
        try:
            given = [(profile, facts_under(profile, nest)) for profile in profiles]
            one, *others = [(said(f, p, rule), facts_dzn(f), text(f, p)) for p, f in given]
        except (InputError, RulesConflict, ValueError):
            continue
        for other in others:
            if one[:2] != other[:2]:
                seen.append(one[2] != other[2])
        if len(seen) >= ENOUGH:
            break
    return seen


def two_values(option: Option, rng: np.random.Generator) -> tuple[object, object]:
    """Two different values of an option."""
    one = other = drawn_value(option, rng)
    while one == other:
        other = drawn_value(option, rng)
    return one, other


def alone(rule: str, locked: str) -> Profile:
    """The default profile with this rule as hard as may be, and no other; one contour is locked to an entry."""
    base = load_profile()
    rules = {}
    for name, setting in base.rules.items():
        never_off = name in RULES and "off" not in RULES[name].strengths  # an installed package's rule can be off
        strongest = "hard" if name == rule or never_off else "off"
        rules[name] = RuleSetting(strongest, None, setting.options)  # type: ignore[arg-type]
    if rule == "zone-order":
        rules[rule] = replace(rules[rule], options=replace(rules[rule].options, zone_contours=2))
    locks = (Lock(contour=locked, entry=(60.0, 60.0)),) if rule == "locks" else ()
    return replace(base, rules=rules, leads=replace(base.leads, entries=3), locks=locks)


def facts_under(profile: Profile, nest: object) -> Facts:
    candidates = build_candidates(nest, profile.lead_options())  # type: ignore[arg-type]
    heat_kj = contour_heat_kj(nest, candidates, profile)  # type: ignore[arg-type]
    return compute_facts(nest, profile.fact_options(nest), candidates, heat_kj)  # type: ignore[arg-type]


def said(facts: Facts, profile: Profile, rule: str) -> list[str]:
    """What the rule states, sentences left out."""
    found = state_rules(facts, profile).statements
    return [repr(list(_values(s))) for s in found if s.about.rule == rule]


def _values(statement: object) -> Iterator[object]:
    yield type(statement).__name__
    for field in fields(statement):  # type: ignore[arg-type]
        if field.name != "about":
            yield getattr(statement, field.name)


def text(facts: Facts, profile: Profile) -> str:
    """What MiniZinc is given: the model, and its data."""
    stated = state_rules(facts, profile)
    arrays = condition_arrays(profile, stated)
    in_files = rules_in_files(profile, stated)
    options = SolveOptions(home_mm=profile.machine.home, feeds=feeds_of(profile))
    data = data_text(facts, profile, stated, options, clock=any(a.most_ms for a in arrays))
    return "\n".join([*in_files, model_text(arrays), data])


AFTERWARDS = {"no-narrow-strips", "t-max"}
"""Rules that state nothing beforehand: geometry, or a simulation, adds to a finished order what they ask."""
ABOUT = About("own:mine", (), "")


def test_every_rule_has_its_file() -> None:
    assert {rule for rule in RULES if not rule_file(rule).exists()} == AFTERWARDS


@pytest.mark.parametrize("rule", sorted(set(RULES) - AFTERWARDS))
def test_a_file_names_its_rule_its_statements_and_every_parameter(rule: str) -> None:
    text = rule_file(rule).read_text(encoding="utf-8")
    name = rule.replace("-", "_")
    assert text.startswith(f"% {rule}: ")
    assert re.search(rf"^array\[int\] of var bool: {name}_holds =", text, re.MULTILINE)
    parameters = re.findall(r"^(?:int|bool|array\[[^\n]*?\] of|set of)[^%=\n]*;.*$", text, re.MULTILINE)
    assert [line for line in parameters if "%" not in line] == []


def test_strengths_become_constraints_and_prices() -> None:
    profile = profile_of(2)
    text = model_text(condition_arrays(profile, Stated((), ())))
    for rule, setting in profile.rules.items():
        name = f"{rule.replace('-', '_')}_holds"
        if setting.strength == "off" or rule in AFTERWARDS:
            assert f"{name})" not in text
        elif setting.weight is not None:
            assert f"{round(setting.weight * 1000)} * breaches({name})" in text
        elif rule != "part-rigidity":
            assert f"constraint forall({name});" in text


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (Precede(0, 4, ABOUT), ["before(1, 5)"]),
        (Forbid(2, ABOUT), ["not picked(3)"]),
        (
            AtLeast((Before(0, 1), Pick(4)), (2, -1), 1, ABOUT, when=3),
            ["picked(4) -> 2 * bool2int(before(1, 2)) + -1 * bool2int(picked(5)) >= 1"],
        ),
        (AtLeast((), (), 0, ABOUT), ["0 >= 0"]),
        (
            Contiguous((0, 1), ABOUT),
            [
                "forall(j in {2})(before(1, j)) \\/ exists(j in {2})(directly_before(j, 1))",
                "forall(j in {1})(before(2, j)) \\/ exists(j in {1})(directly_before(j, 2))",
            ],
        ),
        (Lag(0, 1, ABOUT, cuts=2), ["cuts_between(1, 2) >= 1", "cuts_between(1, 2) >= 2"]),
        (NoGood(frozenset({0}), frozenset({2, 1}), ABOUT), ["exists(i in {2, 3}, j in {1})(before(i, j))"]),
    ],
    ids=lambda value: type(value).__name__,
)
def test_statements_in_words(statement: Statement, words: list[str]) -> None:
    assert conditions(statement) == words
