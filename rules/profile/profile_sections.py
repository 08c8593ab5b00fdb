"""The sections of a profile taken together: which rules are on, with what options, and what contradicts what."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import yaml

from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import Thicknesses, ThicknessTable, length_at
from kerfwise.rules.options.yaml_positions import Problems, deepest
from kerfwise.rules.outside import PythonFile
from kerfwise.rules.own import Own, OwnFile, Thresholds, as_rule
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Plant, Plate, Rule, RuleFile, Strength, TemperatureLimit

from .linked_files import ChartUse, ModelSource
from .plant_sections import MACHINE_WAITS, MATERIALS, Heat, KeptOfThickness, Prices
from .sections import (
    Common,
    Corners,
    Cuts,
    Distortion,
    DrawingSection,
    LeadsSection,
    Machine,
    Material,
    Nesting,
    Objective,
    RuleSetting,
    SmallHoles,
    default_settings,
)
from .time_section import LawLeft, Time

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


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
    distortion: Distortion = field(default_factory=Distortion)
    small_holes: SmallHoles = field(default_factory=SmallHoles)
    corners: Corners = field(default_factory=Corners)
    cuts: Cuts = field(default_factory=Cuts)
    nesting: Nesting = field(default_factory=Nesting)
    chart: ChartUse | None = field(default=None, compare=False)
    law_left: LawLeft | None = field(default=None, compare=False)
    kept: KeptOfThickness | None = field(default=None, compare=False)
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
        return {**known, **{rule.id: own_model_rule(rule) for rule in self.own_rules}}

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
        return plant_of_sections(self.machine, self.material, self.heat, self.locks, self.cuts)

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

    def chart_notes(self) -> tuple[str, ...]:
        """What a planner would want to know of the material chart: what is interpolated, and what it is not asked."""
        return () if self.chart is None else tuple(self.chart.notes())

    def time_and_price_notes(self) -> tuple[str, ...]:
        """What a planner would want to know of times and prices: what does not hold, or is for another thickness."""
        notes = [] if self.law_left is None else [self.law_left.told(self.machine.cut_feed_mm_s)]
        if self.kept is not None:
            notes.append(self.kept.told(self.machine, self.material))
        half_given = list(self.prices.half_given(self.material.gas_flow_m3_h))
        if not (half_given or self.prices.given) and any(key.startswith("prices.") for key in self.said_at):
            half_given = ["prices: no price is given, so that no cost is told"]
        return (*notes, *half_given)

    def _thresholds(self) -> Thresholds:
        return self._filled_in(Thresholds())


def options_of_own(own: OwnFile) -> Any:
    """The options of the rule that an entry's file makes, with the parameters that the entry sets."""
    options_type, parameters = own_model_rule(own).Options, dict(own.parameters)
    return options_type(**{o.name: parameters[o.key] for o in options_of(options_type) if o.key in parameters})


def own_model_rule(own: Own) -> Rule[Any]:
    """The rule that an entry of `own_rules` makes: one in a file is a model rule like those of `models`."""
    if isinstance(own, OwnFile):
        return read_model_rule(own.path, rule_id=own.id, sentence=own.why).with_strength(own.strength)
    return as_rule(own)


# A rule's options as they are for the sheet: with what the rest of the profile, and other rules, fill in.

T = TypeVar("T", bound="DataclassInstance")
ORDERS_BY = "orders_by"
"""The field of rules in model files that takes the options of the rules whose pairs are facts."""


def plant_of_sections(machine: Machine, material: Material, heat: Heat, locks: tuple[Lock, ...], cuts: Cuts) -> Plant:
    """What rules may know of these sections."""
    return Plant(
        thickness_mm=material.thickness_mm,
        kerf_mm=material.kerf_mm,
        ambient_c=heat.ambient_c,
        heat_limit_c=heat.limit_c,
        absorbed_power_w=heat.absorbed_power_w,
        locks=locks,
        process=machine.process,
        common_cuts=cuts.common.shortest_mm is not None or bool(cuts.in_stretches),
        snakes=cuts.snake.gap_mm is not None,
        longest_link_mm=cuts.links.longest_mm,
        plate=Plate(
            thickness_mm=material.thickness_mm,
            material=material.name,
            process=machine.process,
            density_kg_m3=MATERIALS[heat.material].density,
            cut_mm_s=machine.cut_feed_mm_s,
            mark_mm_s=machine.mark_feed_mm_s,
            pierce_s=machine.pierce_time_s,
            mark_s=machine.mark_time_s,
        ),
    )


