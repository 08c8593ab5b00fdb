"""A profile's YAML read into values, with every mistake found and placed."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.faults import at_work
from kerfwise.encoder.shown import shown
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.plain_values import Choice, Text
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, is_empty, items
from kerfwise.rules.own import read_own_rules
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule

from .chart_use import with_chart
from .checks import check_together
from .made_of import parameters_of
from .models_section import with_model_files
from .older_keys import with_new_names
from .python_section import with_python_files
from .sections import SECTIONS, RuleSetting

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

GivenValues = dict[str, Any]
T = TypeVar("T", bound="DataclassInstance")
KEYS = ("name", "based_on", *SECTIONS, "python", "models", "rules", "own_rules", "locks")


def read_given(
    text: str, file: str, start: GivenValues, load_base: Callable[[str], GivenValues], trust: bool = False
) -> GivenValues:
    """The fields of a profile: those of `start`, or of the one it is based on, with what the text gives in their place.

    `trust` lets Python files run that the text names.

    Raises
    ------
    InputError
        If the text is not YAML, or has a wrong key, type or value anywhere.
    """
    return given_by(compose(text, file), Problems(file), start, load_base, trust)


def given_by(
    root: yaml.Node | None,
    problems: Problems,
    start: GivenValues,
    load_base: Callable[[str], GivenValues],
    trust: bool = False,
) -> GivenValues:
    """The same of YAML that is read already."""
    found = _top_level(root, problems)
    given = dict(start)
    if "based_on" in found:
        given |= _base(found["based_on"], problems, load_base) | {"name": start["name"]}
    if "name" in found:
        given["name"] = shown(_read(found["name"], Text(), problems, "name") or "")
    for section in SECTIONS:
        if section in found:
            members = with_new_names(section, list(entries(found[section], problems, section)), problems)
            given[section] = read_fields(members, given[section], problems, section)
    if not problems.found:
        given = with_chart({section: found[section] for section in SECTIONS if section in found}, given, problems)
    if "python" in found:
        given |= with_python_files(found["python"], given, problems, trust)
    if "models" in found:
        given |= with_model_files(found["models"], given, problems)
    if "rules" in found:
        given["rules"] = read_rules(found["rules"], given["rules"], problems, RULES | given["further_rules"])
    if "locks" in found:
        given["locks"] = read_locks(found["locks"], problems)
    if "own_rules" in found:
        given["own_rules"] = read_own_rules(found["own_rules"], problems, parameters_of)
    given["said_at"] = {**given["said_at"], **_places(found, problems.file)}
    if root is not None:
        check_together(given, root, problems)
    problems.raise_any()
    return given


def _top_level(root: yaml.Node | None, problems: Problems) -> dict[str, yaml.Node]:
    found = {}
    for key, key_node, value in entries(root, problems, "profile") if root is not None else ():
        if key in KEYS:
            found[key] = value
        else:
            problems.add(key_node, unknown("key", key, KEYS))
    return found


def _places(found: Mapping[str, yaml.Node], file: str) -> dict[str, str]:
    """Where each key of a section stands, each rule, and what is under it, by such as `rules.pierce.clearance`."""
    said: dict[str, str] = {}
    nodes = [(section, node) for section, node in found.items() if section in (*SECTIONS, "rules")]
    while nodes:
        path, node = nodes.pop()
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            said[f"{path}.{key.value}"] = f"{file}:{key.start_mark.line + 1}"
            if "." not in path:  # no deeper: an alias may lead back
                nodes.append((f"{path}.{key.value}", value))
    return said


def _base(node: yaml.Node, problems: Problems, load_base: Callable[[str], GivenValues]) -> GivenValues:
    name = _read(node, Text(), problems, "based_on")
    if name is None:
        return {}
    try:
        return load_base(name)
    except InputError as error:
        if error.line is not None:
            raise
        problems.add(node, f"based_on: {error}")
        return {}


def _read(node: yaml.Node, kind: Any, problems: Problems, what: str) -> Any:
    """The value of a node, or None with a problem noted."""
    try:
        return kind.read(node)
    except Unfit as error:
        problems.add(error.node or node, f"{what}: {error}")
        return None


def read_fields(
    members: Iterable[tuple[str, yaml.Node, yaml.Node]],
    base: T,
    problems: Problems,
    what: str,
    other: Iterable[str] = (),
) -> T:
    """The dataclass `base` with the options that a mapping gives; `other` are valid keys that are read elsewhere."""
    options = {option.key: option for option in options_of(base)}
    given: GivenValues = {}
    for key, key_node, value in members:
        if key not in options:
            comma = "; decimals are written with a point" if key.isdigit() and is_empty(value) else ""
            problems.add(key_node, f"{what}: {unknown('key', key, [*options, *other])}{comma}")
            continue
        if isinstance(options[key].kind, Members):
            inner = entries(value, problems, f"{what}.{key}")
            given[options[key].name] = read_fields(inner, getattr(base, options[key].name), problems, f"{what}.{key}")
            continue
        try:
            given[options[key].name] = options[key].kind.read(value)
        except Unfit as error:
            problems.add(error.node or value, f"{what}.{key}: {error}")
    return dataclasses.replace(base, **given)


def read_rules(
    node: yaml.Node, base: Mapping[str, RuleSetting], problems: Problems, known: Mapping[str, Rule[Any]]
) -> dict[str, RuleSetting]:
    """Every rule's setting: that of `base`, with what the mapping under `rules` gives in its place."""
    settings = dict(base)
    for name, key_node, value in entries(node, problems, "rules"):
        if name in known:
            with at_work(known[name], "its options"):
                settings[name] = _read_rule(value, known[name], settings[name], problems)
        else:
            problems.add(key_node, f"rules: {unknown('rule', name, known)}")
    return settings


