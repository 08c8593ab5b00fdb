"""The cases of rules, found and run; those of a MiniZinc rule are comments in its own file."""

from __future__ import annotations

import importlib
import importlib.util
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any, Literal, get_args

import yaml

from kerfwise.encoder.cut import Cut, CutSequence, Side
from kerfwise.encoder.errors import InputError, exception_text, file_of, rule_of
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.options.kind import Choice, Number, OptionKind, Unfit
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import DURATION
from kerfwise.rules.options.yaml_positions import Problems, compose, deepest, entries, items, plain, shape

from .case import Case, CaseKind, Rows, circle, cut, part, rect
from .case import nest as nest_of
from .registry import RULES
from .rule import Rule


def cases_of(rule: str, known: Mapping[str, Rule[Any]] = RULES) -> tuple[Case, ...]:
    """The cases of a rule, tiny nests with cuts and what is wrong with them; `known` are the rules that there are.

    Those of a rule from outside are `CASES` in its own module: a tuple, or where there are several rules, by rule id.
    Raises InputError if there is no such rule, or the rule has no cases.

    Examples
    --------
    >>> cases_of("hull-before")[0].kind
    'passes'
    """
    if rule not in known:
        raise InputError(unknown("rule", rule, known))
    if isinstance(own_cases := known[rule], ModelRule):
        return model_cases(own_cases, own_cases.file.path)
    if own_cases.brought:
        return _beside(own_cases)
    module = f"{type(known[rule]).__module__}.cases"
    if importlib.util.find_spec(module) is None:
        folder = rule.replace("-", "_")
        raise InputError(f"rule {rule} has no cases: expected the file rules/catalogue/{folder}/cases.py")
    cases: tuple[Case, ...] = importlib.import_module(module).CASES
    return cases


def error_line(error: Exception) -> str:
    """What a rule has raised, in one line, with the place in its file."""
    if isinstance(error, InputError):
        return str(error)
    at_work = rule_of(error)
    return f"{exception_text(error)}{f', in rule {at_work}' if at_work else ''}"


def _run_model_cases(rule: Rule[Any], cases: Sequence[Case]) -> Iterator[CaseOutcome]:
    """Judge every order of a model file's cases: those that are right, and those that are wrong."""
    for kind, word in (("passes", "right"), ("fails", "wrong")):
        if all(case.kind != kind for case in cases):
            yield CaseOutcome(rule.id, "all", (f"there is no order under {word}",))
    for case in cases:
        try:
            yield CaseOutcome(rule.id, case.name, tuple(_wrong_in(rule, case)))
        except Exception as error:
            yield CaseOutcome(rule.id, case.name, (error_line(error),))


def _wrong_in(rule: Rule[Any], case: Case) -> Iterator[str]:
    options = case.options or rule.Options()
    if (why := rule.unjudged(case.nest, case.cuts, options)) is not None:
        yield f"it cannot be judged: {why}"
        return
    found = rule.violations(case.nest, case.cuts, options)
    if case.kind == "passes":
        yield from (f"it should be right, but: {v.text}" for v in found)
    elif not found:
        yield "it should be wrong, and the rule finds nothing"


def _beside(rule: Rule[Any]) -> tuple[Case, ...]:
    """The cases in the module of a rule from outside."""
    cls = type(rule)
    found = getattr(sys.modules[cls.__module__], "CASES", None)
    cases = found.get(rule.id) if isinstance(found, Mapping) else found
    if not isinstance(cases, Sequence) or not all(isinstance(case, Case) for case in cases):
        raise InputError(
            f"rule {rule.id} has no cases: expected CASES = (Case(…), …) in its file, or CASES = {{'{rule.id}': (…)}} "
            "where there are several rules",
            file=file_of(cls) or None,
        )
    return tuple(cases)


