"""The cases of a rule in YAML: `cases.yaml` of a rule of the catalogue, or comments in a model file.

A case of a rule of the catalogue says what kind it is of and has a name, a nest, the cuts in order, and the violations
to the letter; nests and cuts that several cases share stand before them under names:

    nests:
      ROW: {sheet: 300 x 100, A: rect 10 10 60 60, B: rect 90 10 60 60}
    cuts:
      B_below: B.outer lead-in 120 4, 120 9.25
    cases:
    - passes: A before B
      nest: ROW
      cuts: A.outer B_below
    - fails: B before A
      nest: ROW
      cuts: B_below A.outer
      violations:
      - {contours: A.outer B.outer, cuts: 1 2, text: "A.outer (cut 2) must be cut before B.outer (cut 1)"}

In a model file, whose violations have no text, it has orders of all contours that are right, and others that are wrong:

    % cases:
    % - nest: {sheet: 300 x 100, A: rect 10 10 60 60, B: rect 90 10 60 60}
    %   right:
    %   - A.outer B.outer
    %   wrong:
    %   - B.outer/ccw A.outer

Instead of a nest the path of a file may be given there. What else a rule may ask of cuts is given beside them:
`options` of the rule, `start_side: left`, `zones: {A: 1, B: 2}` by part, `home: 75 0`, `times: 0 10, 11 12` (start and
end of each cut, s), or `pause: 20 s` from each cut to the next, and `hot_spots: [120 °C at 62.4 99.6 after 31 s on A]`.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any, Literal, get_args

import yaml

from kerfwise.encoder.cut import Cut, CutSequence, HotSpot, Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.options.kind import Choice, Number
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import DURATION
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, deepest, entries, items, plain, shape

from .case import Case, CaseKind
from .case_words import NUMBER, numbers_of, points_of, read_cuts, read_keys, read_nest_of
from .lock import Lock
from .rule import Rule

SIDES: tuple[Side, ...] = get_args(Side)
KINDS: tuple[CaseKind, ...] = get_args(CaseKind)
BESIDE = ("options", "start_side", "zones", "home", "times", "pause", "hot_spots")
KEYS = (*KINDS, "nest", "cuts", "violations", *BESIDE)
KEYS_OF_MODEL = ("nest", "right", "wrong", *BESIDE)
BEGINS = re.compile(r"^%\s*cases:\s*$")
HOT_SPOT = re.compile(rf"({NUMBER}) °C at ({NUMBER}) ({NUMBER}) after ({NUMBER}) s(?: on (\S+))?")


def read_cases(path: Path, rule: Rule[Any]) -> tuple[Case, ...]:
    """The cases in a `cases.yaml`.

    Raises InputError if there is no such file, or something in it cannot be read: with file, line and column.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        raise InputError(f"rule {rule.id} has no cases: expected the file", file=path) from None
    problems, root = Problems(str(path)), compose(text, str(path))
    found: list[Case] = []
    if root is not None:
        nodes = read_keys(root, ("nests", "cuts", "cases"), problems, "the file")
        drawn = entries(nodes["nests"], problems, "nests") if "nests" in nodes else ()
        nests = {name: read_nest_of(node, path, problems, f"nests.{name}") for name, _, node in drawn}
        cuts = entries(nodes["cuts"], problems, "cuts") if "cuts" in nodes else ()
        named = {name: str(node.value) for name, _, node in cuts}
        for node in items(nodes["cases"], problems, "cases") if "cases" in nodes else ():
            case = None if problems.found and None in nests.values() else _case(node, rule, nests, named, problems)
            found += [case] if case is not None else []
    problems.raise_any()
    return tuple(found)


