"""Files of rules that a profile names, as its keys `models` and `python` do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml

from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.plain_values import Text
from kerfwise.rules.options.yaml_positions import Problems, items

GivenFiles = dict[str, Any]
"""Fields of a profile that such files fill: the files themselves, `further_rules` and `rules`."""


def names_of_files(node: yaml.Node, key: str, problems: Problems) -> Iterator[tuple[str, yaml.Node]]:
    """Every name under a key, one alone or a list of them, and where it stands."""
    for entry in [node] if isinstance(node, yaml.ScalarNode) and node.value else items(node, problems, key):
        try:
            yield Text().read(entry), entry
        except Unfit as error:
            problems.add(entry, f"{key}: {error}")
