"""Places of nodes, and the mistakes of YAML itself."""

from __future__ import annotations

from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError
from kerfwise.rules.options.yaml_positions import (
    Place,
    Problems,
    compose,
    entries,
    items,
    plain,
    with_item,
    with_value,
    without_value,
    wrong_at,
)
from kerfwise.rules.profile.load import profile_text, shipped_profiles


def node_of(text: str) -> yaml.Node:
    node = compose(text, "plant.yaml")
    assert node is not None
    return node


def test_every_node_has_its_place() -> None:
    problems = Problems("plant.yaml")
    ((key, key_node, value),) = entries(node_of("\n  kerf: [1,\n    2]"), problems, "profile")
    assert key == "kerf"
    assert str(problems.place(key_node)) == "plant.yaml:2:3"
    assert [str(problems.place(n)) for n in items(value, problems, "kerf")] == ["plant.yaml:2:10", "plant.yaml:3:5"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1", "plant.yaml:1:6: not YAML: while parsing a flow sequence, expected ',' or ']', but got "
         "'<stream end>'"),
        ("a: 1\n b: 2", "plant.yaml:2:3: not YAML: mapping values are not allowed here"),
        ("a: \x00", "plant.yaml: not YAML: special characters are not allowed (character 0)"),
        ("[" * 500, "plant.yaml: not a profile: the YAML is nested too deeply"),
        ("a: 1\n---\nb: 2", "plant.yaml:2:1: not YAML: expected a single document in the stream, but found another "
         "document"),
    ],
)  # fmt: skip
def test_what_is_not_yaml(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        compose(text, "plant.yaml")
    assert str(caught.value) == message


def test_problems_are_reported_together_in_order() -> None:
    problems = Problems("plant.yaml")
    keys = [key for key, _, _ in entries(node_of("a: 1\n[2]: 3\na: 4"), problems, "machine")]
    assert keys == ["a"]
    with pytest.raises(InputError) as caught:
        problems.raise_any()
    assert str(caught.value).splitlines() == [
        "plant.yaml:2:1: machine: expected a name as the key, got a list of 1",
        "  - plant.yaml:3:1: machine: key 'a' is given twice",
    ]


@pytest.mark.parametrize(("text", "got"), [("[1, 2]", "a list of 2"), ("word", "'word'")])
def test_mapping_expected(text: str, got: str) -> None:
    problems = Problems("plant.yaml")
    assert list(entries(node_of(text), problems, "rules")) == []
    assert problems.found == [(1, 1, f"rules: expected a mapping (key: value), got {got}")]


def test_list_expected() -> None:
    problems = Problems("plant.yaml")
    assert items(node_of("a: 1"), problems, "locks") == []
    assert problems.found == [(1, 1, "locks: expected a list, got a mapping")]


def test_nothing_given_is_nothing_wrong() -> None:
    problems = Problems("plant.yaml")
    assert list(entries(node_of("~"), problems, "rules")) == items(node_of("~"), problems, "locks") == []
    problems.raise_any()
    assert compose("# only a comment", "plant.yaml") is None


def test_plain_data() -> None:
    assert plain(node_of("{a: [1, two, 3.5, true, ~]}")) == {"a": [1, "two", 3.5, True, None]}


def test_error_at_a_place() -> None:
    assert str(wrong_at(Place("plant.yaml", 3, 4), "no")) == "plant.yaml:3:4: no"
    assert str(wrong_at(None, "no")) == "no"


@pytest.mark.parametrize(
    ("text", "path", "made"),
    [
        ("a: 1  # one\nb: 2\n", ["a"], "a: 9  # one\nb: 2\n"),
        ("a: 1\n", ["b"], "a: 1\nb: 9\n"),
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
    ("text", "made"),
    [
        ("", "s:\n  - 9\n"),
        ("# only words\n", "# only words\ns:\n  - 9\n"),
        ("t: 1\n", "t: 1\ns:\n  - 9\n"),
        ("s:\nt: 1\n", "s:\n  - 9\nt: 1\n"),
        ("s: []  # none\n", "s:\n  - 9  # none\n"),
        ("{t: 1}\n", "{s: [9], t: 1}\n"),
        ("s: [1, 2]  # two\n", "s: [1, 2, 9]  # two\n"),
        ("s:\n- 1  # one\n- {a: 2}  # two\n# then\nt: 3\n", "s:\n- 1  # one\n- {a: 2}  # two\n- 9\n# then\nt: 3\n"),
        ("s:\n    -   1", "s:\n    -   1\n    - 9"),
        ("s:\n  - a: 1\n    b: 2\n", "s:\n  - a: 1\n    b: 2\n  - 9\n"),
        ("s:\n  - 'a\n    b'\n", "s:\n  - 'a\n    b'\n  - 9\n"),
    ],
)
def test_an_entry_more(text: str, made: str) -> None:
    assert with_item(text, "s", "9") == made
    assert yaml.safe_load(made)["s"][-1] == 9


@pytest.mark.parametrize("key", ["own:a b.c", "# no", "P1.outer", "7", "a: b", '"q"', "yes, no"])
def test_any_key_is_written_so_that_it_reads_back(key: str) -> None:
    block = with_value("s:\n  a: 1\n", ["s", key], "9")
    assert yaml.compose(block).value[0][1].value[0][0].value == key
    flow = with_value("s: {a: 1}\n", ["s", key], "9")
    assert yaml.compose(flow).value[0][1].value[0][0].value == key


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


def test_an_empty_line_parts_a_new_key_where_empty_lines_part_others() -> None:
    assert with_value("name: a\nkerf: 1 mm\n", ["set"], "b") == "name: a\nkerf: 1 mm\nset: b\n"
    assert with_value("name: a\n\nkerf: 1 mm\n", ["set"], "b") == "name: a\n\nkerf: 1 mm\n\nset: b\n"
