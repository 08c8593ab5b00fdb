"""A rule whose text is a model file in MiniZinc, as a rule like any other."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.minizinc.dzn import Fields, assignments
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, Strength, Violation
from kerfwise.rules.statements import Statement

from .flatten import Flattened, flatten
from .model_file import ModelFile, read_model_file
from .to_statements import NotHeld, Way, Writer

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import LeadOptions
    from kerfwise.encoder.facts.facts import FactOptions, Facts
    from kerfwise.rules.plant import Plant
    from kerfwise.rules.rule import RuleSetting


@dataclass(frozen=True, slots=True)
class ModelOptions:
    """Values that the profile gives the parameters of a model file, by key, as MiniZinc text."""

    given: tuple[tuple[str, str], ...] = ()


class ModelRule(Rule[Any]):
    """The rule in `file`. Where it is named as a rule of the catalogue, it takes that rule's place: `replaces` is it.

    `strength` is the one that the profile gives it: what a breach of a soft rule costs must not be split.
    """

    Options = ModelOptions

    def __init__(self, file: ModelFile, strength: Strength = "hard", rule_id: str | None = None) -> None:
        self.file = file
        self.id = rule_id or file.name
        self.strength = strength
        self.replaces: Rule[Any] | None = RULES.get(self.id)
        self.sentence = file.sentence
        self.source = file.source
        if (base := self.replaces) is not None:
            for mark in (
                "Options",
                "strengths",
                "default",
                "default_weight",
                "gives_way",
                "excusable",
                "relaxable",
                "relaxed_last",
                "hard_with_head_down",
            ):
                setattr(self, mark, getattr(base, mark))

    def statements(self, facts: Facts, options: Any) -> Iterator[Statement]:
        flat = self._flat(facts_data(facts) + assignments(self._data(facts, options)), facts)
        ways = [Way(c.contour, _way_words(c.entry, c.direction)) for c in facts.candidates]
        why = f"{self.sentence.rstrip('.')} ({self.file.place})"
        in_parts = self.strength != "soft" and not self.excusable
        writer = Writer(self.id, facts.nest, ways, why, in_parts)
        says = [f"{text} ({self.file.place})" for text in flat.says]
        if flat.further and not in_parts:
            raise InputError(
                f"rule {self.id}: a constraint is always hard, and the rule is not: write it as an element of "
                f"{self.file.stem}_holds",
                file=self.file.path,
                line=self.file.bare or self.file.line,
            )
        try:
            yield from writer.written(flat.elements, says, flat.further)
        except NotHeld as error:
            element = f"element {error.element} of {self.file.array}: " if error.element else ""
            raise InputError(f"rule {self.id}: {element}{error}", file=self.file.path, line=self.file.line) from None

    def _flat(self, data: str, facts: Facts) -> Flattened:
        return flatten(self.file, data, facts.n, [c.contour for c in facts.candidates])

    def _data(self, facts: Facts, options: Any) -> Fields:
        """What the file reads beside the facts: that of the rule whose place it takes, or its parameters."""
        if self.replaces is not None:
            from kerfwise.rules.minizinc.twin import Case, twin_of

            return twin_of(self.replaces.id).data(Case(facts, (0.0, 0.0)), options)
        return parameters(self.file, options)

    def violations(self, nest: Nest, cuts: CutSequence, options: Any) -> list[Violation]:
        return []

    def unjudged(self, nest: Nest, cuts: CutSequence, options: Any) -> str | None:
        return f"it is written in MiniZinc ({self.file.path.name})"

    def lead_options(self, given: LeadOptions, options: Any, strength: Strength) -> LeadOptions:
        return given if self.replaces is None else self.replaces.lead_options(given, options, strength)

    def fact_options(self, given: FactOptions, options: Any, strength: Strength) -> FactOptions:
        """As the rule whose place it takes, but that zones need not respect the facts of its orders."""
        if self.replaces is None:
            return given
        from dataclasses import replace

        made = self.replaces.fact_options(given, options, strength)
        return replace(made, zone_respects=given.zone_respects)

    def check_with(self, options: Any, plant: Plant, rules: Mapping[str, RuleSetting]) -> Iterable[tuple[str, str]]:
        return () if self.replaces is None else self.replaces.check_with(options, plant, rules)


def read_model_rule(path: Path) -> ModelRule:
    """The rule in a model file.

    Raises
    ------
    InputError
        If the file cannot be read or states nothing; MiniZinc is not asked yet.
    """
    return ModelRule(read_model_file(Path(path)))


def parameters(file: ModelFile, options: ModelOptions) -> Fields:
    """The parameters of a file as data.

    Raises
    ------
    InputError
        If one has neither a value in the profile nor a default.
    """
    given = dict(options.given)
    made: Fields = []
    for parameter in file.parameters:
        value = given.get(parameter.key, parameter.default)
        if value is None:
            raise InputError(
                f"rule {file.name}: the parameter {parameter.key} has no value: give it under rules.{file.name} in the "
                "profile",
                file=file.path,
                line=parameter.line,
            )
        made.append((parameter.name, value))
    return made


_facts: OrderedDict[int, tuple[Any, str]] = OrderedDict()
_MOST_FACTS = 4


def facts_data(facts: Facts) -> str:
    """The facts as MiniZinc data, kept for the last few."""
    from kerfwise.encoder.facts import facts_dzn

    if id(facts) not in _facts:
        _facts[id(facts)] = (facts, facts_dzn(facts))
        if len(_facts) > _MOST_FACTS:
            _facts.popitem(last=False)
    return _facts[id(facts)][1]


def _way_words(entry: tuple[float, float], direction: str) -> str:
    return f"entered at ({entry[0]:.1f}, {entry[1]:.1f}), {direction}"
