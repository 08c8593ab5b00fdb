"""What two profiles say differently."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.profile_yaml import differences, flat
from kerfwise.rules.profile.schema import profile_schema
from kerfwise.tests.docs.test_profile_page import keys_of


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