def run_cases(rule: str, known: Mapping[str, Rule[Any]] = RULES) -> Iterator[CaseOutcome]:
    """Judge every case of a rule and compare to the letter; a rule without a case of each kind is wrong too."""
    cases = cases_of(rule, known)
    if isinstance(known[rule], ModelRule):
        yield from _run_model_cases(known[rule], cases)
        return
    missing = [kind for kind in get_args(CaseKind) if all(case.kind != kind for case in cases)]
    if missing:
        yield CaseOutcome(rule, "all", (f"there is no case of kind {', '.join(missing)}",))
    for case in cases:
        try:
            found = tuple(known[rule].violations(case.nest, case.cuts, case.options or known[rule].Options()))
        except Exception as error:
            yield CaseOutcome(rule, case.name, (error_line(error),))
            continue
        if found == case.violations:
            yield CaseOutcome(rule, case.name)
            continue
        lines = [f"expected: {v}" for v in case.violations if v not in found]
        lines += [f"found:    {v}" for v in found if v not in case.violations]
        yield CaseOutcome(rule, case.name, tuple(lines) or ("the same violations, in another order",))


# How one thing that was tried of a rule went.


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """What was tried of a rule: a case, by its name, or something else; `wrong` is empty where it went as it should.

    `note` says what could not be tried, where that is no fault of the rule's.
    """

    rule: str
    case: str
    wrong: tuple[str, ...] = ()
    is_case: bool = True
    note: str = ""


# The cases of a rule in MiniZinc: comments in its own file, small nests with orders that are right and wrong.
#
# ``` % cases: % - nest: % sheet: 300 x 100 % Plate: rect 10 10 60 60 % Frame: {outer: rect 90 10 80 80, holes:
# [circle 130 50 20], attributes: {priority: 1}} % right: % - Plate.outer Frame.hole1 Frame.outer % wrong: % -
# Frame.hole1 Frame.outer Plate.outer ```
#
# A contour's way round may follow it, as in `Plate.outer/ccw`. Instead of a nest the path of a file may be given.
# What else a rule may ask of cuts is given beside the nest: `start_side: left`, `zones: {Plate: 1, Frame: 2}` by
# part, and `pause: 20 s`, the time from each cut to the next.

KEYS = ("nest", "right", "wrong", "options", "start_side", "zones", "pause")
SIDES: tuple[Side, ...] = get_args(Side)
BEGINS = re.compile(r"^%\s*cases:\s*$")


