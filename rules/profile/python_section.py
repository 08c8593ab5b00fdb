"""The key `python` of a profile: files of rules in Python, run where they are trusted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.yaml_positions import Problems, wrong_at
from kerfwise.rules.outside import PythonFile, is_trusted, refusal, rules_in_file
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleSetting

from .rule_files import GivenFiles, names_of_files


def with_python_files(node: yaml.Node, given: GivenFiles, problems: Problems, trust: bool) -> GivenFiles:
    """The fields `python`, `further_rules` and `rules` of a profile, with the rules of the files that a node names.

    A file's rules have the strength that they give themselves. Files of a profile that this one is based on stay.

    Raises
    ------
    InputError
        If a file is not trusted, or its rules cannot be used: nothing after it would mean anything.
    """
    files = list(given["python"])
    rules: dict[str, Rule[Any]] = dict(given["further_rules"])
    settings: dict[str, RuleSetting] = dict(given["rules"])
    for name, entry in names_of_files(node, "python", problems):
        file = PythonFile(name, Path(problems.file).parent / name, problems.place(entry))
        for rule in _rules(file, trust):
            if rules.get(rule.id) is rule:
                continue
            if rule.id in RULES or rule.id in rules:
                other = rules[rule.id].brought if rule.id in rules else "kerfwise itself"
                raise wrong_at(
                    file.place, f"python: two rules are called {rule.id!r}: one of {rule.brought}, one of {other}; "
                    "choose another name"
                )  # fmt: skip
            rules[rule.id] = rule
            weight = rule.default_weight if rule.default == "soft" else None
            settings[rule.id] = RuleSetting(rule.default, weight, rule.Options())
        if file.path.resolve() not in {other.path.resolve() for other in files}:
            files.append(file)
    return {"python": tuple(files), "further_rules": rules, "rules": settings}


def _rules(file: PythonFile, trust: bool) -> tuple[Rule[Any], ...]:
    if file.path.suffix != ".py":
        raise wrong_at(file.place, f"python: expected a Python file such as my_rule.py, got {file.file!r}")
    if not is_file(file.path):
        raise wrong_at(file.place, f"python: there is no file {str(file.path)!r}")
    if not trust and not is_trusted(file.path):
        raise wrong_at(file.place, f"python: {refusal(file.path)}")
    try:
        return rules_in_file(file.path)
    except InputError as error:
        if error.file is not None:
            raise
        raise wrong_at(file.place, f"python: {error.message}") from error
