"""Whether each option of a rule does something, and the same to what is stated as to what is judged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from kerfwise.encoder.candidates import LeadOptions
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts import FactOptions
from kerfwise.rules.case import Case
from kerfwise.rules.options.drawn import Undrawn, drawn_value
from kerfwise.rules.options.option import Option, options_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import Statement

from .trial import Trial, alone

DRAWS = 8
PLANS = 12
"""Plans of a trial in which it is looked whether an option changes what is blamed."""

Trials = Callable[[Profile], Sequence[Trial]]
"""Makes the same trials under a profile."""


def idle_options(rule: Rule[Any], profile: Profile, trials: Trials, cases: Sequence[Case]) -> Iterator[str]:
    """A line for each option that changes nothing, whatever its value: neither what is stated nor what is blamed."""
    for option in options_of(rule.Options):
        if option.name in rule.shares:
            continue
        values, seen = list(drawn_values(rule, option, profile)), set()
        for value in values:
            seen.add(_effect(rule, _with(profile, rule, option, value), trials, cases, option, value))
            if len(seen) > 1:
                break
        if len(values) > 1 and len(seen) == 1:
            tried = ", ".join(option.kind.write(value) for value in values)
            yield f"option {option.key} does nothing: the rule states and blames the same under {tried}"


def drawn_values(rule: Rule[Any], option: Option, profile: Profile) -> Iterator[Any]:
    """Different values of an option that do not contradict the rest of the profile, the default first."""
    rng = np.random.default_rng(sum(map(ord, option.key)))
    seen: list[Any] = []
    for k in range(DRAWS):
        try:
            value = option.default if k == 0 else drawn_value(option, rng)
        except Undrawn:
            return
        if value not in seen and not contradicts(rule, _with(profile, rule, option, value)):
            seen.append(value)
            yield value


def contradicts(rule: Rule[Any], profile: Profile) -> bool:
    """Whether the options of the rule contradict the rest of the profile."""
    return bool(list(rule.check_with(profile.settings()[rule.id].options, profile.plant, profile.rules)))


def with_option(rule: Rule[Any], profile: Profile, option: Option, value: Any) -> Profile:
    """The profile of a trial with an option set."""
    return _with(profile, rule, option, value)


def _with(profile: Profile, rule: Rule[Any], option: Option, value: Any) -> Profile:
    return alone(profile, rule.id, **{option.name: value})


def _effect(
    rule: Rule[Any], profile: Profile, trials: Trials, cases: Sequence[Case], option: Option, value: Any
) -> str:
    """All that the rule says under a profile, but for its sentences."""
    options = profile.settings()[rule.id].options
    said: list[object] = [
        rule.fact_options(FactOptions(), options, "hard"),
        rule.lead_options(LeadOptions(), options, "hard"),
        rule.temperature_limit(options),
    ]
    for case in cases:
        given = replace(case.options or options, **{option.name: value})
        said.append([(v.contours, v.cuts) for v in rule.violations(case.nest, case.cuts, given)])
    for trial in trials(profile):
        try:
            said.append([_bare(s) for s in rule.statements(trial.facts, options)])
        except RulesConflict as conflict:
            said.append(str(conflict))
        names = [contour.id for contour in trial.nest.contours]
        said.append(rule.no_goods(trial.nest, names, options) != [])
        some = trial.plans[:: max(1, len(trial.plans) // PLANS)]
        said += [[(v.contours, v.cuts) for v in broken] for broken in trial.violations(some, options)]
    return repr(said)


def _bare(statement: Statement) -> tuple[object, ...]:
    values = (getattr(statement, f.name) for f in fields(statement) if f.name != "about")
    return type(statement).__name__, *values