def model_cases(rule: Rule[Any], path: Path) -> tuple[Case, ...]:
    """The cases in a model file; those called wrong are of kind `fails`, with no violations said.

    Raises InputError if there are none, or something in them cannot be read: with file, line and column.
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
    nodes = read_keys(node, KEYS, problems, what)
    if "nest" not in nodes or not nodes.keys() & {"right", "wrong"}:
        problems.add(node, f"{what}: expected a nest, and orders under right or wrong")
        return
    drawn = read_nest_of(nodes["nest"], path, problems, f"{what}.nest")
    if drawn is None:
        return
    options = _options(nodes.get("options"), rule, problems, f"{what}.options")
    stated = _stated(nodes, drawn, problems, what)
    sides: tuple[tuple[Literal["right", "wrong"], Literal["passes", "fails"]], ...]
    sides = (("right", "passes"), ("wrong", "fails"))
    for key, kind in sides:
        for k, order in zip(count(1), items(nodes[key], problems, f"{what}.{key}") if key in nodes else ()):
            cuts = _cuts(order, drawn, stated, problems, f"{what}.{key}[{k}]")
            if cuts is not None:
                yield Case(f"{number}, {key}: {order.value}", kind, drawn, cuts, options=options)


def _options(node: yaml.Node | None, rule: Rule[Any], problems: Problems, what: str) -> Any:
    """The options of a case: those of the rule, with what is given in their place; None where nothing is."""
    if node is None:
        return None
    options, parameters = rule.Options(), {}
    known = {option.key: option for option in options_of(options)}
    for key, key_node, value in entries(node, problems, what):
        if key in known:
            parameters[known[key].name] = _value(value, known[key].kind, problems, f"{what}.{key}")
        else:
            problems.add(key_node, f"{what}: {unknown('option', key, known)}")
    return replace(options, **parameters)


@dataclass(frozen=True, slots=True)
class _Stated:
    """What a case says of its cuts beside their order: the side they start from, zone by part, seconds between cuts."""

    start_side: Side | None
    zones: Mapping[str, int]
    pause_s: float


def _stated(nodes: Mapping[str, yaml.Node], drawn: Nest, problems: Problems, what: str) -> _Stated:
    zones: dict[str, int] = {}
    for part_id, key, value in entries(nodes["zones"], problems, f"{what}.zones") if "zones" in nodes else ():
        if part_id not in drawn.part_of:
            problems.add(key, f"{what}.zones: {unknown('part', part_id, drawn.part_of)}")
        else:
            zones[part_id] = _value(value, Number(1, whole=True), problems, f"{what}.zones.{part_id}") or 0
    side = _value(nodes["start_side"], Choice(SIDES), problems, f"{what}.start_side") if "start_side" in nodes else None
    pause_s = _value(nodes["pause"], DURATION, problems, f"{what}.pause") if "pause" in nodes else None
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
        drawn_cut = cut(drawn, name, **({"direction": way} if way else {}))
        cuts.append(replace(drawn_cut, zone=zone, start_s=at_s, end_s=at_s))
    missing = sorted(drawn.index.keys() - {c.contour for c in cuts})
    if missing or len(cuts) != len(drawn.contours):
        text = f"{', '.join(missing)} is missing" if missing else "one is there twice"
        problems.add(node, f"{what}: expected every contour of the nest once; {text}")
        return None
    return CutSequence(tuple(cuts), stated.start_side)


# The nest of a case in a model file, drawn in a few words: `Plate: rect 10 10 60 60`.

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
        elif (part_read := _part(key, value, problems, f"{what}.{key}")) is not None:
            parts.append(part_read)
    if len(problems.found) == so_far and (size is None or not parts):
        problems.add(node, f"{what}: expected a sheet, such as sheet: 300 x 100, and parts")
    return nest_of(*size, *parts) if size is not None and len(problems.found) == so_far else None


def _size(node: yaml.Node, problems: Problems, what: str) -> tuple[float, float] | None:
    found = re.fullmatch(rf"\s*({NUMBER})\s*x\s*({NUMBER})\s*", str(node.value))
    if found is None or float(found[1]) <= 0 or float(found[2]) <= 0:
        problems.add(node, f"{what}: expected width x height in mm, such as 300 x 100, got {shape(node)}")
        return None
    return float(found[1]), float(found[2])


def read_keys(node: yaml.Node, keys: Sequence[str], problems: Problems, what: str) -> dict[str, yaml.Node]:
    """What stands under the keys of a mapping; others than these are problems."""
    nodes: dict[str, yaml.Node] = {}
    for key, key_node, value in entries(node, problems, what):
        if key in keys:
            nodes[key] = value
        else:
            problems.add(key_node, f"{what}: {unknown('key', key, keys)}")
    return nodes


def _part(name: str, node: yaml.Node, problems: Problems, what: str) -> Part | None:
    if isinstance(node, yaml.ScalarNode):
        rows = _rows(node, problems, what)
        return None if rows is None else part(name, rows)
    nodes = read_keys(node, PART_KEYS, problems, what)
    if "outer" not in nodes:
        problems.add(node, f"{what}: expected {SHAPES}; or outer, holes, marks and attributes")
        return None
    outer = _rows(nodes["outer"], problems, f"{what}.outer")
    holes = (
        [_rows(n, problems, f"{what}.holes") for n in items(nodes["holes"], problems, what)] if "holes" in nodes else []
    )
    marks = (
        [_line(n, problems, f"{what}.marks") for n in items(nodes["marks"], problems, what)] if "marks" in nodes else []
    )
    if outer is None or None in holes or None in marks:
        return None
    part_read = part(name, outer, [h for h in holes if h is not None], [m for m in marks if m is not None])
    return replace(part_read, attributes=dict(plain(nodes["attributes"]) or {})) if "attributes" in nodes else part_read


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
