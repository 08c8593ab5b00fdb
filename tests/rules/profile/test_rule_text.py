"""Values of rules are set in the text of a profile, and nothing else in it changes."""

from __future__ import annotations

import pytest
import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.load import profile_text, shipped_profiles
from kerfwise.rules.profile.profile_yaml import with_rule_values

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
