"""Own rules: what a plant adds to the catalogue in its profile, in YAML."""

from .own_rule import PREFIX, Own, OwnFile, OwnRule
from .plant_rule import PlantRule, Thresholds, as_rule, own_pairs
from .read import own_rules_definitions, own_rules_schema, read_own_rules

__all__ = [
    "PREFIX",
    "Own",
    "OwnFile",
    "OwnRule",
    "PlantRule",
    "Thresholds",
    "as_rule",
    "own_pairs",
    "own_rules_definitions",
    "own_rules_schema",
    "read_own_rules",
]
