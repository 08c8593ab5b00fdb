"""The nest of a case in a model file, drawn in a few words: `Plate: rect 10 10 60 60`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import yaml

from kerfwise.encoder.by_hand import Rows, circle, part, rect
from kerfwise.encoder.by_hand import nest as nest_of
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, entries, items, plain, shape

PART_KEYS = ("outer", "holes", "marks", "attributes")
SHAPES = "rect x y width height, circle x y radius, or polygon x y, x y, x y"
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)"


def read_nest_of(node: yaml.Node, path: Path, problems: Problems, what: str) -> Nest | None:
    """The nest that a mapping draws, or the one in the file that a text names; None with a problem noted."""
    if isinstance(node, yaml.ScalarNode):
        from kerfwise.encoder.readers import read_nest

        return read_nest(path.parent / str(node.value))
    so_far, size, parts = len(problems.found), None, []
    for key, _, value in entries(node, problems, what):
        if key == "sheet":
            size = _size(value, problems, f"{what}.sheet")
        elif (made := _part(key, value, problems, f"{what}.{key}")) is not None:
            parts.append(made)
    if len(problems.found) == so_far and (size is None or not parts):
        problems.add(node, f"{what}: expected a sheet, such as sheet: 300 x 100, and parts")
    return nest_of(*size, *parts) if size is not None and len(problems.found) == so_far else None


def _size(node: yaml.Node, problems: Problems, what: str) -> tuple[float, float] | None:
    found = re.fullmatch(rf"\s*({NUMBER})\s*x\s*({NUMBER})\s*", str(node.value))
    if found is None or float(found[1]) <= 0 or float(found[2]) <= 0:
        problems.add(node, f"{what}: expected width x height in mm, such as 300 x 100, got {shape(node)}")
        return None
    return float(found[1]), float(found[2])


def given_keys(node: yaml.Node, keys: Sequence[str], problems: Problems, what: str) -> dict[str, yaml.Node]:
    """What stands under the keys of a mapping; others than these are problems."""
    given: dict[str, yaml.Node] = {}
    for key, key_node, value in entries(node, problems, what):
        if key in keys:
            given[key] = value
        else:
            problems.add(key_node, f"{what}: {unknown('key', key, keys)}")
    return given


def _part(name: str, node: yaml.Node, problems: Problems, what: str) -> Part | None:
    if isinstance(node, yaml.ScalarNode):
        rows = _rows(node, problems, what)
        return None if rows is None else part(name, rows)
    given = given_keys(node, PART_KEYS, problems, what)
    if "outer" not in given:
        problems.add(node, f"{what}: expected {SHAPES}; or outer, holes, marks and attributes")
        return None
    outer = _rows(given["outer"], problems, f"{what}.outer")
    holes = (
        [_rows(n, problems, f"{what}.holes") for n in items(given["holes"], problems, what)] if "holes" in given else []
    )
    marks = (
        [_line(n, problems, f"{what}.marks") for n in items(given["marks"], problems, what)] if "marks" in given else []
    )
    if outer is None or None in holes or None in marks:
        return None
    made = part(name, outer, [h for h in holes if h is not None], [m for m in marks if m is not None])
    return replace(made, attributes=dict(plain(given["attributes"]) or {})) if "attributes" in given else made


def _rows(node: yaml.Node, problems: Problems, what: str) -> Rows | None:
    word, _, rest = str(node.value).strip().partition(" ") if isinstance(node, yaml.ScalarNode) else ("", "", "")
    numbers = [float(n) for n in re.findall(NUMBER, rest)]
    clean = re.fullmatch(rf"[\s,]*({NUMBER}[\s,]*)*", rest) is not None
    if word == "rect" and len(numbers) == 4 and clean:
        return rect(*numbers)
    if word == "circle" and len(numbers) == 3 and clean:
        return circle(*numbers)
    if word == "polygon" and len(numbers) >= 6 and len(numbers) % 2 == 0 and clean:
        return list(zip(numbers[::2], numbers[1::2], strict=True))
    problems.add(node, f"{what}: expected {SHAPES}, got {shape(node)}")
    return None


def _line(node: yaml.Node, problems: Problems, what: str) -> Rows | None:
    numbers = [float(n) for n in re.findall(NUMBER, str(node.value))] if isinstance(node, yaml.ScalarNode) else []
    if len(numbers) < 4 or len(numbers) % 2:
        problems.add(node, f"{what}: expected the points of a line, such as 10 10, 30 10, got {shape(node)}")
        return None
    return list(zip(numbers[::2], numbers[1::2], strict=True))
