"""Values of the plant's own rules that one nest has otherwise: `own_rules.narrow slots first.weight: 300 mm`."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence

import yaml
from yaml.representer import SafeRepresenter

from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, is_empty

from .file_entry import FILE_KEYS, ParametersOf, with_parameters
from .own_rule import PREFIX, Own, OwnRule
from .plain_keys import plain_values
from .read import read_own_rule

SECTION = "own_rules"
_MAP, _STR = "tag:yaml.org,2002:map", "tag:yaml.org,2002:str"

KeyAndNode = tuple[str, yaml.Node, yaml.Node]
"""What is set: a key with dots, where it stands, and the value."""
Tree = dict[str, "Tree | yaml.Node"]


def is_own(key: str) -> bool:
    """Whether a key that is set is one of an own rule: `own_rules…` or, as plans call the rule, `own:…`."""
    return key == SECTION or key.startswith((f"{SECTION}.", PREFIX))


def with_own_values(
    own: Sequence[Own], settings: Iterable[KeyAndNode], problems: Problems, parameters_of: ParametersOf
) -> tuple[Own, ...]:
    """The own rules of a profile with what is set in them; what is wrong is noted in `problems`.

    A value that is no mapping is the rule's strength. What is not set stays as it is, however deep.
    """
    given: dict[str, tuple[yaml.Node, Tree]] = {}
    names = [rule.name for rule in own]
    for rest, key_node, value in _each(settings):
        name = _named(rest, names)
        if name is None:
            said = unknown("own rule", rest, names) if names else "the profile has no own rules"
            problems.add(key_node, f"set: {said}")
            continue
        path = rest[len(name) + 1 :].split(".") if len(rest) > len(name) else []
        if not path and not isinstance(value, yaml.MappingNode):
            path = ["strength"]
        twice = _put(given.setdefault(name, (key_node, {}))[1], path, value)
        if twice is not None:
            problems.add(key_node, f"set: {'.'.join((SECTION, name, *twice))} is set twice")
    return tuple(
        _changed(rule, *given[rule.name], problems, parameters_of) if rule.name in given else rule for rule in own
    )


def _each(settings: Iterable[KeyAndNode]) -> Iterator[KeyAndNode]:
    """What is set, by the name of the rule and what comes after it."""
    for key, key_node, value in settings:
        if key == SECTION:
            if isinstance(value, yaml.MappingNode):
                yield from ((str(name.value), name, of) for name, of in value.value)
            else:
                yield "", key_node, value
        else:
            yield key.removeprefix(PREFIX) if key.startswith(PREFIX) else key[len(SECTION) + 1 :], key_node, value


def _named(rest: str, names: Iterable[str]) -> str | None:
    """The rule that a key begins with the name of; the longest name, since a name may have dots."""
    found = [name for name in names if rest == name or rest.startswith(f"{name}.")]
    return max(found, key=len, default=None)


def _put(tree: Tree, path: Sequence[str], value: yaml.Node, above: Sequence[str] = ()) -> tuple[str, ...] | None:
    """Put a value where its path leads to, mappings key by key; the path of a value that was there already."""
    if not path:
        twice = None
        for key, of in value.value if isinstance(value, yaml.MappingNode) else ():
            twice = twice or _put(tree, [str(key.value)], of, above)
        return twice
    here = (*above, path[0])
    found = tree.get(path[0])
    if path[1:] or (isinstance(value, yaml.MappingNode) and not is_empty(value)):
        if isinstance(found, yaml.Node):
            return here
        under = tree[path[0]] = {} if found is None else found
        return _put(under, path[1:], value, here)
    tree[path[0]] = value
    return None if found is None else here


def _changed(rule: Own, at: yaml.Node, tree: Tree, problems: Problems, parameters_of: ParametersOf) -> Own:
    what = f"{SECTION}.{rule.name}"
    if "name" in tree:
        problems.add(at, f"{what}.name: a rule keeps its name")
        return rule
    plain = rule.plain()
    strength = tree.get("strength")
    if isinstance(strength, yaml.ScalarNode) and strength.value != "soft":
        plain.pop("weight", None)
    members = [(key, _key(key, at), _node(value, at)) for key, value in _merged(plain, tree).items()]
    if isinstance(rule, OwnRule):
        entry = yaml.MappingNode(
            _MAP, [(key_node, value) for _, key_node, value in members], at.start_mark, at.end_mark
        )
        made = read_own_rule(entry, members, problems, what)
        return rule if made is None else dataclasses.replace(made, place=rule.place)
    for key in (*(tree.keys() - set(FILE_KEYS)), *(tree.keys() & {"file"})):
        problems.add(at, f"{what}: {unknown('key of a rule in a file', key, FILE_KEYS[2:])}")
    changed = dataclasses.replace(rule, **{"weight": None} | plain_values(members, problems, what))
    return with_parameters(changed, members, problems, what, parameters_of)


def _merged(plain: Mapping[str, object], tree: Tree) -> dict[str, object]:
    """Plain data with what is set in its place."""
    made = dict(plain)
    for key, value in tree.items():
        if isinstance(value, dict):
            under = made.get(key)
            made[key] = _merged(under if isinstance(under, Mapping) else {}, value)
        else:
            made[key] = value
    return made


def _key(key: str, at: yaml.Node) -> yaml.Node:
    return yaml.ScalarNode(_STR, key, at.start_mark, at.end_mark)


def _node(value: object, at: yaml.Node) -> yaml.Node:
    """Data as YAML; what comes from the profile stands where it is set."""
    if isinstance(value, yaml.Node):
        return value
    if isinstance(value, Mapping):
        return yaml.MappingNode(
            _MAP, [(_key(k, at), _node(v, at)) for k, v in value.items()], at.start_mark, at.end_mark
        )
    if isinstance(value, list | tuple):
        return yaml.SequenceNode("tag:yaml.org,2002:seq", [_node(v, at) for v in value], at.start_mark, at.end_mark)
    made = SafeRepresenter().represent_data(value)
    made.start_mark, made.end_mark = at.start_mark, at.end_mark
    return made
