"""Everything that is tried of one rule, one outcome after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import Case
from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule
from kerfwise.rules.minizinc.installation import driver
from kerfwise.rules.options.option import Option, options_of
from kerfwise.rules.outside import rules_in_file
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleSetting
from kerfwise.rules.run_cases import CaseOutcome, cases_of, error_line, run_cases

from .agreement import (
    Trials,
    compare_engines,
    compare_with_text,
    compare_with_violations,
    drawn_values,
    engines_here,
    idle_options,
    text_of,
    with_option,
)
from .trial import Trial, profile_with_rule_alone, trial_nest, trial_of

SEEDS = (1, 2, 3, 4)
"""Nests of five contours, each cut in one way: every order is tried."""
WAYS_SEEDS = (5, 6)
"""Nests of four contours that are cut in two ways each."""
MOST_OF_CASES = 6
MOST_LINES = 3
ORDERS, TEXT, ENGINES, OPTIONS = (
    "statements and violations admit the same plans",
    "its text in MiniZinc admits the same plans",
    "every engine finds what trying every plan finds",
    "every option does something, to both alike",
)


def try_rule(rule: str, profile: Profile, cases_only: bool = False) -> Iterator[CaseOutcome]:
    """Run the cases of a rule, then hold its halves against each other on every plan of small nests.

    The nests are those of its cases and a few that are made at random, always the same. The profile gives the machine
    and the sheet; of its rules only this one is on.
    """
    known = profile.known_rules()
    yield from run_cases(rule, known)
    if cases_only:
        return
    bench = Bench(known[rule], profile, cases_of(rule, known))
    for what, look in ((ORDERS, bench.orders), (TEXT, bench.text), (ENGINES, bench.engines), (OPTIONS, bench.options)):
        try:
            wrong, note = look()
        except Exception as error:
            wrong, note = (error_line(error),), ""
        yield CaseOutcome(rule, what, wrong, is_case=False, note=note)


Looked = tuple[tuple[str, ...], str]
"""What is wrong, and a note on what could not be tried."""


@dataclass(frozen=True, eq=False)
class Bench:
    """A rule, and the nests that it is tried on."""

    rule: Rule[Any]
    profile: Profile
    cases: Sequence[Case]

    @cached_property
    def trials(self) -> tuple[Trial, ...]:
        """The trials under the rule's own options."""
        return tuple(self.under(profile_with_rule_alone(self.profile, self.rule.id)))

    @cached_property
    def seeded(self) -> Mapping[str, tuple[Nest, int]]:
        """Name → nest made at random, and in how many ways its contours are cut."""
        one = {f"nest {seed}": (trial_nest(seed, 5), 1) for seed in SEEDS}
        return one | {f"nest {seed}": (trial_nest(seed, 4), 2) for seed in WAYS_SEEDS}

    def under(self, profile: Profile) -> Iterator[Trial]:
        """The trials under a profile."""
        nests: dict[int, tuple[str, Nest]] = {}
        for case in self.cases:
            nests.setdefault(id(case.nest), (f"the nest of case {case.name!r}", case.nest))
        for name, nest in list(nests.values())[:MOST_OF_CASES]:
            if (trial := trial_of(name, nest, profile, self.rule.id)) is not None:
                yield trial
        for name, (nest, ways) in self.seeded.items():
            if (trial := trial_of(name, nest, profile, self.rule.id, ways)) is not None:
                yield trial

    def few(self, profile: Profile) -> list[Trial]:
        """A few trials of every sort."""
        found = list(self.under(profile))
        return [*found[:2], *found[-3:-1]] if len(found) > 4 else found

    def orders(self) -> Looked:
        """Statements against violations."""
        if note := self._not_compared():
            return (), note
        judged = [trial for trial in self.trials if trial.unjudged() is None]
        if not judged:
            return ("none of its cases' nests can be cut and judged, nor any of those made at random",), ""
        return _lines(compare_with_violations(judged)), ""

    def text(self) -> Looked:
        """The text in MiniZinc against the statements."""
        if text_of(self.rule) is None:
            return (), "it has none"
        return _lines(compare_with_text(self.few(profile_with_rule_alone(self.profile, self.rule.id)))), ""

    def engines(self) -> Looked:
        """Each engine against trying every plan, the rule hard and soft."""
        if note := self._not_compared():
            return (), note
        minizinc, note = _installed()
        engines = engines_here(minizinc)
        hard = sorted(self.trials, key=lambda trial: -len(trial.plans))[:2]
        soft: list[Trial] = []
        if "soft" in self.rule.strengths:
            soft = list(self.under(profile_with_rule_alone(self.profile, self.rule.id, "soft")))[-1:]
        return _lines(compare_engines([*hard, *soft], engines)), note

    def options(self) -> Looked:
        """Each option: whether it does anything, and whether statements and violations take it alike."""
        if not options_of(self.rule.Options):
            return (), "it has none"
        trials: Trials = self.few
        lines = list(idle_options(self.rule, self.profile, trials, self.cases))
        if self._not_compared():
            return tuple(lines), ""
        for option in options_of(self.rule.Options):
            values = list(drawn_values(self.rule, option, self.profile))[1:]
            for value in values[:1]:
                some = [trial for trial in self._few_with(option, value)[:3] if trial.unjudged() is None]
                lines += self._with(option, value, compare_with_violations(some))
            if text_of(self.rule) is not None:
                value, trial = self._telling(option, values)
                lines += self._with(option, value, compare_with_text(trial))
        return _lines(iter(lines)), ""

    def _few_with(self, option: Option, value: Any) -> list[Trial]:
        return self.few(with_option(self.rule, self.profile, option, value))

    def _telling(self, option: Option, values: Sequence[Any]) -> tuple[Any, list[Trial]]:
        """A value of the option, and a trial whose lawful plans it changes: a text that does not read it differs there.

        Where no value changes any, the first one and its first trial.
        """
        before = {trial.name: trial.admitted_by_statements() for trial in self._few_with(option, option.default)}
        for value in values:
            for trial in self._few_with(option, value):
                if trial.admitted_by_statements() != before.get(trial.name):
                    return value, [trial]
        return (values[0], self._few_with(option, values[0])[:1]) if values else (option.default, [])

    def _with(self, option: Option, value: Any, lines: Iterator[str]) -> list[str]:
        return [f"with {option.key}: {option.kind.write(value)}, {line}" for line in lines]

    def _not_compared(self) -> str:
        """Why plans cannot be compared by what the rule states."""
        if (
            self.rule.temperature_limit(
                profile_with_rule_alone(self.profile, self.rule.id).settings()[self.rule.id].options
            )
            is not None
        ):
            return "not compared: temperatures are simulated, not stated"
        return ""


def _lines(found: Iterator[str]) -> tuple[str, ...]:
    """The first few lines, and how many more there are."""
    lines = list(found)
    more = [f"and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else []
    return (*lines[:MOST_LINES], *more)


def _installed() -> tuple[bool, str]:
    try:
        driver()
    except InputError as error:
        return False, f"without MiniZinc: {error.message}"
    return True, ""


# Which rules are to be tried, as a person names them: files, names, or none for every rule.

FILES = (".py", ".mzn")


def rules_to_try(profile: Profile, named: Sequence[str]) -> tuple[Profile, tuple[str, ...]]:
    """The profile with the rules of the files among these words, and the ids of all that are named.

    A file in Python is run: whoever names it here trusts it. Raises InputError if there is no such rule or file, or its
    rules cannot be used.
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