def _case(
    node: yaml.Node, rule: Rule[Any], nests: Mapping[str, Nest | None], named: Mapping[str, str], problems: Problems
) -> Case | None:
    nodes = read_keys(node, KEYS, problems, "case")
    kinds = [kind for kind in KINDS if kind in nodes]
    if len(kinds) != 1 or not nodes.keys() >= {"nest", "cuts"}:
        problems.add(node, f"case: expected a name behind one of {', '.join(KINDS)}, a nest and cuts")
        return None
    name = str(nodes[kinds[0]].value)
    drawn = nests.get(name_of := str(nodes["nest"].value))
    if drawn is None:
        problems.add(nodes["nest"], f"{name}: {unknown('nest', name_of, nests)}")
        return None
    cuts = read_cuts(nodes["cuts"], drawn, problems, f"{name}, cuts", named)
    found = items(nodes["violations"], problems, f"{name}, violations") if "violations" in nodes else ()
    violations = [_violation(one, rule, problems, f"{name}, violations") for one in found]
    options = _options(nodes.get("options"), rule, problems, f"{name}, options")
    beside = _beside(nodes, drawn, problems, name)
    if cuts is None:
        return None
    sequence = _sequence(cuts, beside, drawn, problems, name)
    return Case(name, kinds[0], drawn, sequence, tuple(v for v in violations if v is not None), options)


def _violation(node: yaml.Node, rule: Rule[Any], problems: Problems, what: str) -> Violation | None:
    nodes = read_keys(node, ("contours", "cuts", "text"), problems, what)
    text = {key: str(value.value) for key, value in nodes.items()}
    if "text" not in text or not re.fullmatch(r"[\d\s]*", text.get("cuts", "")):
        problems.add(node, f"{what}: expected contours, cuts by number, and text")
        return None
    cuts = tuple(map(int, text.get("cuts", "").split()))
    return Violation(rule.id, tuple(text.get("contours", "").split()), text["text"], cuts)


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
        found += _of_model(number, node, rule, path, problems)
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


def _of_model(number: int, node: yaml.Node, rule: Rule[Any], path: Path, problems: Problems) -> Iterator[Case]:
    what = f"cases[{number}]"
    nodes = read_keys(node, KEYS_OF_MODEL, problems, what)
    if "nest" not in nodes or not nodes.keys() & {"right", "wrong"}:
        problems.add(node, f"{what}: expected a nest, and orders under right or wrong")
        return
    drawn = read_nest_of(nodes["nest"], path, problems, f"{what}.nest")
    if drawn is None:
        return
    options = _options(nodes.get("options"), rule, problems, f"{what}.options")
    beside = _beside(nodes, drawn, problems, what)
    sides: tuple[tuple[Literal["right", "wrong"], CaseKind], ...] = (("right", "passes"), ("wrong", "fails"))
    for key, kind in sides:
        for k, order in zip(count(1), items(nodes[key], problems, f"{what}.{key}") if key in nodes else ()):
            cuts = _all_cuts(order, drawn, problems, f"{what}.{key}[{k}]")
            if cuts is not None:
                sequence = _sequence(cuts, beside, drawn, problems, what)
                yield Case(f"{number}, {key}: {order.value}", kind, drawn, sequence, options=options)


def _all_cuts(node: yaml.Node, drawn: Nest, problems: Problems, what: str) -> list[Cut] | None:
    cuts = read_cuts(node, drawn, problems, what)
    if cuts is None:
        return None
    missing = sorted(drawn.index.keys() - {c.contour for c in cuts})
    if missing or len(cuts) != len(drawn.contours):
        text = f"{', '.join(missing)} is missing" if missing else "one is there twice"
        problems.add(node, f"{what}: expected every contour of the nest once; {text}")
        return None
    return cuts


def _options(node: yaml.Node | None, rule: Rule[Any], problems: Problems, what: str) -> Any:
    """The options of a case: those of the rule, with what is given in their place; None where nothing is.

    What options take from the rest of a profile has the name of their field: `kerf_mm: 1.5`, `locks`.
    """
    if node is None:
        return None
    options = rule.Options()
    given: dict[str, Any] = {}
    known = {option.key: option for option in options_of(options)}
    names = {option.name for option in known.values()}
    taken = {f.name: f.default for f in dataclasses.fields(options) if f.name not in names}
    for key, key_node, value in entries(node, problems, what):
        if key in known:
            given[known[key].name] = known[key].kind.read_or_note(value, problems, f"{what}.{key}")
        elif key == "locks" and key in taken:
            given[key] = tuple(_lock(one, problems, f"{what}.{key}") for one in items(value, problems, what))
        elif key in taken:
            given[key] = _taken(value, type(taken[key]), problems, f"{what}.{key}")
        else:
            problems.add(key_node, f"{what}: {unknown('option', key, (*known, *taken))}")
    return replace(options, **given)


