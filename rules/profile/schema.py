"""The JSON Schema of a profile: `python -m kerfwise.rules.profile.schema > rules/profile/profile.schema.json`.

It gives editors completion and a first check; the reader of profiles checks the same and more, with better words.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from typing import Any

from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Choice, Text
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.options.quantities import WEIGHT
from kerfwise.rules.own import own_rules_definitions, own_rules_schema
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule

from .linked_files import models_schema
from .load import MOVED
from .sections import SECTIONS

Json = dict[str, Any]


def profile_schema(rules: Mapping[str, Rule[Any]] = RULES) -> Json:
    """The schema, made from the same declarations that profiles are read with; with these rules, if given."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kerfwise profile",
        "description": "What a plant fixes beforehand: its machine, its material and its rules.",
        **_closed(
            {
                "name": _described(Text().schema(), "what plans and programs call this profile"),
                "based_on": _described(
                    Text().schema(), "a shipped profile, or a file, whose values hold where none is given"
                ),
                **{key: _section(key, section) for key, section in SECTIONS.items()},
                "python": _python(),
                "models": models_schema(),
                "rules": _closed({name: _rule(rule) for name, rule in rules.items()}),
                "own_rules": own_rules_schema(),
                "locks": _locks(),
            }
        ),
        "$defs": own_rules_definitions(),
    }


def _section(key: str, owner: type) -> Json:
    text = (owner.__doc__ or "").strip().splitlines()[0]
    return _described(_closed(_options(owner) | _older(key)), text)


def _older(section: str) -> Json:
    return {
        key: {"description": f"now {section}.{group}.{name}", "deprecated": True, **Text().schema()}
        for key, (group, name) in MOVED.get(section, {}).items()
    }


def _options(owner: type) -> Json:
    properties = {}
    for option in options_of(owner):
        if isinstance(option.kind, Members):
            properties[option.key] = _described(_closed(_options(option.kind.owner)), option.help)
            continue
        default = None if option.default is None else option.kind.write(option.default)
        shown = f"{option.help} (default {default})" if default is not None else option.help
        properties[option.key] = _described(option.kind.schema(), shown)
    return properties


def _rule(rule: Rule[Any]) -> Json:
    strength = Choice(rule.strengths).schema()
    keys: Json = {"strength": _described(strength, f"default {rule.default}")}
    if "soft" in rule.strengths:
        keys["weight"] = _described(
            WEIGHT.schema(), "cost of breaking the rule once, in idle travel; of a soft rule only"
        )
    return _described({"anyOf": [strength, _closed(keys | _options(rule.Options))]}, rule.sentence)


def _python() -> Json:
    file = Text().schema()
    return {
        "description": "files of rules in Python, beside the profile; they run only where they are trusted",
        "anyOf": [file, {"type": ["array", "null"], "items": file}],
    }


def _locks() -> Json:
    decisions = _options(Lock)
    return {
        "type": ["array", "null"],
        "description": "decisions of the operator",
        "items": _closed(decisions)
        | {"type": "object", "oneOf": [{"required": ["contour"]}, {"required": ["part", "zone"]}]},
    }


def _closed(keys: Json) -> Json:
    """A mapping with these keys and no others; it may be left empty."""
    return {"type": ["object", "null"], "properties": keys, "additionalProperties": False}


def _described(schema: Json, text: str) -> Json:
    return {"description": text, **schema}


def schema_text(rules: Mapping[str, Rule[Any]] = RULES) -> str:
    """The schema as the text of its file."""
    return json.dumps(profile_schema(rules), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())
