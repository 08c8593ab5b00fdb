"""The key `models` of a profile: rules in MiniZinc files, each a new rule, or in the place of a shipped one."""

from __future__ import annotations

import dataclasses
import glob
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.errors import InputError
from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.plain_values import Text
from kerfwise.rules.options.yaml_positions import Place, Problems, wrong_at
from kerfwise.rules.rule import Rule, RuleSetting

from .rule_files import GivenFiles, names_of_files

WHAT = "rules in MiniZinc files beside the profile, such as plant/*.mzn; one named as a shipped rule takes its place"


@dataclass(frozen=True, slots=True)
class ModelSource:
    """A model file that a profile names, alone or by a pattern."""

    path: Path
    place: Place | None = field(default=None, compare=False)


def with_model_files(node: yaml.Node, given: GivenFiles, problems: Problems) -> GivenFiles:
    """The fields `models`, `further_rules` and `rules` of a profile, with the rules of the files that a node names.

    A new rule is hard until `rules` says otherwise; one in the place of a shipped rule has that one's strength. Files
    of a profile that this one is based on stay; a file of the same name takes their place.
    """
    sources = {source.path.name: source for source in given["models"]}
    rules: dict[str, Rule[Any]] = dict(given["further_rules"])
    settings: dict[str, RuleSetting] = dict(given["rules"])
    taken: dict[str, ModelRule] = {}
    for path, entry in _paths(node, problems):
        place = problems.place(entry)
        try:
            rule = read_model_rule(path)
        except InputError as error:
            if error.file is None:
                raise wrong_at(place, f"models: {error.message}") from None
            raise
        if rule.id in taken:
            other = taken[rule.id].file.path
            problems.add(entry, f"models: two files state the rule {rule.id}: {other} and {path}")
            continue
        before = rules.get(rule.id)
        if before is not None and not isinstance(before, ModelRule):
            problems.add(entry, f"models: the name {rule.id!r} is taken by a rule of {before.brought}; rename the file")
            continue
        taken[rule.id] = rule
        rules[rule.id] = rule
        sources[path.name] = ModelSource(path, place)
        settings[rule.id] = _setting(rule, settings.get(rule.id))
    return {"models": tuple(sources.values()), "further_rules": rules, "rules": settings}


def _setting(rule: ModelRule, before: RuleSetting | None) -> RuleSetting:
    """The setting of a rule that a file brings: that of the rule whose place it takes, with its options."""
    if before is None:
        return RuleSetting(rule.default, None, rule.Options())
    names = (o.name for o in options_of(rule.Options))
    given = {name: getattr(before.options, name) for name in names if hasattr(before.options, name)}
    return dataclasses.replace(before, options=rule.Options(**given))


def _paths(node: yaml.Node, problems: Problems) -> Iterator[tuple[Path, yaml.Node]]:
    """Every file that is named, in order; patterns give theirs by name."""
    folder = Path(problems.file).parent
    for name, entry in names_of_files(node, "models", problems):
        if glob.has_magic(name):
            try:
                found = sorted(path for path in folder.glob(name) if path.suffix == ".mzn" and is_file(path))
            except (OSError, ValueError, NotImplementedError):  # not relative to the folder, or no name at all
                found = []
            if not found:
                problems.add(entry, f"models: no MiniZinc file matches {str(folder / name)!r}")
            yield from ((path, entry) for path in found)
        elif (folder / name).is_dir():
            problems.add(entry, f"models: {str(folder / name)!r} is a folder: name the files in it, as in {name}/*.mzn")
        elif not is_file(folder / name):
            problems.add(entry, f"models: there is no file {str(folder / name)!r}")
        else:
            yield folder / name, entry


def models_schema() -> dict[str, Any]:
    """JSON Schema of `models`."""
    file = Text().schema()
    return {"description": WHAT, "anyOf": [file, {"type": ["array", "null"], "items": file}]}
