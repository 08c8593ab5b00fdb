"""The plain keys of an entry of `own_rules`: its name, why, strength, weight and scope."""

from __future__ import annotations

from typing import Any

import yaml

from kerfwise.rules.options.kind import OptionKind, Unfit
from kerfwise.rules.options.plain_values import Choice, Text
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.rule import Strength

from .scope import Scope

DEFAULT_WEIGHT_MM = 1000.0
STRENGTHS: tuple[Strength, ...] = ("hard", "soft", "off")
PLAIN: dict[str, tuple[OptionKind, str]] = {
    "name": (Text(), "what plans and checks call the rule, after own:"),
    "why": (Text(), "the reason, in words for the planner"),
    "strength": (Choice(STRENGTHS), "default hard"),
    "weight": (LENGTH, "of a soft rule: cost of breaking it once, in idle travel (default 1000 mm)"),
    "scope": (Scope(), "within what the rule holds (default sheet)"),
}

KeyedNodes = list[tuple[str, yaml.Node, yaml.Node]]


def plain_values(members: KeyedNodes, problems: Problems, what: str) -> dict[str, Any]:
    strength = next((value.value for key, _, value in members if key == "strength"), "hard")
    given: dict[str, Any] = {"weight": DEFAULT_WEIGHT_MM} if strength == "soft" else {}
    for key, _, value in members:
        if key in PLAIN:
            try:
                given[key] = PLAIN[key][0].read(value)
            except Unfit as error:
                problems.add(value, f"{what}.{key}: {error}")
        if key == "weight" and strength != "soft":
            problems.add(value, f"{what}.weight: only a soft rule has a weight, this one is {strength}")
    return given
