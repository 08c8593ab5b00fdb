"""What does not go together in a profile, or with a nest: values, and techniques."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any, Literal

import yaml

from kerfwise.encoder.bevels.cut_nest import bevelled
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.quantities import length_at
from kerfwise.rules.options.yaml_positions import Place, Problems, deepest, wrong_at
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Plant, Rule

from .active_rules import resolve_defaults
from .plant_sections import MACHINE_WAITS, Heat, Machine, Material, Prices
from .profile_yaml import where_said
from .sections import Common, LeadsSection, RuleSetting, SmallHoles
from .technique import Technique
from .time_section import Time
from .values import plant_of_sections

# What only the values of a profile taken together can get wrong.


SLOWEST_MM_S = 1 / 3
"""The slowest feed that anything but a water jet cuts at; slower ones are mostly m/min without their unit."""


def check_together(values: Mapping[str, Any], root: yaml.Node, problems: Problems) -> None:
    """Note values that contradict each other, at the one that the file gives."""
    cuts, machine, material = values["cuts"], values["machine"], values["material"]
    plant = plant_of_sections(machine, material, values["heat"], values["locks"], cuts)
    of_rules = rule_option_problems(plant, values["rules"], RULES | values["further_rules"])
    for key, text in chain(
        _wrong_leads(values["leads"], machine, material, values["rules"]),
        _wrong_feed(machine, root),
        common_cut_problems(cuts.common, machine, material, cuts.in_stretches),
        _wrong_machine(machine),
        _wrong_holes(values["small_holes"], material),
        _wrong_time(values["time"], problems),
        _wrong_heat(values["heat"]),
        _wrong_prices(values["prices"], material),
        ((f"rules.{name}.{key}", text) for name, key, text in of_rules),
    ):
        problems.add(deepest(root, *key.split(".")), f"{key}: {text}")


Wrong = Iterator[tuple[str, str]]
"""Keys of a profile, such as `leads.lead`, each with what is wrong there."""


def _wrong_leads(leads: LeadsSection, machine: Machine, material: Material, rules: Mapping[str, RuleSetting]) -> Wrong:
    lead_in_mm = length_at(leads.lead_in_mm, material.thickness_mm)
    if leads.lead_in_min_mm > lead_in_mm:
        yield "leads.lead_in_min", f"{leads.lead_in_min_mm:g} mm is more than lead_in, {lead_in_mm:g} mm"
    pierce = next((name for name, setting in rules.items() if hasattr(setting.options, "clearance_mm")), "")
    if leads.lead == "none" and pierce and rules[pierce].strength != "off":
        yield (
            "leads.lead",
            f"without a lead the torch pierces on its path, {material.kerf_mm / 2:g} mm from the contour, and "
            f"rules.{pierce} asks for more: give a lead (line, arc), or switch that off: rules: {{{pierce}: off}}",
        )
    if leads.edge_start and machine.process == "oxyfuel" and machine.edge_preheat_s <= 0:
        text = "a flame has to heat the sheet's edge before it cuts: give machine.edge_preheat, such as 7 s"
        yield "leads.edge_start", text
    if leads.edge_start and machine.pierce_dwell == "machine":
        yield "leads.edge_start", MACHINE_WAITS


def _wrong_feed(machine: Machine, root: yaml.Node) -> Wrong:
    slow = machine.process != "water-jet" and machine.cut_feed_mm_s < SLOWEST_MM_S
    if slow and isinstance(deepest(root, "machine", "cut_feed"), yaml.ScalarNode):
        feed, least = (f"{mm_s * 60:.6g}" for mm_s in (machine.cut_feed_mm_s, SLOWEST_MM_S))
        likely = f"is not likely for {machine.process}, expected {least} mm/min and more"
        yield "machine.cut_feed", f"{feed} mm/min {likely}: did you mean {feed} m/min?"


def _wrong_machine(machine: Machine) -> Wrong:
    torches, spacing_mm = machine.torches, machine.torches.spacing_mm
    if torches.several and spacing_mm <= 0:
        yield "machine.torches.spacing", f"{torches.count} torches stand apart: say how far, such as 500 mm"
    if torches.up_to_mm is not None and torches.up_to_mm < spacing_mm:
        yield "machine.torches.up_to", f"{torches.up_to_mm:g} mm is less than the least spacing, {spacing_mm:g} mm"
    for key, span, at_mm in zip("xy", (machine.travel_x_mm, machine.travel_y_mm), machine.home, strict=True):
        if span is not None and not span[0] <= at_mm <= span[1]:
            yield "machine.home", f"{at_mm:g} mm lies outside machine.travel_{key}, {span[0]:g} to {span[1]:g} mm"


def _wrong_holes(holes: SmallHoles, material: Material) -> Wrong:
    least_mm, full_mm = (length_at(length, material.thickness_mm) for length in (holes.min_hole, holes.full_feed_hole))
    if holes.small_hole_feed < 1 and full_mm < least_mm:
        yield "small_holes.full_feed_hole", f"{full_mm:g} mm is less than min_hole, {least_mm:g} mm"


def _wrong_time(time: Time, problems: Problems) -> Wrong:
    if time.model == "blocks" and time.feed_by_blocks is None and not problems.found:
        yield (
            "time.model",
            "blocks needs a feed law: give time.feed_by_blocks, a shipped law's name or points of your own",
        )


def _wrong_heat(heat: Heat) -> Wrong:
    if heat.limit_c <= heat.ambient_c:
        text = f"{heat.limit_c:g} °C is not above ambient_c, {heat.ambient_c:g} °C: everything is too hot"
        yield "heat.limit_c", text
    if heat.logical_conduction * 8 > 1:
        more = f"{heat.logical_conduction:g} for each of 8 neighbours is more than a point has"
        yield "heat.logical_conduction", f"{more}; the scheme is stable up to 0.125"


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


def _wrong_prices(prices: Prices, material: Material) -> Wrong:
    worn = prices.consumables
    if prices.gas_m3 and material.gas_flow_m3_h is None:
        yield "prices.gas_m3", "nobody says how much gas flows: give material.gas_flow, or a chart with that column"
    if prices.gas_m3 and prices.gas_hour:
        yield "prices.gas_m3", "the gas has a price by the hour too (gas_hour): keep one"
    if prices.sheet_kg and prices.sheet_each:
        yield "prices.sheet_each", "the sheet has a price by the kilogram too (sheet_kg): keep one"
    if prices.kwh and not (prices.torch_kw or prices.standby_kw):
        yield "prices.kwh", "nobody says how much power is drawn: give torch_kw, standby_kw or both"
    if worn.set_price and not (worn.pierces or worn.torch_hours):
        yield "prices.consumables", "nobody says how long a set lasts: give consumables.pierces, torch_hours or both"


# What of common cuts does not go with the machine and the material.


def common_cut_problems(common: Common, machine: Machine, material: Material, stretches: str = "") -> Wrong:
    """What of common cuts is wrong; so of the group that asks for `stretches`."""
    asked = "common" if common.shortest_mm is not None else stretches
    if not asked:
        return
    over_mm = tolerance_mm(material.kerf_mm)
    if common.gap_tolerance_mm > over_mm:
        text = f"{common.gap_tolerance_mm:g} mm is more than a torch may be off at this kerf, {over_mm:g} mm"
        yield "cuts.common.gap_tolerance", text
    if machine.kerf_start and machine.process == "oxyfuel" and machine.edge_preheat_s <= 0:
        yield (
            f"cuts.{asked}",
            "a flame has to heat the edge of a kerf before it cuts on from there: give machine.edge_preheat, such as "
            "7 s, or say machine.kerf_start: false",
        )
    if machine.kerf_start and machine.pierce_dwell == "machine":
        yield "machine.kerf_start", MACHINE_WAITS


# Whether common edges can be cut once as a profile asks.


def _common_cuts(profile: Technique) -> Iterator[InputError]:
    """Common cuts with a good side, where a rule leaves outer contours one direction."""
    strict = profile.rules_of_direction("outer")
    if profile.common_options() is not None and strict and profile.cuts.common.good_side == "part":
        yield wrong_at(
            where_said(profile, ("cuts", "common")),
            f"cuts.common: {' and '.join(strict)} leaves outer contours one direction, so that of two parts with a "
            "common edge one gets the bad side of the kerf: free the direction, or accept that "
            "(cuts.common.good_side: any)",
            profile.file,
        )


# What does not go together with stretches, with bevels, and with several torches.

Beside = Literal["stretches", "bevels", "torches"]
_KNOWS: dict[Beside, str] = {"stretches": "whole rounds", "bevels": "upright torches", "torches": "one torch"}
"""What prices and simulations know in the place of each."""


_UNFIT: Mapping[str, tuple[str, Mapping[Beside, str]]] = {
    "a part out": (
        "cut the rest with one",
        {"torches": "a program that goes on after a stop is planned for one torch"},
    ),
    "tabs": (
        "turn off the rule that leaves tabs",
        {"stretches": "a part that tabs hold is cut in one round", "bevels": "a tilted torch leaves no tabs"},
    ),
    "links": (
        "say cuts.links.longest: 0 mm",
        {
            "bevels": "the torch does not stay on from a bevel to the next contour",
            "torches": "links are not planned together with several torches",
        },
    ),
    "common": (
        "say cuts.common.shortest: off",
        {
            "bevels": "an edge with a bevel is no common edge",
            "torches": "common cuts are not planned together with several torches",
        },
    ),
    "pierce pass": (
        "say cuts.pierce_pass: off",
        {
            "stretches": "what is left of a part begins at no hole",
            "bevels": "holes are not pierced for a tilted torch beforehand",
            "torches": "a pierce pass is not planned together with several torches",
        },
    ),
    "torches": (
        "say machine: {{torches: {{count: 1}}}}",
        {"stretches": "stretches are planned for one torch", "bevels": "one head tilts"},
    ),
    "stretches": ("leave cuts.{group} out", {"bevels": "a contour with a bevel is cut in whole rounds"}),
    "nothing last": (
        "say cuts: {{split: {{last: 25 mm}}}}",
        {"stretches": "two parts whose common edge comes last hang by a last stretch each (shared_last)"},
    ),
    "slits": ("say cuts.narrow: refuse, or leave", {"bevels": "slots of parts with bevels are not opened by one pass"}),
    "scrap": (
        "leave scrap lines out",
        {
            "stretches": "a way over the gaps of a row may cut metal off in which scrap lines are cut",
            "bevels": "loops lie where scrap lines are cut",
        },
    ),
    "bridges": ("leave the bridges out", {"bevels": "parts with bevels are not joined by bridges"}),
    "corners": (
        "say corners.corner_feed: 1",
        dict.fromkeys(("stretches", "bevels"), "slower corners are counted for {knows}"),
    ),
    "limit": ("turn it off", dict.fromkeys(_KNOWS, "{limit} simulates {knows}")),
    "heat": ("say objective: {{heat: 0}}", dict.fromkeys(_KNOWS, "the price of heat is simulated for {knows}")),
    "distortion": (
        "say objective: {{distortion: 0}}",
        dict.fromkeys(("stretches", "bevels"), "the price of distortion is simulated for {knows}"),
    ),
    "zone heat": ("say zone_heat: unlimited", {"torches": "the heat of zones is counted for one torch"}),
    "a stop": ("cut it from the old program", {"bevels": "a nest with bevels is not gone on with after a stop"}),
}
"""What a profile or a nest may have → what to change, and with what it does not go together, and why."""
_STANDS: Mapping[str, tuple[str, ...]] = {
    "links": ("cuts", "links"),
    "common": ("cuts", "common"),
    "pierce pass": ("cuts", "pierce_pass"),
    "torches": ("machine", "torches"),
    "nothing last": ("cuts", "split"),
    "slits": ("cuts", "narrow"),
    "scrap": ("cuts", "scrap"),
    "corners": ("corners", "corner_feed"),
    "heat": ("objective", "heat"),
    "distortion": ("objective", "distortion"),
}
"""Where a profile says so."""
_OWN_KEYS: Mapping[Beside, tuple[tuple[str, ...], ...]] = {
    "stretches": (("cuts", "snake"), ("cuts", "split")),
    "bevels": (("cuts", "bevel"),),
    "torches": (("machine", "torches"),),
}


def _unfit(beside: Beside, profile: Technique, nest: Nest | None, resumed: bool) -> Iterator[tuple[Place | None, str]]:
    """What a profile, or a nest, has that does not go together with one of these, and what to change, with its place.

    `resumed` says that some of the nest was cut before a stop.
    """
    cuts, limit = profile.cuts, profile.temperature_limit()
    zones = [setting.options for setting in profile.settings().values()]
    there: Mapping[str, object] = {
        "a part out": resumed,
        "tabs": profile.tabs(),
        "links": profile.link_options(),
        "common": profile.common_options(),
        "pierce pass": cuts.pierce_pass,
        "torches": profile.machine.torches.several,
        "stretches": cuts.in_stretches,
        "nothing last": cuts.split.shared_last and cuts.split.last_mm is None,
        "slits": cuts.narrow == "slit",
        "scrap": cuts.scrap.grid_mm is not None or cuts.scrap.remnant is not None or (nest is not None and nest.scrap),
        "bridges": nest is not None and nest.bridges,
        "corners": profile.corner_feed(),
        "limit": limit,
        "heat": profile.prices_overheats,
        "distortion": profile.objective.distortion,
        "zone heat": any(getattr(options, "zone_heat_kj", None) is not None for options in zones),
        "a stop": resumed,
    }
    for name, (remedy, why) in _UNFIT.items():
        if beside in why and there[name] not in (None, False, "", (), 0):
            says = f"{why[beside]}: {remedy}"
            named = {"knows": _KNOWS[beside], "group": cuts.in_stretches, "limit": "" if limit is None else limit.rule}
            keys = [_STANDS[name]] if name in _STANDS else []
            yield where_said(profile, *keys, *_OWN_KEYS[beside]), says.format(**named)


def misfits(profile: Technique, nest: Nest | None = None, resumed: bool = False) -> Iterator[InputError]:
    """What does not go together in a profile, or with a nest of which some may be cut before a stop, with its place.

    It is about common cuts, ways along stretches (snakes, and rounds in two), bevels and several torches.
    """
    yield from _common_cuts(profile)
    if group := profile.cuts.in_stretches:
        for place, why in _unfit("stretches", profile, nest, False):
            yield wrong_at(place, f"cuts.{group}: {why}, or leave cuts.{group} out", profile.file)
    yield from bevel_misfits(profile, nest, resumed)
    if profile.machine.torches.several:
        for place, why in _unfit("torches", profile, None, resumed):
            text = f"machine.torches: {why}, or say machine: {{torches: {{count: 1}}}}"
            yield wrong_at(place, text, profile.file)


# Whether bevels can be cut as a profile asks.


def bevel_misfits(profile: Technique, nest: Nest | None = None, resumed: bool = False) -> Iterator[InputError]:
    """What does not go together with bevels: of a profile that has a head for them, or of a nest that has some."""
    contours = [] if nest is None else list(bevelled(nest))
    section = profile.cuts.bevel
    if section.head is not None and section.tilt == section.turn:
        yield wrong_at(
            where_said(profile, ("cuts", "bevel")),
            f"cuts.bevel: tilt and turn are both {section.tilt}: give each axis its own",
            profile.file,
        )
    if not contours or nest is None:
        return
    if section.head is None:
        first = contours[0]
        named = " and ".join(sorted({str(bevel) for bevel in first.bevel_of_edge if bevel is not None}))
        yield InputError(
            f"{first.id} has a bevel ({named}), and the profile has no head that tilts: say cuts: {{bevel: "
            "{head: tilting}}, or take the bevel out of the nest",
            file=nest.file or None,
        )
    if section.head == "block" and len(kinds := {str(b) for c in contours for b in c.bevel_of_edge if b}) > 1:
        yield InputError(
            f"the block of torches is set by hand to one bevel, and the nest has {' and '.join(sorted(kinds))}: cut it "
            "as two nests, or take a head that tilts",
            file=nest.file or None,
        )
    for place, why in _unfit("bevels", profile, nest, resumed):
        yield wrong_at(place, f"{contours[0].id} has a bevel: {why}", profile.file)
