"""A plant's profile: its machine, its material, and what it asks of every plan. Frozen; speeds in mm/s, times in s."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from kerfwise.encoder.bridges.lawful import expect_wider
from kerfwise.encoder.candidates.candidate import LEAST_WASTE_MM, CommonOptions, LeadOptions
from kerfwise.encoder.corner_feed import CornerFeed
from kerfwise.encoder.cornered import with_corners
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import FactOptions
from kerfwise.encoder.facts.links import LinkOptions
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.nest import Kind, Nest
from kerfwise.encoder.readers.layers import Layers
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.scrap import with_scrap
from kerfwise.encoder.shown import shown
from kerfwise.encoder.slits import with_slits
from kerfwise.encoder.small_holes import HoleLimits, as_cut
from kerfwise.encoder.tabs import TabOptions
from kerfwise.encoder.touching import with_loss
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.by_thickness import ByThickness, length_at
from kerfwise.rules.options.option import options_of
from kerfwise.rules.outside import PythonFile, installed_rules
from kerfwise.rules.own import Own, OwnFile, Thresholds, own_pairs
from kerfwise.rules.plant import Plant
from kerfwise.rules.profile.cuts_section import Cuts
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, Strength
from kerfwise.rules.rule_file import RuleFile
from kerfwise.rules.temperature_limit import TemperatureLimit

from .chart_use import ChartUse
from .corners_section import Corners
from .files import content_of, decoded
from .filling import T, filled_in, known_plant
from .for_one_nest import ForOneNest
from .frame import Frame, frame_of, reach_of
from .heat_section import Heat
from .machine_section import Origin
from .made_of import digest_of, of_own, options_of_own
from .models_section import ModelSource
from .nesting_section import Nesting
from .prices_section import Prices
from .reader import GivenValues, read_given
from .sections import DrawingSection, LeadsSection, Machine, Material, Objective, RuleSetting, default_settings
from .small_holes_section import SmallHoles
from .time_section import Time

DEFAULT = "plasma-carbon-steel"
"""The shipped profile that is used where none is named."""

_STEP_MM = 1e-3


@dataclass(frozen=True)
class Profile:
    """Everything a plant fixes beforehand.

    `further_rules` are those beside the catalogue that `rules` has settings of: of installed packages, which are off
    unless a profile says otherwise, and of the files that it names.

    `sha256` is that of the profile's file and of all files that it is made of: those it is based on, its chart, its
    dialect's, and those of its rules; `read_from` are the places of that file and of those it is based on. `chart` says
    what of it is from a material chart, and `said_at` where each key stands, by such as `machine.home` and
    `rules.pierce`. `for_one_nest` says what a job file, or the command line, has in the place of the plant's own. These
    and `file` do not make two profiles differ.

    Examples
    --------
    >>> profile = load_profile("plasma-carbon-steel")
    >>> profile.material.kerf_mm, profile.rules["level-ahead"].strength
    (1.5, 'hard')
    """

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
        listed = {
            name: dataclasses.replace(setting, options=self._filled_in(setting.options)) for name, setting in on.items()
        }
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

    def at_origin(self, origin: Origin) -> Profile:
        """The profile with the machine's zero where a plan or program says that it has it."""
        return (
            self
            if origin == self.machine.origin
            else dataclasses.replace(self, machine=dataclasses.replace(self.machine, origin=origin))
        )

    def at_spacing(self, spacing_mm: float | None) -> Profile:
        """The profile with torches where a plan or program says that they stand, where they can be moved there."""
        torches = self.machine.torches
        most_mm = torches.up_to_mm
        if (
            spacing_mm is None
            or most_mm is None
            or not torches.spacing_mm - _STEP_MM <= spacing_mm <= most_mm + _STEP_MM
        ):
            return self
        moved = dataclasses.replace(torches, spacing_mm=spacing_mm, up_to_mm=None)
        return dataclasses.replace(self, machine=dataclasses.replace(self.machine, torches=moved))

    def length_mm(self, length: ByThickness) -> float:
        """A length that may go with the thickness, as it is for the profile's material."""
        return length_at(length, self.material.thickness_mm)

    def frame_on(self, nest: Nest) -> Frame:
        """The machine's coordinates on the nest."""
        return frame_of(nest, self.machine)

    def home_on(self, nest: Nest) -> Point:
        """The machine's home in the coordinates of the nest's drawing."""
        return frame_of(nest, self.machine).on_drawing(self.machine.home)

    def reach_on(self, nest: Nest) -> Box | None:
        """What the torch can go to, in the coordinates of the nest's drawing; None where the profile says nothing."""
        return reach_of(nest, self.machine)

    def lead_options(self, nest: Nest | None = None) -> LeadOptions:
        """How candidates are made: `leads`, the kerf, and what the rules and the locks say.

        Given a nest, they keep to what the machine reaches of it.
        """
        return dataclasses.replace(
            self._asked_of_leads(),
            reach=None if nest is None else self.reach_on(nest),
            entry_points={lock.contour: lock.entry for lock in self.locks if lock.contour and lock.entry},
            holes=self.hole_limits(),
            narrow=self.cuts.narrow,
            common=self.common_options(),
        )

    def common_options(self) -> CommonOptions | None:
        """Which edges two parts have in common; None where none are to be cut once."""
        common = self.cuts.common
        if common.shortest_mm is None:
            return None
        return CommonOptions(common.shortest_mm, common.gap_tolerance_mm, self.machine.kerf_start, self.corner_feed())

    def without_losses(self, nest: Nest) -> Nest:
        """The nest less what parts that touch lose to the cut between them, where the profile accepts that."""
        edges = self.common_options() if self.cuts.common.accept_loss else None
        return nest if edges is None else with_loss(nest, self.material.kerf_mm, edges.shortest_mm, edges.gap_mm)

    @property
    def kerf_starts(self) -> bool:
        """Whether cuts may begin in the kerf of an older one, without a wait for a pierce."""
        common = self.common_options()
        return common is not None and common.kerf_start

    def link_options(self) -> LinkOptions | None:
        """How links are made: no longer than the profile allows, and than pays; None where there are none."""
        machine, leads = self.machine, self.leads
        longest_mm = self.cuts.links.longest_mm
        if longest_mm <= 0 or self.no_links() is not None:
            return None
        slower = 1 / machine.cut_feed_mm_s - 1 / machine.travel_mm_s
        if slower > 0:
            lead_s = self.length_mm(leads.lead_in_mm) * (1 / machine.cut_feed_mm_s + 1 / machine.travel_mm_s)
            longest_mm = min(longest_mm, (max(machine.pierce_time_s, machine.edge_preheat_s) + lead_s) / slower)
        return LinkOptions(longest_mm, self.material.kerf_mm, self._asked_of_leads().splash_mm or 0.0)

    def no_links(self, nest: Nest | None = None) -> str | None:
        """Why there can be no links, whatever length of them is allowed: a clause; None where there can."""
        limit = self.temperature_limit()
        if limit is not None and limit.dwells:
            return f"the rule {limit.rule} lets metal cool while the torch is off (dwells)"
        if self.corner_feed() is not None:
            return "corners are cut more slowly (corner_feed), and the one where a link begins is of two cuts"
        if nest is not None and nest.scrap:
            return "links would cut metal off the skeleton, in which scrap lines are cut afterwards"
        return None

    def _asked_of_leads(self) -> LeadOptions:
        """What the sections and the rules ask of each lead, whatever the nest."""
        leads = self.leads
        given = LeadOptions(
            entries=leads.entries,
            kerf_mm=self.material.kerf_mm,
            lead=leads.lead,
            lead_in_mm=self.length_mm(leads.lead_in_mm),
            lead_in_min_mm=leads.lead_in_min_mm,
            lead_out=leads.lead_out,
            lead_out_mm=leads.lead_out_length_mm,
            pierce_clearance_mm=0.0,
            splash_mm=None,
            hole_overcut_mm=self.length_mm(leads.hole_overcut_mm),
            edge_start=leads.edge_start,
        )
        for rule, options, strength in self._every_rule:
            given = rule.lead_options(given, options, strength)
        return given

    def tabs(self) -> TabOptions | None:
        """Which parts have tabs, and of what kind; None where no rule asks for any."""
        return self._asked_of_leads().tabs

    def rules_of_direction(self, kind: Kind) -> tuple[str, ...]:
        """Ids of the rules that leave one direction only for this kind of contour."""
        free = LeadOptions()
        return tuple(
            rule.id
            for rule, options, strength in self._every_rule
            if len(rule.lead_options(free, options, strength).directions[kind]) == 1
        )

    def hole_limits(self) -> HoleLimits:
        """What is done with small holes, in mm on this sheet: `small_holes`, its thickness, and the pierce's room."""
        # Without a lead the pierce is on the path.
        asked_mm = self._asked_of_leads().pierce_clearance_mm if self.leads.lead != "none" else 0.0
        clearance_mm = max(asked_mm, self.material.kerf_mm / 2 + LEAST_WASTE_MM)
        return self.small_holes.limits(self.material.thickness_mm, clearance_mm)

    def as_cut(self, nest: Nest) -> Nest:
        """The nest as this plant cuts it: small holes are marks or gone, others know their feed, slots have slits.

        So has the skeleton its lines, where the profile has them made. Of parts that touch it is what they keep, where
        the profile accepts the loss.

        Raises
        ------
        InputError
            If a bridge of the nest is narrower than the kerf, or a part has no room to lose what it is to lose.
        """
        expect_wider(nest, self.material.kerf_mm)
        made = self.without_losses(as_cut(nest, self.hole_limits()))
        made = with_slits(made, self.material.kerf_mm) if self.cuts.narrow == "slit" else made
        made = with_scrap(made, self.material.kerf_mm, self.cuts.scrap.grid_mm, self.cuts.scrap.remnant)
        law = self.corner_feed()
        return made if law is None else with_corners(made, law, self.material.kerf_mm)

    def corner_feed(self) -> CornerFeed | None:
        """The feeds at corners on this sheet; None where corners are cut like the rest."""
        return self.corners.law(self.material.thickness_mm)

    def fact_options(self, nest: Nest | None = None) -> FactOptions:
        """The thresholds of the facts, as the rules and the locks say.

        Given a nest, zones keep to the orders of the plant's own hard rules too.
        """
        own = own_pairs(self.own_rules, nest, self._thresholds()) if nest is not None else ()
        own += self._pairs_in_files(nest) if nest is not None else ()
        given = FactOptions(
            zone_respects=frozenset(),
            zone_pairs=(*((lock.contour, lock.before) for lock in self.locks if lock.contour and lock.before), *own),
            zone_places=self._zone_places(nest),
            zone_fixed=tuple((lock.part, lock.zone) for lock in self.locks if lock.part and lock.zone),
            kerf_mm=self.material.kerf_mm,
            splash_mm=None,
            pierce_pass=self.cuts.pierce_pass,
        )
        for rule, options, strength in self._every_rule:
            given = rule.fact_options(given, options, strength)
        return given

    def _pairs_in_files(self, nest: Nest) -> tuple[tuple[str, str], ...]:
        """Orders that hard rules in model files state of the nest alone, so that no zone contradicts them."""
        on = self.settings()
        hard = [rule for rule in self.model_rules() if on[rule.id].strength == "hard" and not rule.gives_way]
        return tuple(pair for rule in hard for pair in rule.pairs_of_nest(nest, on[rule.id].options))

    def _zone_places(self, nest: Nest | None) -> tuple[tuple[str, int], ...]:
        """Part → the position that a lock gives one of its contours: its zone must reach there."""
        if nest is None:
            return ()
        found: dict[str, int] = {}
        ends = {"first": 1, "last": len(nest.contours)}
        for lock in self.locks:
            if lock.contour in nest.without_scrap.index and lock.position is not None:
                at = lock.position if isinstance(lock.position, int) else ends[lock.position]
                found.setdefault(nest.contour(lock.contour).part, at)
        return tuple(found.items())

    def read_options(self) -> ReadOptions:
        """How nest files are read."""
        drawing = self.drawing
        return ReadOptions(
            units=drawing.units,
            layers=Layers(**{o.name: getattr(drawing.layers, o.name) for o in options_of(drawing.layers)}),
            frame=drawing.frame,
            open_lines=drawing.open_lines,
            scrap_lines=drawing.scrap_lines,
            margin_mm=drawing.margin_mm,
            join_tolerance_mm=drawing.join_tolerance_mm,
            refit_arcs_mm=drawing.refit_arcs_mm,
        )

    def _thresholds(self) -> Thresholds:
        return self._filled_in(Thresholds())