def resolve_defaults(
    options: T, plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]] = RULES
) -> T:
    """The options with the fields that no key of their own sets, and lengths as they are for the sheet's thickness.

    `known` are the rules that `rules` has settings of.

    Raises
    ------
    KeyError
        If neither `Plant` nor an option that a rule shares has the name of such a field: the rule's author is wrong.
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


@dataclass(frozen=True, slots=True)
class ForOneNest:
    """What a plan was made with beside nest and profile: the job file by name and sha256, and what was said beside it.

    `settings` and `locks` are those of the command line (or of Python), in one line each, with the names of the nest.
    `numbered` says which contour each number stood for that the job file calls one by, such as `#7`. `said` is what
    stands at the top of the program and changes no plan: order, due, date and number.
    """

    file: str = ""
    sha256: str = ""
    settings: tuple[str, ...] = ()
    locks: tuple[str, ...] = ()
    numbered: Mapping[str, str] = field(default_factory=dict)
    said: Mapping[str, str] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """What a plan says of it."""
        source = {"file": self.file, "sha256": self.sha256} if self.file else {}
        overrides = {
            "set": list(self.settings), "locks": list(self.locks), "numbered": dict(self.numbered),
            "said": dict(self.said),
        }  # fmt: skip
        return source | {key: value for key, value in overrides.items() if value}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> ForOneNest:
        """The same, read back."""
        return ForOneNest(
            data.get("file", ""),
            data.get("sha256", ""),
            tuple(data.get("set", ())),
            tuple(data.get("locks", ())),
            dict(data.get("numbered", {})),
            dict(data.get("said", {})),
        )


def changed_since(then: ForOneNest | None, now: ForOneNest | None) -> Iterator[str]:
    """A sentence for each thing that a plan was made with, and is not given now, or the other way round.

    Examples
    --------
    >>> list(changed_since(ForOneNest("plate.job.yaml", "1a2b"), None))
    ['the plan was made with the job file plate.job.yaml, which is not given here']
    >>> list(changed_since(None, ForOneNest(settings=("leads.lead_in=4 mm",))))
    ['the plan was made without --set leads.lead_in=4 mm, which is given here']
    """
    then, now = then or ForOneNest(), now or ForOneNest()
    if then.sha256 and now.sha256 and then.sha256 != now.sha256:
        yield "the job file is not the one the plan was made with (its sha256 differs)"
    elif then.sha256 and not now.sha256:
        yield f"the plan was made with the job file {then.file}, which is not given here"
    elif now.sha256 and not then.sha256:
        yield f"the plan was made without the job file {now.file}, which is given here"
    for option, before, given in (("--set", then.settings, now.settings), ("--lock", then.locks, now.locks)):
        yield from (f"the plan was made with {option} {said}, which is not given here" for said in _only(before, given))
        yield from (f"the plan was made without {option} {said}, which is given here" for said in _only(given, before))


def _only(these: tuple[str, ...], those: tuple[str, ...]) -> Iterator[str]:
    return (one for one in these if one not in those)


# What only the values of a profile taken together can get wrong.


SLOWEST_MM_S = 1 / 3
"""The slowest feed that anything but a water jet cuts at; slower ones are mostly m/min without their unit."""


def check_together(values: dict[str, Any], root: yaml.Node, problems: Problems) -> None:
    """Note values that contradict each other, at the one that the file gives."""
    leads: LeadsSection = values["leads"]
    machine: Machine = values["machine"]
    material: Material = values["material"]
    rules: dict[str, RuleSetting] = values["rules"]
    time: Time = values["time"]
    heat: Heat = values["heat"]
    holes: SmallHoles = values["small_holes"]

    lead_in_mm = length_at(leads.lead_in_mm, material.thickness_mm)
    if leads.lead_in_min_mm > lead_in_mm:
        problems.add(
            deepest(root, "leads", "lead_in_min"),
            f"leads.lead_in_min: {leads.lead_in_min_mm:g} mm is more than lead_in, {lead_in_mm:g} mm",
        )
    pierce = next((name for name, setting in rules.items() if hasattr(setting.options, "clearance_mm")), "")
    if leads.lead == "none" and pierce and rules[pierce].strength != "off":
        problems.add(
            deepest(root, "leads", "lead"),
            f"leads.lead: without a lead the torch pierces on its path, {material.kerf_mm / 2:g} mm from the contour, "
            f"and rules.{pierce} asks for more: give a lead (line, arc), or switch that off: rules: {{{pierce}: off}}",
        )
    if leads.edge_start and machine.process == "oxyfuel" and machine.edge_preheat_s <= 0:
        problems.add(
            deepest(root, "leads", "edge_start"),
            "leads.edge_start: a flame has to heat the sheet's edge before it cuts: give machine.edge_preheat, such as "
            "7 s",
        )
    feed_node = deepest(root, "machine", "cut_feed")
    slow = machine.process != "water-jet" and machine.cut_feed_mm_s < SLOWEST_MM_S
    if slow and isinstance(feed_node, yaml.ScalarNode):
        feed, least = (f"{mm_s * 60:.6g}" for mm_s in (machine.cut_feed_mm_s, SLOWEST_MM_S))
        problems.add(
            feed_node,
            f"machine.cut_feed: {feed} mm/min is not likely for {machine.process}, expected {least} mm/min and more: "
            f"did you mean {feed} m/min?",
        )
    for path, text in common_cut_problems(values["cuts"].common, machine, material, values["cuts"].in_stretches):
        problems.add(deepest(root, *path), text)
    if leads.edge_start and machine.pierce_dwell == "machine":
        problems.add(
            deepest(root, "leads", "edge_start"),
            f"leads.edge_start: {MACHINE_WAITS}",
        )
    if machine.torches.several and machine.torches.spacing_mm <= 0:
        problems.add(
            deepest(root, "machine", "torches"),
            f"machine.torches.spacing: {machine.torches.count} torches stand apart: say how far, such as 500 mm",
        )
    if machine.torches.up_to_mm is not None and machine.torches.up_to_mm < machine.torches.spacing_mm:
        problems.add(
            deepest(root, "machine", "torches", "up_to"),
            f"machine.torches.up_to: {machine.torches.up_to_mm:g} mm is less than the least spacing, "
            f"{machine.torches.spacing_mm:g} mm",
        )
    for key, span, at_mm in zip("xy", (machine.travel_x_mm, machine.travel_y_mm), machine.home, strict=True):
        if span is not None and not span[0] <= at_mm <= span[1]:
            problems.add(
                deepest(root, "machine", "home"),
                f"machine.home: {at_mm:g} mm lies outside machine.travel_{key}, {span[0]:g} to {span[1]:g} mm",
            )
    least_mm, full_mm = (length_at(length, material.thickness_mm) for length in (holes.min_hole, holes.full_feed_hole))
    if holes.small_hole_feed < 1 and full_mm < least_mm:
        problems.add(
            deepest(root, "small_holes", "full_feed_hole"),
            f"small_holes.full_feed_hole: {full_mm:g} mm is less than min_hole, {least_mm:g} mm",
        )
    if time.model == "blocks" and time.feed_by_blocks is None and not problems.found:
        problems.add(
            deepest(root, "time", "model"),
            "time.model: blocks needs a feed law: give time.feed_by_blocks, a shipped law's name or points of your own",
        )
    if heat.limit_c <= heat.ambient_c:
        problems.add(
            deepest(root, "heat", "limit_c"),
            f"heat.limit_c: {heat.limit_c:g} °C is not above ambient_c, {heat.ambient_c:g} °C: everything is too hot",
        )
    if heat.logical_conduction * 8 > 1:
        problems.add(
            deepest(root, "heat", "logical_conduction"),
            f"heat.logical_conduction: {heat.logical_conduction:g} for each of 8 neighbours is more than a point has; "
            "the scheme is stable up to 0.125",
        )
    for key, text in _wrong_prices(values["prices"], material):
        problems.add(deepest(root, "prices", key), f"prices.{key}: {text}")
    plant = plant_of_sections(machine, material, heat, values["locks"], values["cuts"])
    for name, key, text in rule_option_problems(plant, rules, RULES | values["further_rules"]):
        problems.add(deepest(root, "rules", name, key), f"rules.{name}.{key}: {text}")


def rule_option_problems(
    plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]]
) -> Iterator[tuple[str, str, str]]:
    """Rule, key of an option, and what is wrong, where options do not go with the plant, its locks among it."""
    for name, setting in rules.items():
        if setting.strength != "off":
            for key, text in known[name].check_with(
                resolve_defaults(setting.options, plant, rules, known), plant, rules
            ):
                yield name, key, text


def _wrong_prices(prices: Prices, material: Material) -> Iterator[tuple[str, str]]:
    """Keys of prices that the other values leave without a meaning, and why."""
    worn = prices.consumables
    if prices.gas_m3 and material.gas_flow_m3_h is None:
        yield "gas_m3", "nobody says how much gas flows: give material.gas_flow, or a chart with that column"
    if prices.gas_m3 and prices.gas_hour:
        yield "gas_m3", "the gas has a price by the hour too (gas_hour): keep one"
    if prices.sheet_kg and prices.sheet_each:
        yield "sheet_each", "the sheet has a price by the kilogram too (sheet_kg): keep one"
    if prices.kwh and not (prices.torch_kw or prices.standby_kw):
        yield "kwh", "nobody says how much power is drawn: give torch_kw, standby_kw or both"
    if worn.set_price and not (worn.pierces or worn.torch_hours):
        yield "consumables", "nobody says how long a set lasts: give consumables.pierces, torch_hours or both"


# What of common cuts does not go with the machine and the material.


def common_cut_problems(
    common: Common, machine: Machine, material: Material, stretches: str = ""
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Where the mistake stands in a profile, by its keys, and what it is; so of the group that asks for `stretches`."""
    asked = "common" if common.shortest_mm is not None else stretches
    if not asked:
        return
    if common.gap_tolerance_mm > tolerance_mm(material.kerf_mm):
        yield (
            ("cuts", "common", "gap_tolerance"),
            f"cuts.common.gap_tolerance: {common.gap_tolerance_mm:g} mm is more than a torch may be off at this kerf, "
            f"{tolerance_mm(material.kerf_mm):g} mm",
        )
    if machine.kerf_start and machine.process == "oxyfuel" and machine.edge_preheat_s <= 0:
        yield (
            ("cuts", asked),
            f"cuts.{asked}: a flame has to heat the edge of a kerf before it cuts on from there: give "
            "machine.edge_preheat, such as 7 s, or say machine.kerf_start: false",
        )
    if machine.kerf_start and machine.pierce_dwell == "machine":
        yield (("machine", "kerf_start"), f"machine.kerf_start: {MACHINE_WAITS}")
