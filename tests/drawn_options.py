"""Options drawn at random from what they declare: kind, bounds and default. A new option is drawn by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kerfwise import Profile
from kerfwise.apps.authoring.trials.agreement import TRIES, drawn_value
from kerfwise.rule_kit import RuleSetting
from kerfwise.rules.options.option import options_of
from kerfwise.rules.profile.active_rules import resolve_defaults
from kerfwise.rules.registry import RULES


def drawn_options(rule: str, base: Any, rng: np.random.Generator) -> Any:
    """The options of a rule with a value drawn for each that a profile can set."""
    return replace(base, **{option.name: drawn_value(option, rng) for option in options_of(RULES[rule].Options)})


def with_drawn_options(profile: Profile, rng: np.random.Generator) -> Profile:
    """The profile with options drawn for every rule, none of which contradicts the rest of the profile."""
    rules: dict[str, RuleSetting] = dict(profile.rules)
    for name in RULES:
        for _ in range(TRIES):
            rules[name] = replace(rules[name], options=drawn_options(name, rules[name].options, rng))
            if not contradicts(name, profile, rules):
                break
        else:
            raise AssertionError(f"whatever is drawn for {name} contradicts the profile")
    return replace(profile, rules=rules)


def contradicts(rule: str, profile: Profile, rules: Mapping[str, RuleSetting]) -> bool:
    """Whether the options of a rule contradict the rest of the profile."""
    if rules[rule].strength == "off":
        return False
    options = resolve_defaults(rules[rule].options, profile.plant, rules)
    return bool(list(RULES[rule].check_with(options, profile.plant, rules)))
