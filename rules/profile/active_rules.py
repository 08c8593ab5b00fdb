"""The rules of a profile that are on: their options as they are for the sheet, and what they say of leads and heat."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import Thicknesses, ThicknessTable
from kerfwise.rules.own import Own, OwnFile, Thresholds, as_rule
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Plant, Rule, RuleFile, Strength, TemperatureLimit

from .sections import RuleSetting
from .values import ProfileValues

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from kerfwise.rules.flat.model_rule import ModelRule


@dataclass(frozen=True)
class ActiveRules(ProfileValues):
    """A profile's values with the rules that they switch on: see `Profile`."""

    def settings(self) -> dict[str, RuleSetting]:
        """The rules that are on, by id, with what their options take from the rest of the profile.

        A machine that travels with its head down makes some soft rules hard.
        """
        return dict(self._settings)

    @cached_property
    def _settings(self) -> Mapping[str, RuleSetting]:
        on = {name: setting for name, setting in self.rules.items() if setting.strength != "off"}
        if self.machine.head == "down":
            known = self.known_rules()
            stricter = (name for name in on if known[name].hard_with_head_down)
            on |= {name: RuleSetting("hard", None, on[name].options) for name in stricter}
        listed = {name: replace(setting, options=self._filled_in(setting.options)) for name, setting in on.items()}
        own = (rule for rule in self.own_rules if rule.strength != "off")
        return listed | {rule.id: RuleSetting(rule.strength, rule.weight, self._options_of(rule)) for rule in own}

    def _options_of(self, rule: Own) -> Any:
        return options_of_own(rule) if isinstance(rule, OwnFile) else self._thresholds()

    def rulebook(self) -> dict[str, Rule[Any]]:
        """Every rule by id: those that `rules` has settings of, then the plant's own in YAML."""
        settings, known = self.settings(), self.known_rules()
        for name, rule in self._in_model_files(self.further_rules):
            known[name] = rule.with_strength(settings[name].strength if name in settings else "off")
        return {**known, **{rule.id: own_model_rule(rule) for rule in self.own_rules}}

    def model_rules(self) -> list[ModelRule]:
        """The rules that are on and stand in model files, which need MiniZinc."""
        on, book = self.settings(), self.rulebook()
        brought = {name: rule for name, rule in book.items() if name in on and rule is not RULES.get(name)}
        return [rule for _, rule in self._in_model_files(brought)]

    @staticmethod
    def _in_model_files(rules: Mapping[str, Rule[Any]]) -> Iterator[tuple[str, ModelRule]]:
        """Those of some rules that stand in model files; what these take is loaded where there are rules."""
        if rules:
            from kerfwise.rules.flat.model_rule import ModelRule

            yield from ((name, rule) for name, rule in rules.items() if isinstance(rule, ModelRule))

    def rule_files(self) -> dict[str, RuleFile]:
        """Rule id → file, of the rules that are on and stand in a file of the plant, in Python or MiniZinc."""
        on, book = self.settings(), self.rulebook()
        return {name: file for name, rule in book.items() if name in on and (file := rule.stands_in) is not None}

    def known_rules(self) -> dict[str, Rule[Any]]:
        """Every rule that `rules` has a setting of, by id: those of the catalogue, and those from outside."""
        return {**RULES, **self.further_rules}

    def temperature_limit(self) -> TemperatureLimit | None:
        """The lowest limit that a rule which is on puts on the temperature of metal; None where none does."""
        book = self.rulebook()
        limits = (book[name].temperature_limit(setting.options) for name, setting in self.settings().items())
        return min((limit for limit in limits if limit is not None), key=lambda limit: limit.most_c, default=None)

    def _filled_in(self, options: T) -> T:
        return resolve_defaults(options, self.plant, self.rules, self.known_rules())

    @cached_property
    def _every_rule(self) -> Sequence[tuple[Rule[Any], Any, Strength]]:
        """Each rule with its options and strength; those from outside only if they are on."""
        return [
            (rule, self._filled_in(self.rules[name].options), self.rules[name].strength)
            for name, rule in self.known_rules().items()
            if name in RULES or self.rules[name].strength != "off"
        ]

    def _thresholds(self) -> Thresholds:
        return self._filled_in(Thresholds())


def options_of_own(own: OwnFile) -> Any:
    """The options of the rule that an entry's file makes, with the parameters that the entry sets."""
    options_type, parameters = own_model_rule(own).Options, dict(own.parameters)
    return options_type(**{o.name: parameters[o.key] for o in options_of(options_type) if o.key in parameters})


def own_model_rule(own: Own) -> Rule[Any]:
    """The rule that an entry of `own_rules` makes: one in a file is a model rule like those of `models`."""
    if isinstance(own, OwnFile):
        from kerfwise.rules.flat.model_rule import read_model_rule

        return read_model_rule(own.path, rule_id=own.id, sentence=own.why).with_strength(own.strength)
    return as_rule(own)


# A rule's options as they are for the sheet: with what the rest of the profile, and other rules, fill in.

T = TypeVar("T", bound="DataclassInstance")
ORDERS_BY = "orders_by"
"""The field of rules in model files that takes the options of the rules whose pairs are facts."""


def resolve_defaults(
    options: T, plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]] = RULES
) -> T:
    """The options with the fields that no key of their own sets, and lengths as they are for the sheet's thickness.

    `known` are the rules that `rules` has settings of.

    Raises KeyError if neither `Plant` nor an option that a rule shares has the name of such a field: the rule's author
    is wrong.
    """
    fields = dataclasses.fields(options)
    values = {f.name: getattr(options, f.name) for f in fields}
    lengths = {n: v.at(plant.thickness_mm) for n, v in values.items() if isinstance(v, Thicknesses | ThicknessTable)}
    unset = [f.name for f in fields if "kind" not in f.metadata]
    if not unset:
        return dataclasses.replace(options, **lengths)
    plant_values = {f.name: getattr(plant, f.name) for f in dataclasses.fields(plant)} | shared(rules, known)
    if ORDERS_BY in unset:
        plant_values[ORDERS_BY] = _orders_by(plant, rules, known)
    return dataclasses.replace(options, **lengths, **{name: plant_values[name] for name in unset})


def _orders_by(plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]]) -> tuple[Any, ...]:
    """Id and options of each rule of the catalogue whose pairs are a fact, without what a file in its place adds."""
    found = []
    for name, rule in RULES.items():
        if rule.pairs_are:
            values = {f.name: getattr(rules[name].options, f.name) for f in dataclasses.fields(rule.Options)}
            found.append((name, resolve_defaults(rule.Options(**values), plant, rules, known)))
    return tuple(found)


def shared(rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]] = RULES) -> dict[str, object]:
    """Name → value of the options that rules share with others."""
    return {name: getattr(rules[id].options, name) for id, rule in known.items() for name in rule.shares}
