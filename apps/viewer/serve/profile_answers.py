"""What the desk answers about the profile of a nest: its rules, their pages, and its text with other values."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kerfwise.apps.authoring.profile_check import expect_usable
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_there, read_named
from kerfwise.jobs.inputs import plant_of
from kerfwise.postproc.report.rule_pictures import case_picture, rule_panels
from kerfwise.rules.options.kind import Choice, Flag, Text
from kerfwise.rules.options.option import Option, options_of
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.profile.load import DEFAULT, shipped_profiles
from kerfwise.rules.profile.profile_yaml import RuleValue, with_rule_values
from kerfwise.rules.rule import Rule, RuleSetting
from kerfwise.rules.run_cases import cases_of

from .plan_request import Answers, PlanRequest, enter_nest_folder, job_in

_NEW = re.compile(r"[^\W_][\w.-]{0,60}\.ya?ml")
_BEGUN = "# Begun on the page of `kerfwise serve`: what is not said here, the profile has that it is based on.\n"


def profile_answers() -> Answers:
    """The questions about profiles."""
    return {
        "profile": profile_told,
        "profile_sha256": profile_sha256,
        "rule": rule_told,
        "profile_text": profile_text,
        "profile_files": profile_files,
    }


def profile_told(wanted: PlanRequest) -> dict[str, Any]:
    """The profile of a nest, as its file says it, and what the job file sets of it for this nest alone."""
    plant = _plant(wanted)
    job = job_in(wanted)
    own = {rule.id: rule for rule in plant.own_rules}
    known = plant.known_rules()
    return {
        "name": escape_text(plant.name),
        "path": str(_path(plant)),
        "shipped": _shipped(plant),
        "sha256": _sha256(_bytes_of(_path(plant))),
        "for_this_nest": {} if job is None else {one.key: one.text for one in job.settings},
        "rules": [
            *(_rule(plant, known[name], plant.rules[name]) for name in sorted(plant.rules)),
            *(_rule(plant, plant.rulebook()[name], RuleSetting(own[name].strength, own[name].weight, None), False)
              for name in own),
        ],
    }  # fmt: skip


def rule_told(wanted: PlanRequest, rule: str) -> dict[str, Any]:
    """The page of a rule, and pictures (SVG) of a case that is wrong and one that is right."""
    plant = _plant(wanted)
    book = plant.rulebook()
    if rule not in book:
        raise InputError(f"the profile has no rule {escape_text(rule)!r}")
    return {"page": shown_page(book[rule]), **_pictures(rule, plant.known_rules())}


def shown_page(rule: Rule[Any]) -> str:
    """The page of a rule without signs that cannot be shown; lines stay lines."""
    return "\n".join(map(escape_text, rule.page().splitlines()))


def profile_text(wanted: PlanRequest, values: Sequence[RuleValue], new: str | None = None) -> dict[str, Any]:
    """The text of the profile with other values, or of a `new` one that is based on it, and where that is to stand.

    Raises InputError if a profile cannot say this: with file, line and column; or the new one cannot have its name.
    """
    plant = _plant(wanted)
    path = _path(plant)
    before = _bytes_of(path)
    text = before.decode("utf-8")  # it was read as a profile
    if new is not None:
        path = _new_path(wanted, new)
        based_on = Path(plant.file).stem if _shipped(plant) else _from(path.parent, plant)
        text = f"{_BEGUN}based_on: {Text().write(based_on)}\n"
    changed = with_rule_values(text, [(rule, key, value) for rule, key, value in values])
    try:
        expect_usable(changed, path, wanted.trust)
    except OSError as error:
        raise InputError(f"cannot write here: {error.strerror}", file=path) from None
    return {"path": str(path), "text": changed, "sha256": None if new is not None else _sha256(before)}


def profile_files(wanted: PlanRequest) -> list[str]:
    """The files that the profile of a nest is made of."""
    return [str(Path(place).resolve()) for place in _plant(wanted).read_from]


def profile_sha256(wanted: PlanRequest) -> str:
    """Of the profile as it is on disk now, and all that it is made of."""
    return _plant(wanted).sha256


def _plant(wanted: PlanRequest) -> ActiveRules:
    """The profile of a nest, without what its job file sets for it."""
    enter_nest_folder(wanted)
    job = job_in(wanted)
    named = None if job is None else job.profile_path
    return plant_of(DEFAULT if named is None else named, wanted.trust)


def _path(plant: ActiveRules) -> Path:
    return Path(plant.read_from[-1]).resolve()


def _shipped(plant: ActiveRules) -> bool:
    return plant.read_from[-1] in {str(file) for file in shipped_profiles().values()}


def _new_path(wanted: PlanRequest, name: str) -> Path:
    """Where a new profile is to stand: beside the nest."""
    path = Path(wanted.nest).parent.resolve() / name
    if not _NEW.fullmatch(name) or name.endswith((".job.yaml", ".job.yml")):
        raise InputError(f"{escape_text(name)!r}: expected a file's name such as our-plasma.yaml")
    if path.is_symlink() or is_there(path):
        raise InputError(f"there is a file {name} already: choose another name")
    return path


def _from(folder: Path, plant: ActiveRules) -> str:
    """The file of a profile, as one in this folder names it."""
    path = _path(plant)
    return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else str(path)


def _rule(plant: ActiveRules, rule: Rule[Any], setting: RuleSetting, settable: bool = True) -> dict[str, Any]:
    key = f"rules.{rule.id}"
    options = options_of(setting.options) if settable else ()
    return {
        "id": rule.id,
        "sentence": escape_text(rule.sentence),
        "source": escape_text(rule.source),
        "brought": escape_text(rule.brought),
        "settable": settable,
        "strengths": list(rule.strengths),
        "strength": setting.strength,
        "weight": None if setting.weight is None else LENGTH.write(setting.weight),
        "default_weight": LENGTH.write(rule.default_weight),
        "said_at": escape_text(plant.said_at.get(key, "")),
        "options": [_option(plant, key, option, setting.options) for option in options],
    }


def _option(plant: ActiveRules, key: str, option: Option, owner: Any) -> dict[str, Any]:
    kind = option.kind
    words = kind.words if isinstance(kind, Choice) else ("true", "false") if isinstance(kind, Flag) else ()
    return {
        "key": option.key,
        "help": option.help,
        "value": kind.write(getattr(owner, option.name)),
        "default": kind.write(option.default),
        "unit": option.unit,
        "expected": kind.expected(),
        "words": list(words),
        "said_at": escape_text(plant.said_at.get(f"{key}.{option.key}", "")),
    }


def _pictures(rule: str, known: Mapping[str, Rule[Any]]) -> dict[str, str | None]:
    """Wrong and right, each as a picture; None where the rule has no such case."""
    try:
        cases = cases_of(rule, known)
    except InputError:
        cases = ()
    panels = rule_panels(cases)
    return {word: case_picture([panels[word]]) if word in panels else None for word in ("wrong", "right")}


def _bytes_of(path: Path) -> bytes:
    """A profile as it is now: what it was read from may be another file meanwhile, or a pipe."""
    return read_named(path, "the profile", MOST_BYTES_OF_YAML)


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
