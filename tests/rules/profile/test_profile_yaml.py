"""The published schema says what the reader of profiles does."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from kerfwise import InputError, Profile, load_profile
from kerfwise.rules.profile.load import profile_text, shipped_profiles
from kerfwise.rules.profile.profile_yaml import differences, flat, profile_yaml, with_rule_values
from kerfwise.rules.profile.schema import profile_schema
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.docs.test_profile_page import keys_of

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


def profile(folder: Path, text: str) -> Profile:
    file = folder / "other.yaml"
    file.write_text(text)
    return load_profile(file)


@pytest.mark.parametrize("name", shipped_profiles())
def test_a_profile_does_not_differ_from_itself(name: str) -> None:
    assert differences(load_profile(name), load_profile(name)) == ()


@pytest.mark.parametrize(
    ("text", "key", "a", "b"),
    [
        ("material: {kerf: 2 mm}", "material.kerf", "1.5 mm", "2 mm"),
        ("cuts: {links: {longest: 40 mm}}", "cuts.links.longest", "0 mm", "40 mm"),
        ("rules: {pierce: {clearance: 2 mm}}", "rules.pierce.clearance", None, "2 mm"),
        ("rules: {level-ahead: off}", "rules.level-ahead", "hard", "off"),
        ("locks: [{contour: A, before: B}]", "locks {contour: A, before: B}", "-", "locked"),
        ("own_rules: [{name: n, first: true}]", "own_rules n", "-", None),
    ],
)
def test_one_key(text: str, key: str, a: str | None, b: str | None, tmp_path: Path) -> None:
    base = load_profile()
    (found,) = differences(base, profile(tmp_path, f"based_on: {base.name}\n{text}\n"))
    assert found.key == key
    assert found.a == a or a is None
    assert found.b == b or b is None
    assert found.b_from in ("-", f"{tmp_path}/other.yaml:2")
    (turned,) = differences(profile(tmp_path, f"based_on: {base.name}\n{text}\n"), base)
    assert (turned.a, turned.b) == (found.b, found.a)


def test_an_option_of_a_rule_is_from_the_file_that_says_it(tmp_path: Path) -> None:
    """Not from one that says another option of the same rule."""
    (tmp_path / "base.yaml").write_text("rules:\n  pierce:\n    clearance: 2 mm\n")
    for base, clearance_from in (("based_on: base.yaml", f"{tmp_path}/base.yaml:3"), ("name: alone", "default")):
        mine = profile(tmp_path, f"{base}\nrules: {{pierce: {{splash: 1 mm}}}}\n")
        found = {one.key: one.a_from for one in differences(mine, load_profile())}
        assert found["rules.pierce.clearance"] == clearance_from
        assert found["rules.pierce.splash"] == f"{tmp_path}/other.yaml:2"


def test_every_key_of_the_sections_is_compared() -> None:
    schema = profile_schema()
    named = {key for key, _ in flat(load_profile())}
    for section in ("machine", "material", "leads", "cuts", "drawing", "prices", "heat"):
        assert {f"{section}.{key}" for key in keys_of(schema["properties"][section])} <= named


TEXT = "name: ours  # ours\nrules:\n  pierce: hard  # why\n  heat-lag: {strength: soft, weight: 50 mm}\n"


@pytest.mark.parametrize(
    ("value", "old", "new"),
    [
        (("pierce", "strength", "off"), "pierce: hard", "pierce: off"),
        (("pierce", "clearance", "2 mm"), "pierce: hard", "pierce: {strength: hard, clearance: 2 mm}"),
        (("heat-lag", "weight", "80 mm"), "weight: 50 mm", "weight: 80 mm"),
        (("heat-lag", "strength", "off"), "{strength: soft, weight: 50 mm}", "{strength: off}"),
        (("no-islands", "strength", "off"), "  pierce", "  no-islands: off\n  pierce"),
        (("no-islands", "weight", "9 mm"), "  pierce", "  no-islands:\n    weight: 9 mm\n  pierce"),
    ],
)
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_by_hand(value: tuple[str, str, str], old: str, new: str, ends: str, mark: str) -> None:
    made = with_rule_values(mark + TEXT.replace("\n", ends), [value])
    assert made == mark + TEXT.replace(old, new).replace("\n", ends)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("rules: {a: &x hard, b: *x}\n", "written so that this cannot be changed here"),
        ("rules: 3\n", "written so that this cannot be changed here"),
        ("- rules\n", "expected a mapping"),
        ("rules: [\n", "not YAML"),
    ],
)
def test_what_cannot_be_changed_alone_is_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        with_rule_values(text, [("b", "strength", "off")])


@pytest.mark.parametrize("value", ["", " ", "1\nname: x", "~", "{", "off, x: 1}"])
def test_a_value_is_one_value(value: str) -> None:
    with pytest.raises(InputError):
        with_rule_values(TEXT, [("heat-lag", "weight", value)])


@pytest.mark.parametrize("name", shipped_profiles())
def test_there_and_back_is_the_same_text(name: str) -> None:
    text = profile_text(name)
    said = {rule: said for rule, said in yaml.safe_load(text)["rules"].items() if said in ("hard", False)}
    there = with_rule_values(text, [(rule, "strength", "off" if hard else "hard") for rule, hard in said.items()])
    assert there != text
    assert with_rule_values(there, [(rule, "strength", hard or "off") for rule, hard in said.items()]) == text


@pytest.mark.parametrize("like", shipped_profiles())
def test_a_copy_says_the_same_and_keeps_the_comments(
    like: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    ended = kerfwise("profile", "new", "shop", "--like", like)
    assert (ended.code, ended.err) == (0, "")
    assert kerfwise("profile", "check", "shop.yaml").code == 0
    assert load_profile("shop.yaml").name == "shop"
    assert differences(load_profile("shop.yaml"), load_profile(like)) == ()
    words = [
        line for line in profile_text(like).splitlines() if line.startswith("# ") and "language-server" not in line
    ]
    assert [line for line in Path("shop.yaml").read_text().splitlines() if line in words] == words
