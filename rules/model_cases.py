"""The cases of a rule in MiniZinc: comments in its own file, small nests with orders that are right and wrong.

```
% cases:
% - nest:
%     sheet: 300 x 100
%     Plate: rect 10 10 60 60
%     Frame: {outer: rect 90 10 80 80, holes: [circle 130 50 20], attributes: {priority: 1}}
%   right:
%     - Plate.outer Frame.hole1 Frame.outer
%   wrong:
%     - Frame.hole1 Frame.outer Plate.outer
```

A contour's way round may follow it, as in `Plate.outer/ccw`. Instead of a nest the path of a file may be given.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any, Literal

import yaml

from kerfwise.encoder.by_hand import Rows, circle, part, rect
from kerfwise.encoder.by_hand import nest as nest_of
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, deepest, entries, items, plain, shape
from kerfwise.rules.rule import Rule

from .case import Case, cut

KEYS = ("nest", "right", "wrong", "options")
PART_KEYS = ("outer", "holes", "marks", "attributes")
SHAPES = "rect x y width height, circle x y radius, or polygon x y, x y, x y"
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)"
BEGINS = re.compile(r"^%\s*cases:\s*$")


def model_cases(rule: Rule[Any], path: Path) -> tuple[Case, ...]:
    """The cases in a model file; those called wrong are of kind `fails`, with no violations said.

    Raises
    ------
    InputError
        If there are none, or something in them cannot be read: with file, line and column.
    """
    text, problems = _commented(path), Problems(str(path))
    root = compose(text, str(path)) if text.strip() else None
    if root is None:
        raise InputError(
            "the file has no cases: write `% cases:` below the rule, and in comments nests with orders that are right "
            "and wrong; `kerfwise rules new NAME --mzn` writes an example",
            file=path,
        )
    found: list[Case] = []
    for number, node in enumerate(items(deepest(root, "cases"), problems, "cases"), 1):
        found += _of_one(number, node, rule, path, problems)
    problems.raise_any()
    return tuple(found)


def _commented(path: Path) -> str:
    """The comment that begins with `% cases:` as YAML, each line and column where it stands in the file."""
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    kept, inside = [], False
    for line in lines:
        inside = bool(BEGINS.match(line)) or (inside and line.startswith("%"))
        kept.append(" " + line[1:] if inside else "")
    return "\n".join(kept)


def _of_one(number: int, node: yaml.Node, rule: Rule[Any], path: Path, problems: Problems) -> Iterator[Case]:
    what = f"cases[{number}]"
    given = _given(node, KEYS, problems, what)
    if "nest" not in given or not given.keys() & {"right", "wrong"}:
        problems.add(node, f"{what}: expected a nest, and orders under right or wrong")
        return
    drawn = _nest(given["nest"], path, problems, f"{what}.nest")
    if drawn is None:
        return
    options = _options(given.get("options"), rule, problems, f"{what}.options")
    sides: tuple[tuple[Literal["right", "wrong"], Literal["passes", "fails"]], ...]
    sides = (("right", "passes"), ("wrong", "fails"))
    for key, kind in sides:
        for k, order in zip(count(1), items(given[key], problems, f"{what}.{key}") if key in given else ()):
            cuts = _cuts(order, drawn, problems, f"{what}.{key}[{k}]")
            if cuts is not None:
                yield Case(f"{number}, {key}: {order.value}", kind, drawn, cuts, options=options)


def _options(node: yaml.Node | None, rule: Rule[Any], problems: Problems, what: str) -> Any:
    """The options of a case: those of the rule, with what is given in their place; None where nothing is."""
    if node is None:
        return None
    options, given = rule.Options(), {}
    known = {option.key: option for option in options_of(options)}
    for key, key_node, value in entries(node, problems, what):
        if key not in known:
            problems.add(key_node, f"{what}: {unknown('option', key, known)}")
            continue
        try:
            given[known[key].name] = known[key].kind.read(value)
        except Unfit as error:
            problems.add(error.node or value, f"{what}.{key}: {error}")
    return replace(options, **given)


def _cuts(node: yaml.Node, drawn: Nest, problems: Problems, what: str) -> CutSequence | None:
    if not isinstance(node, yaml.ScalarNode):
        problems.add(node, f"{what}: expected contours in cutting order, such as A.outer B.outer, got {shape(node)}")
        return None
    cuts = []
    for word in str(node.value).split():
        name, _, way = word.partition("/")
        if name not in drawn.index:
            problems.add(node, f"{what}: {unknown('contour', name, drawn.index)}")
            return None
        if way not in ("", "cw", "ccw"):
            problems.add(node, f"{what}: expected a way round, cw or ccw, after {name}/, got {way!r}")
            return None
        cuts.append(cut(drawn, name, **({"direction": way} if way else {})))
    missing = sorted(drawn.index.keys() - {c.contour for c in cuts})
    if missing or len(cuts) != len(drawn.contours):
        told = f"{', '.join(missing)} is missing" if missing else "one is there twice"
        problems.add(node, f"{what}: expected every contour of the nest once; {told}")
        return None
    return CutSequence(tuple(cuts))


def _nest(node: yaml.Node, path: Path, problems: Problems, what: str) -> Nest | None:
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


def _given(node: yaml.Node, keys: Sequence[str], problems: Problems, what: str) -> dict[str, yaml.Node]:
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
    given = _given(node, PART_KEYS, problems, what)
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
