"""The sections of a profile, which of its rules are on, and with what options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.option import options_of
from kerfwise.rules.outside import PythonFile
from kerfwise.rules.own import Own, OwnFile, Thresholds, as_rule
from kerfwise.rules.plant import Plant
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, Strength
from kerfwise.rules.rule_file import RuleFile
from kerfwise.rules.temperature_limit import TemperatureLimit

from .chart_use import ChartUse
from .corners_section import Corners
from .cuts_section import Cuts
from .filling import T, filled_in, known_plant
from .for_one_nest import ForOneNest
from .heat_section import Heat
from .models_section import ModelSource
from .nesting_section import Nesting
from .prices_section import Prices
from .sections import DrawingSection, LeadsSection, Machine, Material, Objective, RuleSetting, default_settings
from .small_holes_section import SmallHoles
from .time_section import Time


@dataclass(frozen=True)
class ProfileSections:
    """What stands in a profile, section by section, and its rules as they are for the sheet: see `Profile`."""

    name: str
    machine: Machine = field(default_factory=Machine)
    material: Material = field(default_factory=Material)
    leads: LeadsSection = field(default_factory=LeadsSection)
    drawing: DrawingSection = field(default_factory=DrawingSection)
    rules: Mapping[str, RuleSetting] = field(default_factory=default_settings)
    objective: Objective = field(default_factory=Objective)
    locks: tuple[Lock, ...] = ()
    own_rules: tuple[Own, ...] = ()
    python: tuple[PythonFile, ...] = ()
    models: tuple[ModelSource, ...] = ()
    further_rules: Mapping[str, Rule[Any]] = field(default_factory=dict)
    time: Time = field(default_factory=Time)
    prices: Prices = field(default_factory=Prices)
    heat: Heat = field(default_factory=Heat)
    small_holes: SmallHoles = field(default_factory=SmallHoles)
    corners: Corners = field(default_factory=Corners)
    cuts: Cuts = field(default_factory=Cuts)
    nesting: Nesting = field(default_factory=Nesting)
    chart: ChartUse | None = field(default=None, compare=False)
    said_at: Mapping[str, str] = field(default_factory=dict, compare=False)
    sha256: str = field(default="", compare=False)
    file: str = field(default="", compare=False)
    read_from: tuple[str, ...] = field(default=(), compare=False)
    for_one_nest: ForOneNest | None = field(default=None, compare=False)

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
        settings = self.settings()
        known = {
            name: rule.with_strength(settings[name].strength if name in settings else "off")
            if isinstance(rule, ModelRule)
            else rule
            for name, rule in self.known_rules().items()
        }
        return {**known, **{rule.id: of_own(rule) for rule in self.own_rules}}

    def model_rules(self) -> list[ModelRule]:
        """The rules that are on and stand in model files, which need MiniZinc."""
        on = self.settings()
        return [rule for name, rule in self.rulebook().items() if name in on and isinstance(rule, ModelRule)]

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

    @property
    def plant(self) -> Plant:
        """What rules may know of the profile beside their own options."""
        return known_plant(self.machine, self.material, self.heat, self.locks, self.cuts)

    def _filled_in(self, options: T) -> T:
        return filled_in(options, self.plant, self.rules, self.known_rules())

    @cached_property
    def _every_rule(self) -> Sequence[tuple[Rule[Any], Any, Strength]]:
        """Each rule with its options and strength; those from outside only if they are on."""
        return [
            (rule, self._filled_in(self.rules[name].options), self.rules[name].strength)
            for name, rule in self.known_rules().items()
            if name in RULES or self.rules[name].strength != "off"
        ]

    def chart_notes(self) -> tuple[str, ...]:
        """What a planner would want to know of the material chart: what is interpolated, and what it is not asked."""
        return () if self.chart is None else tuple(self.chart.notes())

    def price_notes(self) -> tuple[str, ...]:
        """What a planner would want to know of the prices: what they say in part, so that the cost leaves it out."""
        if found := tuple(self.prices.half_given(self.material.gas_flow_m3_h)):
            return found
        said = any(key.startswith("prices.") for key in self.said_at)
        return ("prices: no price is given, so that no cost is told",) if said and not self.prices.given else ()

    def _thresholds(self) -> Thresholds:
        return self._filled_in(Thresholds())


def options_of_own(own: OwnFile) -> Any:
    """The options of the rule that an entry's file makes, with the parameters that the entry sets."""
    made, given = of_own(own).Options, dict(own.parameters)
    return made(**{o.name: given[o.key] for o in options_of(made) if o.key in given})


def of_own(own: Own) -> Rule[Any]:
    """The rule that an entry of `own_rules` makes: one in a file is a model rule like those of `models`."""
    if isinstance(own, OwnFile):
        return read_model_rule(own.path, rule_id=own.id, sentence=own.why).with_strength(own.strength)
    return as_rule(own)