LONGEST_CHAIN = 20


def load_profile(name_or_path: str | Path = DEFAULT, *, trust: bool = False) -> Profile:
    """The shipped profile of that name, or the one in that file.

    `trust` lets it run the Python files that it names; without it only those run that the machine's configuration
    allows, see `rules/outside/trust.py`.

    Raises
    ------
    InputError
        If there is none, or it has a wrong key, type or value: with file, line, column, what was expected, and the
        nearest valid name. All mistakes of a file are reported at once. Also if a rule that a package or a Python file
        brings cannot be used, or the profile names a Python file that is not trusted.
    """
    return _load(str(name_or_path), Path(), (), trust)


def _load(name: str, folder: Path, chain: tuple[str, ...], trust: bool) -> Profile:
    file, place, content = content_of(name, folder)
    if file in chain:
        raise InputError(f"it goes in a circle: {' → '.join((*chain, file))}")
    if len(chain) >= LONGEST_CHAIN:
        raise InputError(f"more than {LONGEST_CHAIN} profiles are based on each other in a row")
    text = decoded(content, file)
    bases: list[str] = []

    def base(of: str) -> GivenValues:
        made = _load(of, Path(file).parent, (*chain, file), trust)
        bases.append(made.sha256)
        return _fields(made)

    given = read_given(text, file, _fields(_silent(shown(Path(file).stem))), base, trust)
    read_from = (*given.get("read_from", ()), place)
    made = Profile(**given | {"file": file, "read_from": read_from})
    return dataclasses.replace(made, sha256=digest_of(content, made, bases))


def _silent(name: str) -> Profile:
    """A profile that says nothing: the rules of installed packages are known, and off."""
    installed = installed_rules()
    off = {name: RuleSetting("off", None, rule.Options()) for name, rule in installed.items()}
    return Profile(name, rules=default_settings() | off, further_rules=installed)


def _fields(profile: Profile) -> GivenValues:
    return {f.name: getattr(profile, f.name) for f in dataclasses.fields(profile)}
