import pytest
import yaml

from kerfwise.encoder.files import places, spoken

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
