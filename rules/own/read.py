"""The `own_rules` of a profile read from YAML, with every mistake found and placed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.contents import is_file
from kerfwise.rules.options.kind import OptionKind, Unfit
from kerfwise.rules.options.plain_values import Choice, Text
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, entries, items
from kerfwise.rules.rule import Strength

from .own_rule import ASKS, Own, OwnFile, OwnRule
from .scope import Scope
from .selector import read_selector, selector_schema

DEFAULT_WEIGHT_MM = 1000.0
STRENGTHS: tuple[Strength, ...] = ("hard", "soft", "off")
_PLAIN: dict[str, tuple[OptionKind, str]] = {
    "name": (Text(), "what plans and checks call the rule, after own:"),
    "why": (Text(), "the reason, in words for the planner"),
    "strength": (Choice(STRENGTHS), "default hard"),
    "weight": (LENGTH, "of a soft rule: cost of breaking it once, in idle travel (default 1000 mm)"),
    "scope": (Scope(), "within what the rule holds (default sheet)"),
}
KEYS = (*_PLAIN, "select", *ASKS)
FILE_KEYS = ("file", "name", "why", "strength", "weight")

KeyedNodes = list[tuple[str, yaml.Node, yaml.Node]]


def read_own_rules(node: yaml.Node, problems: Problems) -> tuple[Own, ...]:
    """The plant's own rules; what is wrong with them is noted in `problems`."""
    rules: dict[str, Own] = {}
    for number, entry in enumerate(items(node, problems, "own_rules"), 1):
        what = f"own_rules[{number}]"
        so_far = len(problems.found)
        members = list(entries(entry, problems, what))
        is_file = any(key == "file" for key, _, _ in members)
        if len(problems.found) > so_far:
            continue
        rule = _file(entry, members, problems, what) if is_file else read_own_rule(entry, members, problems, what)
        if rule is not None and rule.name in rules:
            problems.add(entry, f"{what}: the name {rule.name!r} is taken by an own rule before it")
        elif rule is not None:
            rules[rule.name] = rule
    return tuple(rules.values())


def read_own_rule(entry: yaml.Node, members: KeyedNodes, problems: Problems, what: str) -> OwnRule | None:
    so_far = len(problems.found)
    given: dict[str, Any] = {}
    asked = [(key, key_node, value) for key, key_node, value in members if key in ASKS]
    for key, key_node, value in members:
        if key == "select":
            given[key] = read_selector(value, problems, f"{what}.select")
        elif key not in KEYS:
            problems.add(key_node, f"{what}: {unknown('key', key, [*KEYS, 'file'])}")
    given |= plain_values(members, problems, what)
    for key, key_node, _ in asked[1:]:
        problems.add(key_node, f"{what}: a rule asks one thing, this one asks {asked[0][0]} and {key}; write two rules")
    ask = [ASKS[key].read(key, value, problems, f"{what}.{key}") for key, _, value in asked[:1]]
    if len(problems.found) == so_far and not ask:
        problems.add(entry, f"{what}: nothing is asked: give one of {', '.join(ASKS)}")
    if len(problems.found) == so_far and "name" not in given:
        problems.add(entry, f"{what}: give the rule a name")
    if len(problems.found) > so_far:
        return None
    return OwnRule(ask=ask[0], place=problems.place(entry), **given)


def _file(entry: yaml.Node, members: KeyedNodes, problems: Problems, what: str) -> OwnFile | None:
    so_far = len(problems.found)
    given = plain_values(members, problems, what)
    for key, key_node, value in members:
        if key == "file":
            try:
                given["file"] = Text().read(value)
            except Unfit as error:
                problems.add(value, f"{what}.file: {error}")
        elif key not in FILE_KEYS:
            problems.add(key_node, f"{what}: {unknown('key of a rule in a file', key, FILE_KEYS)}")
    if len(problems.found) > so_far:
        return None
    given.setdefault("name", Path(given["file"]).stem)
    made = OwnFile(place=problems.place(entry), **given)
    node = next(value for key, _, value in members if key == "file")
    if made.path.suffix != ".mzn":
        problems.add(node, f"{what}.file: expected a MiniZinc file such as plant_rule.mzn, got {made.file!r}")
    elif not is_file(made.path):
        problems.add(node, f"{what}.file: there is no file {str(made.path)!r}")
    return made


def plain_values(members: KeyedNodes, problems: Problems, what: str) -> dict[str, Any]:
    strength = next((value.value for key, _, value in members if key == "strength"), "hard")
    given: dict[str, Any] = {"weight": DEFAULT_WEIGHT_MM} if strength == "soft" else {}
    for key, _, value in members:
        if key in _PLAIN:
            try:
                given[key] = _PLAIN[key][0].read(value)
            except Unfit as error:
                problems.add(value, f"{what}.{key}: {error}")
        if key == "weight" and strength != "soft":
            problems.add(value, f"{what}.weight: only a soft rule has a weight, this one is {strength}")
    return given


def own_rules_schema() -> dict[str, Any]:
    """JSON Schema of `own_rules`; it refers to `own_rules_definitions` under `$defs`."""
    plain = {key: {"description": help, **kind.schema()} for key, (kind, help) in _PLAIN.items()}
    asks = {key: {"description": kind.KEYS[key], **kind.schema(key)} for key, kind in ASKS.items()}
    file = {"description": "a MiniZinc file, beside the profile", "type": "string"}
    select = {"description": "which contours the rule is about (default all)", "$ref": "#/$defs/selector"}
    return {
        "type": ["array", "null"],
        "description": "rules of the plant's own",
        "items": {
            "oneOf": [
                {
                    "type": "object",
                    "properties": {**plain, "select": select, **asks},
                    "required": ["name"],
                    "additionalProperties": False,
                    "oneOf": [{"required": [key]} for key in asks],
                },
                {
                    "type": "object",
                    "properties": {"file": file} | {key: plain[key] for key in FILE_KEYS if key in plain},
                    "required": ["file"],
                    "additionalProperties": False,
                },
            ]
        },
    }


def own_rules_definitions() -> dict[str, Any]:
    """The `$defs` that the schema of `own_rules` refers to."""
    return {"selector": selector_schema()}
