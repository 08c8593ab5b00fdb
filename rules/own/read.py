"""The `own_rules` of a profile read from YAML, with every mistake found and placed."""

from __future__ import annotations

from typing import Any

import yaml

from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, entries, items

from .file_entry import FILE_KEYS, ParametersOf, read_file_entry
from .own_rule import ASKS, Own, OwnRule
from .plain_keys import PLAIN, KeyedNodes, plain_values
from .selector import read_selector, selector_schema

KEYS = (*PLAIN, "select", *ASKS)


def read_own_rules(node: yaml.Node, problems: Problems, parameters_of: ParametersOf) -> tuple[Own, ...]:
    """The plant's own rules; what is wrong with them is noted in `problems`.

    Raises
    ------
    InputError
        If an entry gives parameters of a file that is no rule.
    """
    rules: dict[str, Own] = {}
    for number, entry in enumerate(items(node, problems, "own_rules"), 1):
        what = f"own_rules[{number}]"
        so_far = len(problems.found)
        members = list(entries(entry, problems, what))
        is_file = any(key == "file" for key, _, _ in members)
        if len(problems.found) > so_far:
            continue
        rule: Own | None
        if is_file:
            rule = read_file_entry(entry, members, problems, what, parameters_of)
        else:
            rule = read_own_rule(entry, members, problems, what)
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


def own_rules_schema() -> dict[str, Any]:
    """JSON Schema of `own_rules`; it refers to `own_rules_definitions` under `$defs`."""
    plain = {key: {"description": help, **kind.schema()} for key, (kind, help) in PLAIN.items()}
    asks = {key: {"description": kind.KEYS[key], **kind.schema(key)} for key, kind in ASKS.items()}
    file = {"description": "a MiniZinc file, beside the profile", "type": "string"}
    parameters = {
        "description": "of a rule in a file: values of the parameters that it declares, by name (default the file's)",
        "type": "object",
        "additionalProperties": {"type": ["integer", "boolean", "string"]},
    }
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
                    "properties": {
                        "file": file,
                        **{key: plain[key] for key in FILE_KEYS if key in plain},
                        "parameters": parameters,
                    },
                    "required": ["file"],
                    "additionalProperties": False,
                },
            ]
        },
    }


def own_rules_definitions() -> dict[str, Any]:
    """The `$defs` that the schema of `own_rules` refers to."""
    return {"selector": selector_schema()}
