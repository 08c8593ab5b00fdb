"""Places of nodes, and the mistakes of YAML itself."""

from __future__ import annotations

import pytest
import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, items, plain, wrong_at


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
