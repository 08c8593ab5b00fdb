"""One value of a YAML text is set, and nothing else changes."""

from __future__ import annotations

from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rules.options.yaml_positions import with_value, without_value
from kerfwise.rules.profile.load import profile_text, shipped_profiles


@pytest.mark.parametrize(
    ("text", "path", "made"),
    [
        ("a: 1  # one\nb: 2\n", ["a"], "a: 9  # one\nb: 2\n"),
        ("a: 1\n", ["b"], "a: 1\n\nb: 9\n"),
        ("", ["a", "b"], "a:\n  b: 9\n"),
        ("# only words\n", ["a"], "# only words\na: 9\n"),
        ("s:\n  # first\n  a: 1\n  b: 2\n", ["s", "c"], "s:\n  # first\n  c: 9\n  a: 1\n  b: 2\n"),
        ("s:\n    a: 1\n", ["s", "b", "c"], "s:\n    b:\n      c: 9\n    a: 1\n"),
        ("s: {a: 1}\n", ["s", "b", "c"], "s: {b: {c: 9}, a: 1}\n"),
        ("s: {}\nt: 1\n", ["s", "a"], "s: {a: 9}\nt: 1\n"),
        ("s:\n- 1\n- 2\nt: 3\n", ["s"], "s: 9\nt: 3\n"),
        ("s: [1,\n  2]  # two\n", ["s"], "s: 9  # two\n"),
        ("s: plain\n", ["s", "a"], "s: {a: 9}\n"),
    ],
)
def test_by_hand(text: str, path: list[str], made: str) -> None:
    assert with_value(text, path, "9") == made


def test_a_section_without_a_key_yet() -> None:
    made = with_value("s:\nt: 1\n", ["s", "a"], "9")
    assert yaml.safe_load(made) == {"s": {"a": 9}, "t": 1}


@given(
    st.sampled_from(list(shipped_profiles())),
    st.sampled_from(
        [("name",), ("machine", "head"), ("material", "grain"), ("rules", "pierce"), ("prices", "currency")]
    ),
    st.sampled_from(["9", "[1, 2]", "{a: b}", "2.5 mm"]),
)
def test_all_but_the_value_stays(name: str, path: tuple[str, ...], value: str) -> None:
    text = profile_text(name)
    made = with_value(text, path, value)
    data: dict[str, Any] = yaml.safe_load(text)
    inner = data
    for key in path[:-1]:
        inner = inner.setdefault(key, {})
    inner[path[-1]] = yaml.safe_load(value)
    assert yaml.safe_load(made) == data
    comments = [line[line.index("#") :] for line in text.splitlines() if "#" in line]
    kept = [line[line.index("#") :] for line in made.splitlines() if "#" in line]
    assert kept == comments or path == ("rules", "pierce"), "a mapping that is replaced takes its own comments with it"


@pytest.mark.parametrize(
    ("text", "path", "made"),
    [
        ("a: 1  # one\nb: 2  # two\n", ["a"], "b: 2  # two\n"),
        ("s:\n  a: 1\n  # second\n  b: 2  # two\nt: 3\n", ["s", "b"], "s:\n  a: 1\n  # second\nt: 3\n"),
        ("s:\n  a: 1\nt: 3\n", ["s", "a"], "t: 3\n"),
        ("s: {a: 1, b: 2, c: 3}  # all\n", ["s", "a"], "s: {b: 2, c: 3}  # all\n"),
        ("s: {a: 1, b: 2, c: 3}  # all\n", ["s", "c"], "s: {a: 1, b: 2}  # all\n"),
        ("s: {a: 1}\nt: 3\n", ["s", "a"], "t: 3\n"),
        ("s: {a: 1}\n", ["s", "b"], "s: {a: 1}\n"),
        ("s: 1\n", ["s", "b"], "s: 1\n"),
        ("a: 1\nb: 2", ["b"], "a: 1\n"),
    ],
)
def test_a_key_goes(text: str, path: list[str], made: str) -> None:
    assert without_value(text, path) == made
