"""What only the values of a profile taken together can get wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from kerfwise.rules.options.by_thickness import length_at
from kerfwise.rules.options.yaml_positions import Problems, deepest
from kerfwise.rules.plant import Plant
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule

from .common_checks import wrong_common
from .filling import filled_in, known_plant
from .heat_section import Heat
from .machine_section import MACHINE_WAITS
from .prices_section import Prices
from .sections import LeadsSection, Machine, Material, RuleSetting
from .small_holes_section import SmallHoles
from .time_section import Time


def check_together(given: dict[str, Any], root: yaml.Node, problems: Problems) -> None:
    """Note values that contradict each other, at the one that the file gives."""
    leads: LeadsSection = given["leads"]
    machine: Machine = given["machine"]
    material: Material = given["material"]
    rules: dict[str, RuleSetting] = given["rules"]
    time: Time = given["time"]
    heat: Heat = given["heat"]
    holes: SmallHoles = given["small_holes"]

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
    for path, text in wrong_common(given["cuts"].common, machine, material):
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
    for key, text in _wrong_prices(given["prices"], material):
        problems.add(deepest(root, "prices", key), f"prices.{key}: {text}")
    plant = known_plant(machine, material, heat, given["locks"], given["cuts"])
    for name, key, text in at_odds(plant, rules, RULES | given["further_rules"]):
        problems.add(deepest(root, "rules", name, key), f"rules.{name}.{key}: {text}")


def at_odds(
    plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]]
) -> Iterator[tuple[str, str, str]]:
    """Rule, key of an option, and what is wrong, where options do not go with the plant, its locks among it."""
    for name, setting in rules.items():
        if setting.strength != "off":
            for key, text in known[name].check_with(filled_in(setting.options, plant, rules, known), plant, rules):
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