def _read_rule(node: yaml.Node, rule: Rule[Any], base: RuleSetting, problems: Problems) -> RuleSetting:
    what = f"rules.{rule.id}"
    if not isinstance(node, yaml.MappingNode):
        strength = _read(node, Choice(rule.strengths), problems, what) or base.strength
        return RuleSetting(strength, _weight(rule, strength, base.weight), base.options)
    members = list(entries(node, problems, what))
    said = {key: value for key, _, value in members if key in ("strength", "weight")}
    strength, weight = base.strength, base.weight
    if "strength" in said:
        strength = _read(said["strength"], Choice(rule.strengths), problems, f"{what}.strength") or strength
    if "weight" in said:
        weight = _read(said["weight"], LENGTH, problems, f"{what}.weight")
        if strength != "soft":
            problems.add(said["weight"], f"{what}.weight: only a soft rule has a weight, this one is {strength}")
    rest = [member for member in members if member[0] not in said]
    options = read_fields(rest, base.options, problems, what, other=("strength", "weight"))
    if rule.brought and rest and strength == "off" and "strength" not in said:
        problems.add(node, f"{what}: rules from outside are off unless a profile says otherwise: {_say_strength(rule)}")
    return RuleSetting(strength, _weight(rule, strength, weight), options)


def _say_strength(rule: Rule[Any]) -> str:
    return f"give its strength too, one of {', '.join(rule.strengths)}"


def _weight(rule: Rule[Any], strength: str, weight: float | None) -> float | None:
    if strength != "soft":
        return None
    return rule.default_weight if weight is None else weight


def read_locks(node: yaml.Node, problems: Problems) -> tuple[Lock, ...]:
    """The locks of a profile, each a mapping of a contour or part and what is decided of it."""
    locks = []
    for number, entry in enumerate(items(node, problems, "locks"), 1):
        what = f"locks[{number}]"
        so_far = len(problems.found)
        lock = read_fields(entries(entry, problems, what), Lock(place=problems.place(entry)), problems, what)
        if len(problems.found) == so_far and (wrong := lock.wrong()):
            problems.add(entry, f"{what}: {wrong}")
        locks.append(lock)
    return tuple(locks)
