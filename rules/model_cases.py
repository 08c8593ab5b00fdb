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

A contour's way round may follow it, as in `Plate.outer/ccw`. Instead of a nest the path of a file may be given. What
else a rule may ask of cuts is given beside the nest: `start_side: left`, `zones: {Plate: 1, Frame: 2}` by part, and
`pause: 20 s`, the time from each cut to the next.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any, Literal, get_args

import yaml

from kerfwise.encoder.cut import Cut, CutSequence, Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import OptionKind, Unfit
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.plain_values import Choice, Number
from kerfwise.rules.options.quantities import DURATION
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, deepest, entries, items, shape
from kerfwise.rules.rule import Rule

from .case import Case, cut
from .drawn_nest import given_keys, read_nest_of

KEYS = ("nest", "right", "wrong", "options", "start_side", "zones", "pause")
SIDES: tuple[Side, ...] = get_args(Side)
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
    given = given_keys(node, KEYS, problems, what)
    if "nest" not in given or not given.keys() & {"right", "wrong"}:
        problems.add(node, f"{what}: expected a nest, and orders under right or wrong")
        return
    drawn = read_nest_of(given["nest"], path, problems, f"{what}.nest")
    if drawn is None:
        return
    options = _options(given.get("options"), rule, problems, f"{what}.options")
    stated = _stated(given, drawn, problems, what)
    sides: tuple[tuple[Literal["right", "wrong"], Literal["passes", "fails"]], ...]
    sides = (("right", "passes"), ("wrong", "fails"))
    for key, kind in sides:
        for k, order in zip(count(1), items(given[key], problems, f"{what}.{key}") if key in given else ()):
            cuts = _cuts(order, drawn, stated, problems, f"{what}.{key}[{k}]")
            if cuts is not None:
                yield Case(f"{number}, {key}: {order.value}", kind, drawn, cuts, options=options)


def _options(node: yaml.Node | None, rule: Rule[Any], problems: Problems, what: str) -> Any:
    """The options of a case: those of the rule, with what is given in their place; None where nothing is."""
    if node is None:
        return None
    options, given = rule.Options(), {}
    known = {option.key: option for option in options_of(options)}
    for key, key_node, value in entries(node, problems, what):
        if key in known:
            given[known[key].name] = _value(value, known[key].kind, problems, f"{what}.{key}")
        else:
            problems.add(key_node, f"{what}: {unknown('option', key, known)}")
    return replace(options, **given)


@dataclass(frozen=True, slots=True)
class _Stated:
    """What a case says of its cuts beside their order: the side they start from, zone by part, seconds between cuts."""

    start_side: Side | None
    zones: Mapping[str, int]
    pause_s: float


def _stated(given: Mapping[str, yaml.Node], drawn: Nest, problems: Problems, what: str) -> _Stated:
    zones: dict[str, int] = {}
    for part_id, key, value in entries(given["zones"], problems, f"{what}.zones") if "zones" in given else ():
        if part_id not in drawn.part_of:
            problems.add(key, f"{what}.zones: {unknown('part', part_id, drawn.part_of)}")
        else:
            zones[part_id] = _value(value, Number(1, whole=True), problems, f"{what}.zones.{part_id}") or 0
    side = _value(given["start_side"], Choice(SIDES), problems, f"{what}.start_side") if "start_side" in given else None
    pause_s = _value(given["pause"], DURATION, problems, f"{what}.pause") if "pause" in given else None
    return _Stated(side, zones, pause_s or 0.0)


def _value(node: yaml.Node, kind: OptionKind, problems: Problems, what: str) -> Any:
    """The value of a node; None with a problem noted."""
    try:
        return kind.read(node)
    except Unfit as error:
        problems.add(error.node or node, f"{what}: {error}")
        return None


def _cuts(node: yaml.Node, drawn: Nest, stated: _Stated, problems: Problems, what: str) -> CutSequence | None:
    if not isinstance(node, yaml.ScalarNode):
        problems.add(node, f"{what}: expected contours in cutting order, such as A.outer B.outer, got {shape(node)}")
        return None
    cuts: list[Cut] = []
    for word in str(node.value).split():
        name, _, way = word.partition("/")
        if name not in drawn.index:
            problems.add(node, f"{what}: {unknown('contour', name, drawn.index)}")
            return None
        if way not in ("", "cw", "ccw"):
            problems.add(node, f"{what}: expected a way round, cw or ccw, after {name}/, got {way!r}")
            return None
        at_s, zone = stated.pause_s * (len(cuts) + 1), stated.zones.get(drawn.contour(name).part, 0)
        made = cut(drawn, name, **({"direction": way} if way else {}))
        cuts.append(replace(made, zone=zone, start_s=at_s, end_s=at_s))
    missing = sorted(drawn.index.keys() - {c.contour for c in cuts})
    if missing or len(cuts) != len(drawn.contours):
        told = f"{', '.join(missing)} is missing" if missing else "one is there twice"
        problems.add(node, f"{what}: expected every contour of the nest once; {told}")
        return None
    return CutSequence(tuple(cuts), stated.start_side)