def _taken(node: yaml.Node, kind: type, problems: Problems, what: str) -> Any:
    value = plain(node)
    if isinstance(value, bool) == (kind is bool) and isinstance(value, (int, float) if kind is float else kind):
        return kind(value)
    problems.add(node, f"{what}: expected a value of type {kind.__name__}, got {shape(node)}")
    return None


def _lock(node: yaml.Node, problems: Problems, what: str) -> Lock:
    """A lock as in a job file; `place` is where that says so, such as plant.yaml:7:5."""
    known = {option.key: option for option in options_of(Lock)}
    given: dict[str, Any] = {}
    for key, value in read_keys(node, (*known, "place"), problems, what).items():
        if found := re.fullmatch(r"(.+):(\d+):(\d+)", str(value.value)) if key == "place" else None:
            given[key] = Place(found[1], int(found[2]), int(found[3]))
        elif key == "place":
            problems.add(value, f"{what}: expected a place, such as plant.yaml:7:5, got {shape(value)}")
        else:
            given[known[key].name] = known[key].kind.read_or_note(value, problems, f"{what}.{key}")
    return Lock(**given)


@dataclass(frozen=True, slots=True)
class _Beside:
    """What a case says of its cuts beside their order; `times` are start and end of each, s."""

    start_side: Side | None
    zones: Mapping[str, int]
    home: Sequence[float]
    pause_s: float
    times: yaml.Node | None
    hot_spots: tuple[HotSpot, ...] | None


def _beside(nodes: Mapping[str, yaml.Node], drawn: Nest, problems: Problems, what: str) -> _Beside:
    def read(key: str, reader: Callable[[yaml.Node, str], Any]) -> Any:
        return reader(nodes[key], f"{what}.{key}") if key in nodes else None

    return _Beside(
        read("start_side", lambda node, at: Choice(SIDES).read_or_note(node, problems, at)),
        read("zones", lambda node, at: _zones(node, drawn, problems, at)) or {},
        read("home", lambda node, at: numbers_of(node, problems, at, 2)) or (0.0, 0.0),
        read("pause", lambda node, at: DURATION.read_or_note(node, problems, at)) or 0.0,
        nodes.get("times"),
        read("hot_spots", lambda node, at: _hot_spots(node, problems, at)),
    )


def _sequence(cuts: Sequence[Cut], beside: _Beside, drawn: Nest, problems: Problems, what: str) -> CutSequence:
    spans = [(beside.pause_s * k, beside.pause_s * k) for k in range(1, len(cuts) + 1)]
    if beside.times is not None:
        spans = points_of(numbers_of(beside.times, problems, f"{what}.times", 2 * len(cuts)) or [])
    placed = (
        replace(one, zone=beside.zones.get(drawn.contour(one.contour).part, 0), start_s=start_s, end_s=end_s)
        for one, (start_s, end_s) in zip(cuts, spans, strict=False)
    )
    return CutSequence(tuple(placed), beside.start_side, (beside.home[0], beside.home[1]), beside.hot_spots)


def _zones(node: yaml.Node, drawn: Nest, problems: Problems, what: str) -> dict[str, int]:
    zones: dict[str, int] = {}
    for part_id, key, value in entries(node, problems, what):
        if part_id not in drawn.part_of:
            problems.add(key, f"{what}: {unknown('part', part_id, drawn.part_of)}")
        else:
            zones[part_id] = Number(1, whole=True).read_or_note(value, problems, f"{what}.{part_id}") or 0
    return zones


def _hot_spots(node: yaml.Node, problems: Problems, what: str) -> tuple[HotSpot, ...]:
    spots = []
    for one in items(node, problems, what):
        found = HOT_SPOT.fullmatch(str(one.value))
        if found is None:
            problems.add(one, f"{what}: expected 120 °C at 62.4 99.6 after 31 s, on a part or not, got {shape(one)}")
            continue
        peak_c, x, y, at_s = map(float, found.group(1, 2, 3, 4))
        spots.append(HotSpot(peak_c, (x, y), at_s, found[5] or ""))
    return tuple(spots)
