"""The schema of kerfwise-nest/1, and where in a file a value stands."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator

from kerfwise import InputError
from kerfwise.encoder.files import places, spoken
from kerfwise.encoder.readers import json_nest
from kerfwise.encoder.readers.json_nest import validator
from kerfwise.tests.encoder.readers.test_json_nest import RING, document


def test_the_published_schema_is_a_schema() -> None:
    Draft202012Validator.check_schema(validator().schema)
    assert validator().is_valid(document())


WRONG: list[dict[str, Any]] = [
    {"priority": -0.1}, {"priority": True}, {"quantity": 0}, {"quantity": 2.5}, {"thickness": 0}, {"thickness": "3"},
    {"due": "soon"}, {"due": 3}, {"material": 5}, {"block": []},
]  # fmt: skip


def test_the_schema_sees_few_vertices_of_plain_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes a tenth of a second for a thousand of them."""
    shown: list[Any] = []
    checked = json_nest.validator()

    class Noted:
        def iter_errors(self, document: Any) -> Any:
            shown.append(document)
            return checked.iter_errors(document)

    monkeypatch.setattr(json_nest, "validator", Noted)
    ring = [[100 + 50 * math.cos(k / 500), 100 + 50 * math.sin(k / 500)] for k in range(3000)]
    part = {"id": "A", "outer": ring, "holes": [ring], "marks": [ring]}
    sheet = {"width": 200, "height": 200}
    document: dict[str, Any] = {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": [part]}
    json_nest.check_schema(document, json.dumps(document))
    assert not shown  # as plain as that it needs no schema at all
    document["scrap"] = []
    json_nest.check_schema(document, json.dumps(document))
    assert len(shown[0]["parts"][0]["outer"]) == json_nest.FEW
    assert len(json.dumps(shown)) < 1000
    assert part["holes"] == [ring]


@pytest.mark.parametrize(
    "change",
    [
        {"format": "kerfwise-nest/2"},
        {"units": "mile"},
        {"units": ["mm"]},
        {"sheet": {"width": 0, "height": 100}},
        {"sheet": {"width": True, "height": 100}},
        {"sheet": {"width": 1e7, "height": 100}},
        {"sheet": {"width": 100}},
        {"sheet": [100, 100]},
        {"parts": {}},
        {"parts": [{"id": "", "outer": [[0, 0], [1, 0], [1, 1]]}]},
        {"parts": [{"id": "A", "outer": [[0, 0]]}]},
        {"parts": [None]},
        *[{"parts": [{"id": "A", "outer": RING, **more}]} for more in WRONG],
    ],
)
def test_a_file_that_the_schema_refuses_is_never_taken_for_plain(change: dict[str, Any]) -> None:
    given = {"format": "kerfwise-nest/1", "sheet": {"width": 100, "height": 100}, "parts": []} | change
    assert list(json_nest.validator().iter_errors(given))
    with pytest.raises(InputError):
        json_nest.check_schema(given, json.dumps(given))


TEXT = """{"format": "kerfwise-nest/1",
 "parts": [
  {"id": "A"},
  {"id": "B", "holes": [[[0, 0], [1,
    "x"]]]}]}"""


def test_values_are_found() -> None:
    assert places(TEXT, [["parts", 1, "holes", 0, 1, 1], ["parts", 1], ["format"]]) == [(5, 5), (4, 3), (1, 12)]


def test_a_missing_step_leaves_the_place_of_what_holds_it() -> None:
    assert places(TEXT, [["parts", 7, "outer"], ["sheet"], []]) == [(2, 11), (1, 1), (1, 1)]


def test_what_yaml_cannot_follow_has_no_place() -> None:
    assert places('{"a":\t[}', [["a"]]) == [(None, None)]
    assert places("", [["a"]]) == [(None, None)]


def test_a_text_is_not_parsed_again_where_nothing_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(yaml, "compose", lambda text, **given: asked.append(text))
    assert places(TEXT, []) == []
    assert asked == []
    places(TEXT, [["format"]])
    assert asked == [TEXT]


def test_paths_in_words() -> None:
    assert spoken(["parts", 0, "outer", 3, 2], ["A"]) == "part 'A', outer, vertex 4, bulge"
    assert spoken(["parts", 1, "marks", 0], ["A", None]) == "part number 2, mark 1"
    assert spoken(["sheet", "holes", 2, 0, 1], []) == "the sheet, hole 3, vertex 1, y"
    assert spoken(["sheet", "width"], []) == "the sheet, width"
    assert spoken(["parts"], []) == "parts"
    assert spoken([], []) == "the file"
