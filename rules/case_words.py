"""The nest and the cuts of a case in a few words, such as `rect 10 10 60 60` and `A.outer ccw, B.outer tab`.

A part is an outline, or a mapping with `outer`, `holes`, `marks`, `tabs` and `attributes`. The sheet is a width and a
height, or a mapping with that `size`, `scrap` lines, the kerf of its `slits`, and pairs of contours that have one line
in `common`.

Cuts follow each other. Behind a contour stands what is special about its cut; without, it is entered and pierced at the
contour's first point, outer contours clockwise, all others not:

    cw, ccw                  which way round
    entry 100 50             a point of the contour
    pierce 100 44            where the torch goes on
    at 100 50                entry and pierce
    lead-in 100 44, 100 49   a path from the pierce, which it sets too
    lead-out 100 49, 90 44   a path, or the one point where the torch goes off
    overcut 5                the lead-out goes on along the contour, mm
    span 10 10, 60 10        only this stretch of the contour is cut
    tab, tab 60 10 1         1 mm wide at the entry; or where, and how wide
    linked                   not pierced: the torch stays on after the cut before
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.cut import Cut, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest, Note, Part, Sheet
from kerfwise.encoder.slits import with_slits
from kerfwise.rules.options.yaml_positions import Problems, entries, items, plain, shape

from .case import Rows, circle, cut, part, rect, scrap_lines

PART_KEYS = ("outer", "holes", "marks", "tabs", "attributes")
SHEET_KEYS = ("size", "scrap", "slits", "common")
SHAPES = "rect x y width height, circle x y radius, or polygon x y, x y, x y"
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)"
WORDS = "cw, ccw, entry, pierce, at, lead-in, lead-out, overcut, span, tab or linked"


def read_nest_of(node: yaml.Node, path: Path, problems: Problems, what: str) -> Nest | None:
    """The nest that a mapping draws, or the one in the file that a text names; None with a problem noted."""
    if isinstance(node, yaml.ScalarNode):
        from kerfwise.encoder.readers import read_nest

        return read_nest(path.parent / str(node.value))
    so_far, sheet, parts = len(problems.found), None, []
    for key, _, value in entries(node, problems, what):
        if key == "sheet":
            sheet = value
        elif (part_read := _part(key, value, problems, f"{what}.{key}")) is not None:
            parts.append(part_read)
    if len(problems.found) == so_far and (sheet is None or not parts):
        problems.add(node, f"{what}: expected a sheet, such as sheet: 300 x 100, and parts")
    return None if sheet is None else _on_sheet(sheet, parts, problems, f"{what}.sheet", so_far)


def _on_sheet(node: yaml.Node, parts: Sequence[Part], problems: Problems, what: str, so_far: int) -> Nest | None:
    """The parts on a sheet, with its scrap lines, slits and common lines; None where there is a problem with any."""
    nodes = {"size": node} if isinstance(node, yaml.ScalarNode) else read_keys(node, SHEET_KEYS, problems, what)
    if "size" not in nodes:
        problems.add(node, f"{what}: expected size, such as size: 300 x 100, and scrap, slits or common")
        return None
    outline = _size(nodes["size"], problems, what)
    scrap = [_line(n, problems, f"{what}.scrap") for n in _members(nodes, "scrap", problems, what)]
    kerf = numbers_of(nodes["slits"], problems, f"{what}.slits", 1) if "slits" in nodes else None
    common = [str(n.value).split() for n in _members(nodes, "common", problems, what)]
    if outline is None or len(problems.found) > so_far:
        return None
    notes = tuple(Note("warning", "cut once", (one, other), common=True) for one, other in common)
    lines = scrap_lines([line for line in scrap if line is not None])
    drawn = Nest(Sheet(Curve.of(outline)), tuple(parts), notes=notes, scrap=lines)
    return with_slits(drawn, kerf[0]) if kerf else drawn


def _size(node: yaml.Node, problems: Problems, what: str) -> Rows | None:
    text = str(node.value)
    if text.startswith("circle"):
        return _rows(node, problems, what)
    found = re.fullmatch(rf"\s*({NUMBER})\s*x\s*({NUMBER})\s*", text)
    if found is None or float(found[1]) <= 0 or float(found[2]) <= 0:
        problems.add(node, f"{what}: expected width x height in mm, such as 300 x 100, got {shape(node)}")
        return None
    return rect(0, 0, float(found[1]), float(found[2]))


def read_keys(node: yaml.Node, keys: Sequence[str], problems: Problems, what: str) -> dict[str, yaml.Node]:
    """What stands under the keys of a mapping; others than these are problems."""
    nodes: dict[str, yaml.Node] = {}
    for key, key_node, value in entries(node, problems, what):
        if key in keys:
            nodes[key] = value
        else:
            problems.add(key_node, f"{what}: {unknown('key', key, keys)}")
    return nodes


def _members(nodes: Mapping[str, yaml.Node], key: str, problems: Problems, what: str) -> list[yaml.Node]:
    return items(nodes[key], problems, what) if key in nodes else []


def _part(name: str, node: yaml.Node, problems: Problems, what: str) -> Part | None:
    if isinstance(node, yaml.ScalarNode):
        rows = _rows(node, problems, what)
        return None if rows is None else part(name, rows)
    nodes = read_keys(node, PART_KEYS, problems, what)
    if "outer" not in nodes:
        problems.add(node, f"{what}: expected {SHAPES}; or outer, holes, marks, tabs and attributes")
        return None
    outer = _rows(nodes["outer"], problems, f"{what}.outer")
    holes = [_rows(n, problems, f"{what}.holes") for n in _members(nodes, "holes", problems, what)]
    marks = [_line(n, problems, f"{what}.marks") for n in _members(nodes, "marks", problems, what)]
    tabs = [numbers_of(n, problems, f"{what}.tabs", 3) for n in _members(nodes, "tabs", problems, what)]
    if outer is None or None in holes or None in marks or None in tabs:
        return None
    part_read = part(name, outer, [h for h in holes if h is not None], [m for m in marks if m is not None])
    return replace(
        part_read,
        attributes=dict(plain(nodes["attributes"]) or {}) if "attributes" in nodes else {},
        tabs=tuple(Tab((t[0], t[1]), t[2]) for t in tabs if t is not None),
    )


def _rows(node: yaml.Node, problems: Problems, what: str) -> Rows | None:
    word, _, rest = str(node.value).strip().partition(" ") if isinstance(node, yaml.ScalarNode) else ("", "", "")
    numbers = _numbers(rest)
    if word == "rect" and len(numbers) == 4:
        return rect(*numbers)
    if word == "circle" and len(numbers) == 3:
        return circle(*numbers)
    if word == "polygon" and len(numbers) >= 6 and len(numbers) % 2 == 0:
        return points_of(numbers)
    problems.add(node, f"{what}: expected {SHAPES}, got {shape(node)}")
    return None


def _line(node: yaml.Node, problems: Problems, what: str) -> Rows | None:
    numbers = _numbers(str(node.value)) if isinstance(node, yaml.ScalarNode) else []
    if len(numbers) < 4 or len(numbers) % 2:
        problems.add(node, f"{what}: expected the points of a line, such as 10 10, 30 10, got {shape(node)}")
        return None
    return points_of(numbers)


def _numbers(text: str) -> list[float]:
    """Numbers with spaces or commas between them; none where there is anything else."""
    words = text.replace(",", " ").split()
    return [float(word) for word in words] if all(re.fullmatch(NUMBER, word) for word in words) else []


def numbers_of(node: yaml.Node, problems: Problems, what: str, count: int) -> list[float] | None:
    """So many numbers of a text; None with a problem noted."""
    numbers = _numbers(str(node.value)) if isinstance(node, yaml.ScalarNode) else []
    if len(numbers) == count:
        return numbers
    problems.add(node, f"{what}: expected {count} number{'s' if count > 1 else ''}, got {shape(node)}")
    return None


def points_of(numbers: Sequence[float]) -> list[Point]:
    """x, y, x, y… as points."""
    return list(zip(numbers[::2], numbers[1::2], strict=True))


# The cuts of a case.


def read_cuts(
    node: yaml.Node, drawn: Nest, problems: Problems, what: str, named: Mapping[str, str] | None = None
) -> list[Cut] | None:
    """The cuts that a text names in order; `named` are cuts under names of their own. None with a problem noted."""
    if not isinstance(node, yaml.ScalarNode):
        problems.add(node, f"{what}: expected contours in cutting order, such as A.outer B.outer, got {shape(node)}")
        return None
    found: list[tuple[str, list[tuple[str, list[float]]]]] = []
    for written in _in_full(str(node.value), named or {}):
        word = written if written in drawn.index else written.rstrip(",")
        name, _, way = (word, "", "") if word in drawn.index else word.partition("/")
        if name in drawn.index:
            found.append((name, [(way, [])] if way else []))
        elif found and re.fullmatch(NUMBER, word) and found[-1][1]:
            found[-1][1][-1][1].append(float(word))
        elif found and not way and word in WORDS.replace(",", "").split():
            found[-1][1].append((word, []))
        else:
            problems.add(node, f"{what}: {unknown('contour', name, drawn.index)}; behind a contour may stand {WORDS}")
            return None
    cuts = []
    for name, details in found:
        try:
            cuts.append(_cut(drawn, name, details))
        except ValueError as error:
            problems.add(node, f"{what}: {error}")
            return None
    return cuts


def _in_full(text: str, named: Mapping[str, str]) -> Iterator[str]:
    for word in text.split():
        yield from named[word.rstrip(",")].split() if word.rstrip(",") in named else [word]


def _cut(drawn: Nest, name: str, details: Sequence[tuple[str, Sequence[float]]]) -> Cut:
    """One cut with what is special about it; raises ValueError where a word has not the numbers that it needs."""
    given: dict[str, Any] = {}
    tabs: list[Sequence[float]] = []
    for word, numbers in details:
        points = points_of(numbers) if len(numbers) % 2 == 0 else []
        match word, len(points), len(numbers):
            case "cw" | "ccw", 0, 0:
                given["direction"] = word
            case "linked", 0, 0:
                given["linked"] = True
            case "entry" | "pierce", 1, _:
                given[word] = points[0]
            case "at", 1, _:
                given |= {"entry": points[0], "pierce": points[0]}
            case "lead-in", n, _ if n > 1:
                given |= {"lead_in": Curve.of(points, closed=False), "pierce": points[0]}
            case "lead-out", n, _ if n > 0:
                given["lead_out"] = Curve.of(points, closed=False)
            case "overcut", 0, 1:
                given["overcut"] = numbers[0]
            case "span", 2, _:
                given["span"] = Span(*points)
            case "tab", 0, 0 | 3:
                tabs.append(numbers)
            case _:
                raise ValueError(f"expected {WORDS}, each with its numbers, after {name}, got {word!r} with {numbers}")
    overcut_mm = given.pop("overcut", None)
    made = cut(drawn, name, **given)
    if overcut_mm is not None:
        along = drawn.contour(name).curve.towards(made.direction)
        made = replace(made, lead_out=along.between(along.project(made.entry)[0], overcut_mm))
    return replace(made, tabs=tuple(Tab((t[0], t[1]), t[2]) if t else Tab(made.entry, 1.0) for t in tabs))
