"""A rule's options as they are for the sheet: with what the rest of the profile, and other rules, fill in."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from kerfwise.rules.lock import Lock
from kerfwise.rules.options.by_thickness import Thicknesses, ThicknessTable
from kerfwise.rules.plant import Plant
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleSetting

from .heat_section import Heat

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from .cuts_section import Cuts
    from .machine_section import Machine
    from .sections import Material

T = TypeVar("T", bound="DataclassInstance")
ORDERS_BY = "orders_by"
"""The field of rules in model files that takes the options of the rules whose pairs are facts."""


def known_plant(machine: Machine, material: Material, heat: Heat, locks: tuple[Lock, ...], cuts: Cuts) -> Plant:
    """What rules may know of these sections."""
    return Plant(
        thickness_mm=material.thickness_mm,
        kerf_mm=material.kerf_mm,
        ambient_c=heat.ambient_c,
        heat_limit_c=heat.limit_c,
        absorbed_power_w=heat.absorbed_power_w,
        locks=locks,
        process=machine.process,
        common_cuts=cuts.common.shortest_mm is not None,
        longest_link_mm=cuts.links.longest_mm,
    )


def filled_in(options: T, plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]] = RULES) -> T:
    """The options with the fields that no key of their own sets, and lengths as they are for the sheet's thickness.

    `known` are the rules that `rules` has settings of.

    Raises
    ------
    KeyError
        If neither `Plant` nor an option that a rule shares has the name of such a field: the rule's author is wrong.
    """
    fields = dataclasses.fields(options)
    given = {f.name: getattr(options, f.name) for f in fields}
    lengths = {n: v.at(plant.thickness_mm) for n, v in given.items() if isinstance(v, Thicknesses | ThicknessTable)}
    unset = [f.name for f in fields if "kind" not in f.metadata]
    if not unset:
        return dataclasses.replace(options, **lengths)
    told = {f.name: getattr(plant, f.name) for f in dataclasses.fields(plant)} | shared(rules, known)
    if ORDERS_BY in unset:
        told[ORDERS_BY] = _orders_by(plant, rules, known)
    return dataclasses.replace(options, **lengths, **{name: told[name] for name in unset})


def _orders_by(plant: Plant, rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]]) -> tuple[Any, ...]:
    """Id and options of each rule of the catalogue whose pairs are a fact, without what a file in its place adds."""
    found = []
    for name, rule in RULES.items():
        if rule.pairs_are:
            given = {f.name: getattr(rules[name].options, f.name) for f in dataclasses.fields(rule.Options)}
            found.append((name, filled_in(rule.Options(**given), plant, rules, known)))
    return tuple(found)


def shared(rules: Mapping[str, RuleSetting], known: Mapping[str, Rule[Any]] = RULES) -> dict[str, object]:
    """Name → value of the options that rules share with others."""
    return {name: getattr(rules[id].options, name) for id, rule in known.items() for name in rule.shares}
