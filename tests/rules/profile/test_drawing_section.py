"""What a profile says of drawings: the layer map, its older keys, and that every key a message names is accepted."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

import kerfwise as package
from kerfwise import InputError, Profile, load_profile, read_nest
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.encoder.readers.drawings import save_dxf
from kerfwise.tests.encoder.readers.test_frame import framed
from kerfwise.tests.encoder.readers.test_open_lines import engraved


def load(folder: Path, text: str) -> Profile:
    path = folder / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    return load_profile(path)


def test_the_layer_map_is_read_with_the_rest_at_its_default(tmp_path: Path) -> None:
    layers = load(tmp_path, "drawing: {layers: {cut: '^0$', mark: jel}}").drawing.layers
    assert (layers.cut, layers.mark) == ("^0$", "jel")
    assert layers.sheet == load(tmp_path, "name: plant").drawing.layers.sheet != ""


def test_a_profile_based_on_another_keeps_what_it_does_not_say(tmp_path: Path) -> None:
    (tmp_path / "base.yaml").write_text("drawing: {layers: {mark: jel}, frame: sheet}")
    drawing = load(tmp_path, "based_on: base.yaml\ndrawing: {layers: {cut: '^0$'}}").drawing
    assert (drawing.layers.cut, drawing.layers.mark, drawing.frame) == ("^0$", "jel", "sheet")


def test_show_prints_every_pattern_and_reads_back(tmp_path: Path) -> None:
    profile = load(tmp_path, 'name: plant\ndrawing: {layers: {mark: "it\'s|#"}, open_lines: refuse}')
    shown = kerfwise("profile", "show", tmp_path / "plant.yaml").out
    assert "  layers:  " in shown
    assert "    mark: it's|#" in shown
    assert load(tmp_path, shown) == profile


@pytest.mark.parametrize(
    ("text", "line", "column", "said"),
    [
        ("drawing:\n  layers:\n    mark: 'grav('\n", 3, 11, "drawing.layers.mark: expected a regular expression"),
        ("drawing:\n  layers: {marks: grav}\n", 2, 12, "drawing.layers: unknown key 'marks'"),
        ("drawing:\n  layers: grav\n", 2, 11, "drawing.layers: expected a mapping"),
        ("drawing:\n  frame: board\n", 2, 10, "drawing.frame: expected one of ask, sheet, part"),
        ("drawing:\n  mark_layer: '('\n", 2, 15, "drawing.layers.mark: expected a regular expression"),
        (
            "drawing:\n  layers: {mark: a}\n  mark_layer: b\n",
            3,
            3,
            "drawing.mark_layer: this is drawing.layers.mark now, which is given too; keep one",
        ),
    ],
)
def test_a_mistake_is_placed(text: str, line: int, column: int, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        load(tmp_path, text)
    assert (error.value.line, error.value.column, error.value.details) == (line, column, ())
    assert error.value.message.startswith(said)


def test_the_older_keys_still_say_the_same(tmp_path: Path) -> None:
    older = load(tmp_path, "drawing: {sheet_layer: '^S$', mark_layer: '^M$', layers: {cut: '^0$'}}").drawing.layers
    assert (older.sheet, older.mark, older.cut) == ("^S$", "^M$", "^0$")


def keys() -> set[str]:
    """Every key of the section, by the schema for editors."""
    schema = json.loads(kerfwise("profile", "schema").out)
    return set(_keys(schema, schema["properties"]["drawing"], "drawing"))


def _keys(schema: dict[str, Any], of: dict[str, Any], before: str) -> Iterator[str]:
    for each in (of, *of.get("anyOf", ()), *of.get("oneOf", ())):
        if "$ref" in each:
            yield from _keys(schema, schema["$defs"][each["$ref"].rpartition("/")[2]], before)
        for key, value in each.get("properties", {}).items():
            yield f"{before}.{key}"
            yield from _keys(schema, value, f"{before}.{key}")


def keys_named(text: str) -> set[str]:
    return {key.rstrip(".") for key in re.findall(r"\bdrawing(?:\.[a-z_]+)+", text)}


def test_every_key_that_the_readers_name_is_one_of_a_profile() -> None:
    root = Path(package.__file__).parent
    sources = (p.read_text(encoding="utf-8") for p in sorted((root / "encoder").rglob("*.py")))
    trees = [ast.parse(source) for source in sources if "drawing." in source]
    texts = [
        n.value for tree in trees for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)
    ]
    named = keys_named("\n".join(texts))
    assert {"drawing.layers", "drawing.layers.sheet", "drawing.open_lines", "drawing.join_tolerance"} <= named
    assert named <= keys()
    assert keys_named("raise drawing.join_tolerance_mm, drawing.layers.marks") - keys()


@pytest.mark.parametrize("draw", [engraved, framed, lambda space: framed(space, "Rahmen")])
def test_what_a_message_says_to_write_in_a_profile_is_a_profile(draw: object, tmp_path: Path) -> None:
    """And with the first of them the drawing is read."""
    path = save_dxf(tmp_path, draw)  # type: ignore[arg-type]
    with pytest.raises(InputError) as error:
        read_nest(path)
    written = re.findall(r"drawing: \{.*?\}+", str(error.value))
    assert written
    for line in written:
        assert set(yaml.safe_load(line)) == {"drawing"}
        assert read_nest(path, load(tmp_path, line)).parts


def test_the_page_on_drawings_names_keys_that_exist(tmp_path: Path) -> None:
    page = (Path(package.__file__).parent / "docs" / "drawings.md").read_text(encoding="utf-8")
    [block] = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    assert load(tmp_path, block).drawing.layers.scrap == "cuttingline"
    assert keys_named(page) <= keys()
