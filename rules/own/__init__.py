"""Own rules: what a plant adds to the catalogue in its profile, in YAML."""

from .own_rule import (
    PREFIX,
    Own,
    OwnFile,
    OwnRule,
    PlantRule,
    Thresholds,
    as_rule,
    is_own,
    own_pairs,
    own_rules_definitions,
    own_rules_schema,
    read_own_rules,
    with_own_values,
)

__all__ = [
    "PREFIX",
    "Own",
    "OwnFile",
    "OwnRule",
    "PlantRule",
    "Thresholds",
    "as_rule",
    "is_own",
    "own_pairs",
    "own_rules_definitions",
    "own_rules_schema",
    "read_own_rules",
    "with_own_values",
]
