"""The published schema says what the reader of profiles does."""

from __future__ import annotations

import json
from importlib import resources
from typing import Any

import jsonschema
import pytest
import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.profile_yaml import profile_yaml
from kerfwise.rules.profile.schema import profile_schema

VALIDATOR = jsonschema.Draft202012Validator(profile_schema())


class Yaml12(yaml.SafeLoader):
    """YAML as editors read it: `off` is a word, not false."""


Yaml12.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in found if tag != "tag:yaml.org,2002:bool" or first in "tTfF"]
    for first, found in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


def data(text: str) -> Any:
    return yaml.load(text, Loader=Yaml12)  # a SafeLoader


def test_published_schema_is_up_to_date() -> None:
    published = resources.files("kerfwise.rules.profile") / "profile.schema.json"
    made = json.dumps(profile_schema(), indent=1, ensure_ascii=False) + "\n"
    assert published.read_text(encoding="utf-8") == made, "run python -m kerfwise.rules.profile.schema"


def test_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(profile_schema())


@pytest.mark.parametrize("name", shipped_profiles())
def test_shipped_profiles_and_what_show_prints_are_valid(name: str) -> None:
    VALIDATOR.validate(data(shipped_profiles()[name].read_text(encoding="utf-8")))
    shown = load_profile(name)  # with the rules of whatever packages are installed
    jsonschema.Draft202012Validator(profile_schema(shown.known_rules())).validate(data(profile_yaml(shown)))
    VALIDATOR.validate(yaml.safe_load(shipped_profiles()[name].read_text(encoding="utf-8")))  # YAML 1.1: `off` is false


@pytest.mark.parametrize("word", ["off", "false"])
def test_a_rule_is_off_in_yaml_of_either_version(word: str, tmp_path: Any) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text(f"rules: {{level-ahead: {word}, zone-order: {{strength: {word}}}}}\n", encoding="utf-8")
    rules = load_profile(path).rules
    assert [rules[name].strength for name in ("level-ahead", "zone-order")] == ["off", "off"]
    for read in (data, yaml.safe_load):
        assert VALIDATOR.is_valid(read(path.read_text(encoding="utf-8")))


def test_a_rule_that_cannot_be_off_is_not_false_either() -> None:
    assert not VALIDATOR.is_valid({"rules": {"locks": False}})


def test_bare_profile_is_valid() -> None:
    VALIDATOR.validate(data(profile_yaml(Profile("plant"))))


@pytest.mark.parametrize(
    "text",
    [
        "machin: {}",
        "machine: {cut_feed: quick}",
        "machine: {cut_feed: 0}",
        "material: {kerf: -1}",
        "leads: {entries: 1.5}",
        "leads: {lead: curl}",
        "rules: {level-ahed: off}",
        "rules: {level-ahead: strong}",
        "rules: {locks: off}",
        "rules: {marks-first: {strength: soft}}",
        "rules: {zone-order: {zone_contours: 0}}",
        "locks: [{contour: A, part: B, zone: 1}]",
        "locks: [{before: A}]",
        "locks: {contour: A}",
    ],
)
def test_schema_and_reader_refuse_the_same(text: str, tmp_path: Any) -> None:
    assert not VALIDATOR.is_valid(data(text))
    path = tmp_path / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError):
        load_profile(path)
