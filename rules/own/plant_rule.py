"""An own rule as a rule like any other: what it states over facts, and how it is judged by geometry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.rule import Ids, Rule, Violation
from kerfwise.rules.statements import Statement

from .demand import Chosen
from .measures import measured
from .named_facts import known_of_facts, known_of_nest
from .own_rule import Own, OwnRule

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class Thresholds:
    """What the facts `long` and `neighbours_count` hang on."""

    long_ratio: float = 4.0
    web_mm: float = 25.0


class PlantRule(Rule[Thresholds]):
    """One entry of `own_rules`, stated and judged like a rule of the catalogue. It gives way to none."""

    Options = Thresholds
    of_whole_nest = True

    def __init__(self, rule: OwnRule) -> None:
        self.rule, self.id, self.sentence = rule, rule.id, rule.why
        self.source = "the plant"
        self.minds_what_is_out = rule.ask.MINDS_WHAT_IS_OUT

    def statements(self, facts: Facts, options: Thresholds) -> Iterator[Statement]:
        yield from self.rule.ask.statements(facts, self.rule.chosen(known_of_facts(facts)))

    def violations(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[Violation]:
        if self.unjudged(nest, cuts, options) is not None:
            return []
        return [
            Violation(self.id, contours, f"{text}: {self.rule.why}", positions)
            for contours, text, positions in self.rule.ask.broken(cuts, self._chosen(nest, cuts, options))
        ]

    def pairs(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[Ids]:
        contours = nest.contours
        found = self.rule.ask.pairs(self._chosen(nest, cuts, options))
        return [(contours[a].id, contours[b].id) for a, b in found]

    def together(self, nest: Nest, options: Thresholds) -> list[tuple[str, ...]]:
        if "zone" in self.rule.facts():
            return []
        chosen = self._chosen(nest, None, options)
        return [chosen.ids(*run) for run in self.rule.ask.together(chosen)]

    def unjudged(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> str | None:
        if "zone" in self.rule.facts() and not any(cut.zone for cut in cuts):
            return "the zones of the cuts are not stated"
        if not self._chosen(nest, cuts, options).groups:
            return "it selects no contour of this nest"
        return self.rule.ask.unjudged(cuts)

    def _chosen(self, nest: Nest, cuts: CutSequence | None, options: Thresholds) -> Chosen:
        return self.rule.chosen(known_of_nest(measured(nest, cuts, options.long_ratio, options.web_mm)))


def as_rule(own: OwnRule) -> PlantRule:
    """The rule that an entry of `own_rules` in YAML makes."""
    return PlantRule(own)


def own_pairs(rules: tuple[Own, ...], nest: Nest, thresholds: Thresholds) -> tuple[Ids, ...]:
    """Contour ids (before, after) that hard own rules order, but for rules about zones: no zone may
    contradict them."""
    known = known_of_nest(measured(nest, None, thresholds.long_ratio, thresholds.web_mm))
    contours = nest.contours
    return tuple(
        (contours[a].id, contours[b].id)
        for rule in rules
        if isinstance(rule, OwnRule) and rule.strength == "hard" and "zone" not in rule.facts()
        for a, b in rule.ask.pairs(rule.chosen(known))
    )
