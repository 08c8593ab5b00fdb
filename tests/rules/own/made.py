"""Own rules written as YAML, read without a file."""

from __future__ import annotations

import yaml

from kerfwise.rules.options.yaml_positions import Problems, compose
from kerfwise.rules.own import Own, read_own_rules
from kerfwise.rules.profile.load import parameters_of


def rules_of(text: str) -> tuple[Own, ...]:
    """The rules in a YAML list; a mistake raises InputError."""
    problems = Problems("plant.yaml")
    node = compose(text, "plant.yaml")
    assert isinstance(node, yaml.Node)
    rules = read_own_rules(node, problems, parameters_of)
    problems.raise_any()
    return rules
