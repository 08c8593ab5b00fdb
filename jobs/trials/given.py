"""Which rules are to be tried, as a person names them: files, names, or none for every rule."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.outside import rules_in_file
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleSetting

FILES = (".py", ".mzn")


def rules_to_try(profile: Profile, named: Sequence[str]) -> tuple[Profile, tuple[str, ...]]:
    """The profile with the rules of the files among these words, and the ids of all that are named.

    A file in Python is run: whoever names it here trusts it.

    Raises
    ------
    InputError
        If there is no such rule or file, or its rules cannot be used.
    """
    names: list[str] = []
    for word in named:
        path = Path(word)
        if path.suffix not in FILES:
            if word not in profile.known_rules():
                hint = "" if len(path.parts) < 2 else "; a file of rules ends in .py or .mzn"
                raise InputError(unknown("rule", word, profile.known_rules()) + hint)
            names.append(word)
            continue
        for rule in rules_in_file(path) if path.suffix == ".py" else (read_model_rule(path),):
            profile = _with(profile, rule)
            names.append(rule.id)
    return profile, tuple(dict.fromkeys(names)) or tuple(profile.known_rules())


def _with(profile: Profile, rule: Rule[object]) -> Profile:
    """The profile with one more rule, or with it in the place of the one that has its name."""
    if rule.id in RULES and not isinstance(rule, ModelRule):
        raise InputError(
            f"{rule.brought}: two rules are called {rule.id!r}, the other one of kerfwise itself; choose another name"
        )
    settings = dict(profile.rules) | {rule.id: RuleSetting(rule.strengths[0], None, rule.Options())}
    return replace(profile, further_rules=dict(profile.further_rules) | {rule.id: rule}, rules=settings)
