"""An entry of `own_rules` that names a file, read from YAML: `{file: rivets_first.mzn, parameters: {most: 800}}`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.contents import is_file
from kerfwise.rules.options.kind import OptionKind, Unfit
from kerfwise.rules.options.plain_values import Text
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, entries

from .own_rule import OwnFile
from .plain_keys import KeyedNodes, plain_values

FILE_KEYS = ("file", "name", "why", "strength", "weight", "parameters")

ParametersOf = Callable[[Path], Mapping[str, OptionKind]]
"""The parameters that the rule in a file declares, by key; raises `InputError` where the file is no rule."""


def read_file_entry(
    entry: yaml.Node, members: KeyedNodes, problems: Problems, what: str, parameters_of: ParametersOf
) -> OwnFile | None:
    """The entry; None, with what is wrong noted in `problems`, where it cannot be read.

    Raises
    ------
    InputError
        If the entry gives parameters and the file is no rule.
    """
    so_far = len(problems.found)
    given = plain_values(members, problems, what)
    for key, key_node, value in members:
        if key == "file":
            try:
                given["file"] = Text().read(value)
            except Unfit as error:
                problems.add(value, f"{what}.file: {error}")
        elif key not in FILE_KEYS:
            problems.add(key_node, f"{what}: {unknown('key of a rule in a file', key, FILE_KEYS)}")
    if len(problems.found) > so_far:
        return None
    given.setdefault("name", Path(given["file"]).stem)
    made = OwnFile(place=problems.place(entry), **given)
    node = next(value for key, _, value in members if key == "file")
    if made.path.suffix != ".mzn":
        problems.add(node, f"{what}.file: expected a MiniZinc file such as plant_rule.mzn, got {made.file!r}")
        return made
    if not is_file(made.path):
        problems.add(node, f"{what}.file: there is no file {str(made.path)!r}")
        return made
    return with_parameters(made, members, problems, what, parameters_of)


def with_parameters(
    rule: OwnFile, members: KeyedNodes, problems: Problems, what: str, parameters_of: ParametersOf
) -> OwnFile:
    """The rule with the `parameters` among the members of its entry; what is wrong with them is noted."""
    found = [value for key, _, value in members if key == "parameters"]
    if not found:
        return rule
    kinds = parameters_of(rule.path)
    given: dict[str, Any] = {}
    for key, key_node, value in entries(found[0], problems, f"{what}.parameters"):
        if key not in kinds:
            said = unknown("parameter", key, list(kinds)) if kinds else f"{rule.file} declares no parameter"
            problems.add(key_node, f"{what}.parameters: {said}")
            continue
        try:
            given[key] = kinds[key].read(value)
        except Unfit as error:
            problems.add(error.node or value, f"{what}.parameters.{key}: {error}")
    return rule.with_parameters(given)
