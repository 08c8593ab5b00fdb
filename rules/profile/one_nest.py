"""What is set and locked for one nest only, and a profile with it: `rules.pierce.clearance: 1.48 mm`."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, is_empty
from kerfwise.rules.own import is_own, with_own_values

from .made_of import parameters_of
from .profile import Profile
from .reader import given_by
from .sections import SECTIONS

SETTABLE = (*SECTIONS, "rules", "own_rules")
"""What a key that is set can begin with."""
COMMAND_LINE = "--set"
BOTH = "--set (in Python: settings)"
"""The option as the command line and as Python have it."""
_MAP, _STR = "tag:yaml.org,2002:map", "tag:yaml.org,2002:str"


@dataclass(frozen=True, slots=True)
class Setting:
    """A value of the profile that one nest has otherwise: its key, such as `rules.pierce.clearance`, and the value.

    `place` is where a job file says so; None for one of the command line.
    """

    key: str
    text: str
    node: yaml.Node = field(compare=False, repr=False)
    key_node: yaml.Node = field(compare=False, repr=False)
    place: Place | None = field(default=None, compare=False)

    def __str__(self) -> str:
        return f"{self.key}={self.text}"


def read_setting(text: str) -> Setting:
    """The setting of `KEY=VALUE`, the value as a profile has it.

    Raises
    ------
    InputError
        If it is not of this form.

    Examples
    --------
    >>> setting = read_setting("rules.pierce.clearance=1.48 mm")
    >>> setting.key, setting.text
    ('rules.pierce.clearance', '1.48 mm')
    """
    key, sign, value = (part.strip() for part in text.partition("="))
    if not sign or not key or not value:
        raise InputError(f"{BOTH} {text!r}: expected KEY=VALUE, such as leads.lead_in=4mm")
    try:
        node = compose(value, COMMAND_LINE)
    except InputError as error:
        raise InputError(f"{BOTH} {text!r}: {error.message}") from None
    if node is None:
        raise InputError(f"{BOTH} {text!r}: expected a value after =")
    return Setting(key, value, node, yaml.ScalarNode(_STR, key, node.start_mark, node.end_mark))


def read_settings(node: yaml.Node, problems: Problems) -> tuple[Setting, ...]:
    """The settings of a mapping of keys with dots, or of one as deep as a profile."""
    found = []
    for key, key_node, value in entries(node, problems, "set"):
        if is_empty(value):
            problems.add(key_node, f"set: expected a value for {key!r}, such as leads.lead_in: 4 mm")
        else:
            found.append(Setting(key, _one_line(value), value, key_node, problems.place(key_node)))
    return tuple(found)


def with_settings(profile: Profile, settings: Sequence[Setting], file: str = COMMAND_LINE) -> Profile:
    """The profile with what is set in the place of its own values; all is checked as if the profile said it.

    Raises
    ------
    InputError
        If a key or a value is wrong: with its place in `file`.
    """
    if not settings:
        return profile
    problems = Problems(file)
    own = [(setting.key, setting.key_node, setting.node) for setting in settings if is_own(setting.key)]
    root = _nested([setting for setting in settings if not is_own(setting.key)], settings[0].key_node, problems)
    start = {f.name: getattr(profile, f.name) for f in dataclasses.fields(profile)}
    start["own_rules"] = with_own_values(profile.own_rules, own, problems, parameters_of)
    try:
        problems.raise_any()
        given = given_by(root, problems, start, _no_base)
    except InputError as error:
        if file != COMMAND_LINE:
            raise
        others = (text.split(": ", 1)[-1] for text in error.details)
        told = "; ".join(text.removeprefix("set: ") for text in (error.message, *others))
        raise InputError(f"{BOTH}: {told}") from None
    if file == COMMAND_LINE:
        given["said_at"] = {key: _without_line(at) for key, at in given["said_at"].items()}
    return dataclasses.replace(profile, **given)


def _no_base(name: str) -> dict[str, Any]:
    raise AssertionError(name)  # `based_on` is no key that can be set


def _without_line(at: str) -> str:
    return COMMAND_LINE if at.startswith(f"{COMMAND_LINE}:") else at


def _one_line(node: yaml.Node) -> str:
    return str(node.value) if isinstance(node, yaml.ScalarNode) else " ".join(yaml.serialize(node).split())


class _Tree(dict[str, "tuple[yaml.Node, _Tree | yaml.Node]"]):
    """Key → where it stands, and what stands under it."""


def _nested(settings: Iterable[Setting], at: yaml.Node, problems: Problems) -> yaml.Node:
    """Settings as the YAML of a profile."""
    tree = _Tree()
    for setting in settings:
        path = setting.key.split(".")
        if path[0] not in SETTABLE:
            problems.add(setting.key_node, f"set: {unknown('key', path[0], SETTABLE)}")
        else:
            _put(tree, path, setting.key_node, setting.node, setting.key, problems)
    return _mapping(tree, at)


def _put(
    tree: _Tree,
    path: Sequence[str],
    key_node: yaml.Node,
    value: yaml.Node,
    said: str,
    problems: Problems,
    depth: int = 1,
) -> None:
    """Put a value where its path leads to; mappings are put key by key, as deep as profiles have keys."""
    name, rest = path[0], path[1:]
    members = value.value if isinstance(value, yaml.MappingNode) and not rest and depth < _DEEPEST else ()
    if not rest and not (members and all(isinstance(key, yaml.ScalarNode) for key, _ in members)):
        if name in tree:
            problems.add(key_node, f"set: {said} is set twice")
        tree[name] = (key_node, value)
        return
    _, under = tree.setdefault(name, (key_node, _Tree()))
    if not isinstance(under, _Tree):
        problems.add(key_node, f"set: {said} is set twice: once with all that is under {name!r}")
        return
    for steps, at, node in [(rest, key_node, value)] if rest else [([k.value], k, v) for k, v in members]:
        _put(under, steps, at, node, said if rest else f"{said}.{steps[0]}", problems, depth + 1)


_DEEPEST = 3
"""Keys in a row, as in `drawing.layers.cut`."""


def _mapping(tree: _Tree, at: yaml.Node) -> yaml.Node:
    members = []
    for name, (key_node, under) in tree.items():
        key = yaml.ScalarNode(_STR, name, key_node.start_mark, key_node.end_mark)
        members.append((key, _mapping(under, key_node) if isinstance(under, _Tree) else under))
    return yaml.MappingNode(_MAP, members, at.start_mark, at.end_mark)
