"""A profile with one rule switched on or off: what that rule costs is seen by planning with it and without."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.rule import Rule, RuleSetting, Strength

from .checks import at_odds

if TYPE_CHECKING:
    from .profile import Profile


def with_rule(profile: Profile, name: str, strength: Strength | None = None) -> Profile:
    """The profile with a rule on: as strong as is said, else as it was, else as it is by default, else hard.

    Its sha256 is another, for it is not the profile of the file any more.

    Raises
    ------
    InputError
        For a rule that there is not, with the nearest name, a strength that it cannot have, or options of the rule that
        contradict the rest of the profile.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> without_rule(load_profile(), "level-ahead").rules["level-ahead"].strength
    'off'
    """
    book = profile.rulebook()
    _expect_known(profile, name)
    rule = book[name]
    now = profile.settings()[name].strength if name in profile.settings() else "off"
    chosen = strength or (now if now != "off" else _usual(rule))
    if chosen not in rule.strengths:
        raise InputError(f"rule {name} cannot be {chosen}: it can be {', '.join(rule.strengths)}")
    changed = _with_strength(profile, name, chosen)
    found = at_odds(changed.plant, changed.rules, changed.known_rules())
    wrong = [f"rules.{name}.{key}: {text}" for of, key, text in found if of == name]
    if wrong:
        raise InputError("; ".join(wrong))
    return changed


def without_rule(profile: Profile, name: str) -> Profile:
    """The profile with a rule off; see `with_rule`."""
    return with_rule(profile, name, "off")


def _expect_known(profile: Profile, name: str) -> None:
    known = profile.rulebook()
    if name not in known:
        raise InputError(unknown("rule", name, known))


def _usual(rule: Rule[Any]) -> Strength:
    if rule.default != "off":
        return rule.default
    return "hard" if "hard" in rule.strengths else "soft"


def _with_strength(profile: Profile, name: str, strength: Strength) -> Profile:
    sha256 = hashlib.sha256(f"{profile.sha256}\n{name} {strength}".encode()).hexdigest()
    if name not in profile.rules:
        own = tuple(_own(rule, strength) if rule.id == name else rule for rule in profile.own_rules)
        return replace(profile, own_rules=own, sha256=sha256)
    before = profile.rules[name]
    weight = None
    if strength == "soft":
        weight = profile.known_rules()[name].default_weight if before.weight is None else before.weight
    rules = {**profile.rules, name: RuleSetting(strength, weight, before.options)}
    return replace(profile, rules=rules, sha256=sha256)


def _own(rule: Any, strength: Strength) -> Any:
    weight = None
    if strength == "soft":
        weight = Rule.default_weight if rule.weight is None else rule.weight
    return replace(rule, strength=strength, weight=weight)
