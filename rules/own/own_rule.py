"""A rule of the plant's own: a name, a reason, which contours it is about, and what it asks of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.expression.node import Gate
from kerfwise.rules.expression.over_cuts import breaches, sums_of_ids
from kerfwise.rules.expression.to_statements import statement_of
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.yaml_positions import Place as FilePlace
from kerfwise.rules.rule import USUAL, Plate, Rule, Strength, SumOfIds, Violation
from kerfwise.rules.statements import About, Statement

from .demands import DEMANDS, Chosen, Demand
from .known_nest import KnownNest, MeasuredNest, PlannedNest
from .selector import Selector, groups

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

PREFIX = "own:"
"""What the id of every own rule begins with."""


@dataclass(frozen=True, slots=True)
class OwnRule:
    """One entry of a profile's `own_rules`; `weight` (mm of idle travel) only where it is soft."""

    name: str
    ask: Demand
    select: Selector = field(default_factory=Selector)
    scope: str = "sheet"
    why: str = "a rule of the plant's own"
    strength: Strength = "hard"
    weight: float | None = None
    place: FilePlace | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """What plans and checks call it."""
        return PREFIX + self.name

    def facts(self) -> set[str]:
        """Names of the facts that it looks at."""
        reach = {self.scope} - {"sheet"}
        return set().union(reach, self.select.names(), self.ask.facts(), *(s.names() for s in self.ask.selectors()))

    def chosen(self, known: KnownNest) -> Chosen:
        """Which contours it is about on one nest."""
        selected = set(self.select.chosen(known))
        parted = ((tuple(k for k in group if k in selected), group) for group in groups(known, self.scope))
        return Chosen(self.id, known, tuple((own, group) for own, group in parted if own))

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this rule."""
        key = self.ask.key
        result: dict[str, object] = {"name": self.name, "why": self.why, "strength": self.strength}
        if self.weight is not None:
            result["weight"] = LENGTH.write(self.weight)
        return result | {"select": self.select.plain(), key: DEMANDS[key][0].plain(self.ask.value), "scope": self.scope}


@dataclass(frozen=True, slots=True)
class OwnFile:
    """An entry `{file: rule.mzn}`: a rule in MiniZinc, which `rules/flat` reads.

    `parameters` are those of the file that the entry sets, by key.
    """

    file: str
    name: str
    why: str = "a rule of the plant's own, in MiniZinc"
    strength: Strength = "hard"
    weight: float | None = None
    parameters: tuple[tuple[str, int | bool | str], ...] = ()
    place: FilePlace | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """What plans and checks call it."""
        return PREFIX + self.name

    def with_parameters(self, values: Mapping[str, int | bool | str]) -> OwnFile:
        """The same entry with these parameters and no others."""
        return replace(self, parameters=tuple(values.items()))

    @property
    def path(self) -> Path:
        """The file, looked up beside the profile that names it."""
        return Path(self.place.file).parent / self.file if self.place else Path(self.file)

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this entry."""
        result: dict[str, object] = {"file": self.file, "name": self.name, "why": self.why, "strength": self.strength}
        if self.weight is not None:
            result["weight"] = LENGTH.write(self.weight)
        return result | {"parameters": dict(self.parameters)} if self.parameters else result


Own = OwnRule | OwnFile


# An own rule as a rule like any other: what it states over facts, and how it is judged by geometry.


@dataclass(frozen=True, slots=True)
class Thresholds:
    """What the facts `long` and `neighbours_count` hang on, and what a rule may read of the profile."""

    long_ratio: float = 4.0
    web_mm: float = 25.0
    plate: Plate = USUAL


class PlantRule(Rule[Thresholds]):
    """One entry of `own_rules`, stated and judged like a rule of the catalogue. It gives way to none."""

    Options = Thresholds
    of_whole_nest = True

    def __init__(self, rule: OwnRule) -> None:
        self.rule, self.id, self.sentence = rule, rule.id, rule.why
        self.source = "the plant"
        self.minds_what_is_out = rule.ask.MINDS_WHAT_IS_OUT

    def statements(self, facts: Facts, options: Thresholds) -> Iterator[Statement]:
        contours, chosen = facts.nest.contours, self.rule.chosen(PlannedNest(facts, options.plate))
        for condition in self.rule.ask.conditions(chosen):
            ids = tuple(contours[k].id for k in condition.contours)
            yield statement_of(condition.asked, About(self.id, ids, f"{condition.sentence}: {self.rule.why}"))

    def violations(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[Violation]:
        if self.unjudged(nest, cuts, options) is not None:
            return []
        asked = self.rule.ask.conditions(self._chosen(nest, cuts, options))
        return [
            Violation(self.id, contours, f"{text}: {self.rule.why}", positions)
            for contours, text, positions in breaches(asked, nest, cuts)
        ]

    def pairs(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[Ids]:
        contours = nest.contours
        found = self.rule.ask.pairs(self._chosen(nest, cuts, options))
        return [(contours[a].id, contours[b].id) for a, b in found]

    def sums(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[SumOfIds]:
        if self.unjudged(nest, cuts, options) is not None:
            return []
        asked = self.rule.ask.conditions(self._chosen(nest, cuts, options))
        return sums_of_ids(nest, (of.asked for of in asked if isinstance(of.asked, Gate)))

    def together(self, nest: Nest, options: Thresholds) -> list[tuple[str, ...]]:
        if "zone" in self.rule.facts():
            return []
        chosen = self._chosen(nest, None, options)
        return [chosen.ids(*run) for run in self.rule.ask.together(chosen)]

    def unjudged(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> str | None:
        if "zone" in self.rule.facts() and not any(cut.zone for cut in cuts):
            return "the zones of the cuts are not stated"
        return self.selects_nothing(nest, cuts, options) or self.rule.ask.unjudged(cuts)

    def selects_nothing(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> str | None:
        known = self._known(nest, cuts, options)
        for selector in (self.rule.select, *self.rule.ask.selectors()):
            if not selector.chosen(known):
                return f"it selects no contour of this nest: {selector.why_nothing(known)}"
        if not self.rule.chosen(known).groups:
            return f"it selects no contour of this nest within {self.rule.scope}"
        return None

    def _chosen(self, nest: Nest, cuts: CutSequence | None, options: Thresholds) -> Chosen:
        return self.rule.chosen(self._known(nest, cuts, options))

    def _known(self, nest: Nest, cuts: CutSequence | None, options: Thresholds) -> KnownNest:
        return MeasuredNest(nest, cuts, options.long_ratio, options.web_mm, options.plate)


def as_rule(own: OwnRule) -> PlantRule:
    """The rule that an entry of `own_rules` in YAML makes."""
    return PlantRule(own)


def own_pairs(rules: tuple[Own, ...], nest: Nest, thresholds: Thresholds) -> tuple[Ids, ...]:
    """Contour ids (before, after) that hard own rules order, but for rules about zones: no zone may
    contradict them."""
    known = MeasuredNest(nest, None, thresholds.long_ratio, thresholds.web_mm, thresholds.plate)
    contours = nest.contours
    return tuple(
        (contours[a].id, contours[b].id)
        for rule in rules
        if isinstance(rule, OwnRule) and rule.strength == "hard" and "zone" not in rule.facts()
        for a, b in rule.ask.pairs(rule.chosen(known))
    )
