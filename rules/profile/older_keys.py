"""Keys that have moved: a profile written before still reads the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import yaml

from kerfwise.rules.options.yaml_positions import Problems

MOVED: Mapping[str, Mapping[str, tuple[str, str]]] = {
    "drawing": {"sheet_layer": ("layers", "sheet"), "mark_layer": ("layers", "mark")},
}
"""Section → its older key → the group it is in now, and its key there."""

KeyedNode = tuple[str, yaml.Node, yaml.Node]


def with_new_names(section: str, members: Sequence[KeyedNode], problems: Problems) -> list[KeyedNode]:
    """The keys and values of a section with each older key where it belongs now; a value given twice is a problem."""
    moved = MOVED.get(section, {})
    kept = [member for member in members if member[0] not in moved]
    for key, key_node, value in members:
        if key not in moved:
            continue
        group, name = moved[key]
        if not any(k == group for k, _, _ in kept):
            start, end = key_node.start_mark, value.end_mark
            kept.append((group, key_node, yaml.MappingNode("tag:yaml.org,2002:map", [], start, end)))
        [(at, group_key, inner)] = [(at, at_key, node) for at, (k, at_key, node) in enumerate(kept) if k == group]
        if not isinstance(inner, yaml.MappingNode):
            continue  # `read_fields` reports it
        if any(k.value == name for k, _ in inner.value):
            problems.add(
                key_node, f"{section}.{key}: this is {section}.{group}.{name} now, which is given too; keep one"
            )
            continue
        node = yaml.ScalarNode("tag:yaml.org,2002:str", name, key_node.start_mark, key_node.end_mark)
        both = [*inner.value, (node, value)]  # in a node of its own: a text that is read again has the same nodes
        kept[at] = (group, group_key, yaml.MappingNode(inner.tag, both, inner.start_mark, inner.end_mark))
    return kept
