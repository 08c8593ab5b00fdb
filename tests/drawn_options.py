"""Options drawn at random from what they declare: kind, bounds and default. A new option is drawn by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kerfwise.rules.options.kind import Kind, Unfit
from kerfwise.rules.options.option import Option, options_of
from kerfwise.rules.options.plain_values import Choice, Flag, Number
from kerfwise.rules.options.quantities import OrWord, Quantity
from kerfwise.rules.options.yaml_positions import compose
from kerfwise.rules.profile.filling import filled_in
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import RuleSetting

USUAL = {"mm": 25.0, "s": 8.0, "kJ": 30.0, "°C": 115.0}
"""A value of each unit, for options whose default is nothing."""
FACTORS = (0.2, 0.5, 1.0, 1.7, 3.0)
TRIES = 100


def drawn_value(option: Option, rng: np.random.Generator) -> Any:
    """A valid value of an option, the same for the same state of `rng`."""
    for _ in range(TRIES):
        value = _of_kind(option.kind, option.default, rng)
        try:
            return _read(option.kind, value)
        except Unfit:
            continue
    raise AssertionError(f"nothing valid was drawn for {option.name}: {option.kind.expected()}")


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
    options = filled_in(rules[rule].options, profile.plant, rules)
    return bool(list(RULES[rule].check_with(options, profile.plant, rules)))


def _read(kind: Kind, value: Any) -> Any:
    node = compose(kind.write(value), "drawn")
    assert node is not None
    return kind.read(node)


def _of_kind(kind: Kind, default: Any, rng: np.random.Generator) -> Any:
    match kind:
        case Flag():
            return bool(rng.random() < 0.5)
        case Choice(words=words, none=none):
            word = str(rng.choice(words))
            return None if word == none else word
        case OrWord(quantity=quantity):
            return None if rng.random() < 0.3 else _of_kind(quantity, default, rng)
        case Quantity():
            usual = default if isinstance(default, float) and default else USUAL[kind.bare]
            return 0.0 if rng.random() < 0.1 else round(usual * float(rng.choice(FACTORS)), 3)
        case Number(at_least=low, at_most=high, whole=whole):
            low = 0.0 if low is None else low
            if whole and high is None:  # small counts tell most, on small nests
                return int(low) + int(rng.choice([0, 1, 2, 3, 7]))
            high = low + 4 * max(1.0, abs(float(default or 1))) if high is None else high
            return int(rng.integers(int(low), int(high) + 1)) if whole else round(float(rng.uniform(low, high)), 2)
        case _:
            raise AssertionError(f"say in tests/drawn_options.py how an option of kind {type(kind).__name__} is drawn")
