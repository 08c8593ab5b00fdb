"""Everything that is tried of one rule, one outcome after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.minizinc.installation import driver
from kerfwise.rules.case import Case
from kerfwise.rules.options.option import options_of
from kerfwise.rules.outcome import CaseOutcome
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Rule
from kerfwise.rules.run_cases import cases_of, run_cases, told

from .agree import against_text, against_violations
from .nests import trial_nest
from .optima import against_engines, engines_here
from .options import Trials, drawn_values, idle_options, with_option
from .text import text_of
from .trial import Trial, alone, trial_of

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
            wrong, note = (told(error),), ""
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
        return tuple(self.under(alone(self.profile, self.rule.id)))

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
        return _lines(against_violations(judged)), ""

    def text(self) -> Looked:
        """The text in MiniZinc against the statements."""
        if text_of(self.rule) is None:
            return (), "it has none"
        return _lines(against_text(self.few(alone(self.profile, self.rule.id)))), ""

    def engines(self) -> Looked:
        """Each engine against trying every plan, the rule hard and soft."""
        if note := self._not_compared():
            return (), note
        minizinc, note = _installed()
        engines = engines_here(minizinc)
        hard = sorted(self.trials, key=lambda trial: -len(trial.plans))[:2]
        soft: list[Trial] = []
        if "soft" in self.rule.strengths:
            soft = list(self.under(alone(self.profile, self.rule.id, "soft")))[-1:]
        return _lines(against_engines([*hard, *soft], engines)), note

    def options(self) -> Looked:
        """Each option: whether it does anything, and whether statements and violations take it alike."""
        if not options_of(self.rule.Options):
            return (), "it has none"
        trials: Trials = self.few
        lines = list(idle_options(self.rule, self.profile, trials, self.cases))
        if self._not_compared():
            return tuple(lines), ""
        for option in options_of(self.rule.Options):
            for value in list(drawn_values(self.rule, option, self.profile))[1:2]:
                under = with_option(self.rule, self.profile, option, value)
                some = [trial for trial in self.few(under)[:3] if trial.unjudged() is None]
                where = f"with {option.key}: {option.kind.write(value)}, "
                lines += [where + line for line in against_violations(some)]
                if text_of(self.rule) is not None:
                    lines += [where + line for line in against_text(some[:1])]
        return _lines(iter(lines)), ""

    def _not_compared(self) -> str:
        """Why plans cannot be compared by what the rule states."""
        if self.rule.temperature_limit(alone(self.profile, self.rule.id).settings()[self.rule.id].options) is not None:
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
