"""Own rules: a name, a reason, which contours, and what is asked of them, in the YAML of a profile."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from yaml.representer import SafeRepresenter

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.files import expect_readable, is_file
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.expression.node import Gate
from kerfwise.rules.expression.over_cuts import breaches, sums_of_ids
from kerfwise.rules.expression.to_statements import statement_of
from kerfwise.rules.options.kind import Choice, OptionKind, Text, noting
from kerfwise.rules.options.quantities import LENGTH, WEIGHT
from kerfwise.rules.options.yaml_positions import Place as FilePlace
from kerfwise.rules.options.yaml_positions import Problems, entries, items
from kerfwise.rules.rule import USUAL, Plate, Rule, Strength, SumOfIds, Violation
from kerfwise.rules.statements import About, Statement

from .criteria import Form, Group, KeyedNodes, Scalar
from .demands import ASKS, DEMANDS, Chosen, Demand
from .known_nest import KnownNest, MeasuredNest, PlannedNest
from .selector import SELECTOR, Scope, Selector, groups, selector_schema

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

PREFIX = "own:"
"""What the id of every own rule begins with."""


@dataclass(frozen=True, slots=True)
class OwnRule:
    """One entry of a profile's `own_rules`; `weight` (mm of idle travel) only where it is soft."""

    name: str
    ask: Demand
    select: Selector = field(default_factory=Selector)
    scope: str = "sheet"
    why: str = "a rule of the plant's own"
    strength: Strength = "hard"
    weight: float | None = None
    place: FilePlace | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """What plans and checks call it."""
        return PREFIX + self.name

    def facts(self) -> set[str]:
        """Names of the facts that it looks at."""
        reach = {self.scope} - {"sheet"}
        return set().union(reach, self.select.names(), self.ask.facts(), *(s.names() for s in self.ask.selectors()))

    def chosen(self, known: KnownNest) -> Chosen:
        """Which contours it is about on one nest."""
        selected = set(self.select.chosen(known))
        parted = ((tuple(k for k in group if k in selected), group) for group in groups(known, self.scope))
        return Chosen(self.id, known, tuple((own, group) for own, group in parted if own))

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this rule."""
        key = self.ask.key
        result: dict[str, object] = {"name": self.name, "why": self.why, "strength": self.strength}
        if self.weight is not None:
            result["weight"] = LENGTH.write(self.weight)
        return result | {"select": self.select.plain(), key: DEMANDS[key][0].plain(self.ask.value), "scope": self.scope}


@dataclass(frozen=True, slots=True)
class OwnFile:
    """An entry `{file: rule.mzn}`: a rule in MiniZinc, which `rules/flat` reads.

    `parameters` are those of the file that the entry sets, by key.
    """

    file: str
    name: str
    why: str = "a rule of the plant's own, in MiniZinc"
    strength: Strength = "hard"
    weight: float | None = None
    parameters: tuple[tuple[str, int | bool | str], ...] = ()
    place: FilePlace | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """What plans and checks call it."""
        return PREFIX + self.name

    def with_parameters(self, values: Mapping[str, int | bool | str]) -> OwnFile:
        """The same entry with these parameters and no others."""
        return replace(self, parameters=tuple(values.items()))

    @property
    def path(self) -> Path:
        """The file, looked up beside the profile that names it."""
        return Path(self.place.file).parent / self.file if self.place else Path(self.file)

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this entry."""
        result: dict[str, object] = {"file": self.file, "name": self.name, "why": self.why, "strength": self.strength}
        if self.weight is not None:
            result["weight"] = LENGTH.write(self.weight)
        return result | {"parameters": dict(self.parameters)} if self.parameters else result


Own = OwnRule | OwnFile


# An own rule as a rule like any other: what it states over facts, and how it is judged by geometry.


@dataclass(frozen=True, slots=True)
class Thresholds:
    """What the facts `long` and `neighbours_count` hang on, and what a rule may read of the profile."""

    long_ratio: float = 4.0
    web_mm: float = 25.0
    plate: Plate = USUAL


class PlantRule(Rule[Thresholds]):
    """One entry of `own_rules`, stated and judged like a rule of the catalogue. It gives way to none."""

    Options = Thresholds
    of_whole_nest = True

    def __init__(self, rule: OwnRule) -> None:
        self.rule, self.id, self.sentence = rule, rule.id, rule.why
        self.source = "the plant"
        self.minds_what_is_out = rule.ask.MINDS_WHAT_IS_OUT

    def statements(self, facts: Facts, options: Thresholds) -> Iterator[Statement]:
        contours, chosen = facts.nest.contours, self.rule.chosen(PlannedNest(facts, options.plate))
        for condition in self.rule.ask.conditions(chosen):
            ids = tuple(contours[k].id for k in condition.contours)
            yield statement_of(condition.asked, About(self.id, ids, f"{condition.sentence}: {self.rule.why}"))

    def violations(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[Violation]:
        if self.unjudged(nest, cuts, options) is not None:
            return []
        asked = self.rule.ask.conditions(self._chosen(nest, cuts, options))
        return [
            Violation(self.id, contours, f"{text}: {self.rule.why}", positions, asked=of)
            for (contours, text, positions), of in breaches(asked, nest, cuts)
        ]

    def pairs(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[Ids]:
        contours = nest.contours
        found = self.rule.ask.pairs(self._chosen(nest, cuts, options))
        return [(contours[a].id, contours[b].id) for a, b in found]

    def sums(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> list[SumOfIds]:
        if self.unjudged(nest, cuts, options) is not None:
            return []
        asked = self.rule.ask.conditions(self._chosen(nest, cuts, options))
        return sums_of_ids(nest, (of.asked for of in asked if isinstance(of.asked, Gate)))

    def together(self, nest: Nest, options: Thresholds) -> list[tuple[str, ...]]:
        if "zone" in self.rule.facts():
            return []
        chosen = self._chosen(nest, None, options)
        return [chosen.ids(*run) for run in self.rule.ask.together(chosen)]

    def unjudged(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> str | None:
        if "zone" in self.rule.facts() and not any(cut.zone for cut in cuts):
            return "the zones of the cuts are not stated"
        return self.selects_nothing(nest, cuts, options) or self.rule.ask.unjudged(cuts)

    def selects_nothing(self, nest: Nest, cuts: CutSequence, options: Thresholds) -> str | None:
        known = self._known(nest, cuts, options)
        for selector in (self.rule.select, *self.rule.ask.selectors()):
            if not selector.chosen(known):
                return f"it selects no contour of this nest: {selector.why_nothing(known)}"
        if not self.rule.chosen(known).groups:
            return f"it selects no contour of this nest within {self.rule.scope}"
        return None

    def _chosen(self, nest: Nest, cuts: CutSequence | None, options: Thresholds) -> Chosen:
        return self.rule.chosen(self._known(nest, cuts, options))

    def _known(self, nest: Nest, cuts: CutSequence | None, options: Thresholds) -> KnownNest:
        return MeasuredNest(nest, cuts, options.long_ratio, options.web_mm, options.plate)


def as_rule(own: OwnRule) -> PlantRule:
    """The rule that an entry of `own_rules` in YAML makes."""
    return PlantRule(own)


def own_pairs(rules: tuple[Own, ...], nest: Nest, thresholds: Thresholds) -> tuple[Ids, ...]:
    """Contour ids (before, after) that hard own rules order, but for rules about zones: no zone may
    contradict them."""
    known = MeasuredNest(nest, None, thresholds.long_ratio, thresholds.web_mm, thresholds.plate)
    contours = nest.contours
    return tuple(
        (contours[a].id, contours[b].id)
        for rule in rules
        if isinstance(rule, OwnRule) and rule.strength == "hard" and "zone" not in rule.facts()
        for a, b in rule.ask.pairs(rule.chosen(known))
    )


# An entry of `own_rules`: plain keys and one demand, or a file: `{file: rivets_first.mzn, parameters: {most: 800}}`.

ParametersOf = Callable[[Path], Mapping[str, OptionKind]]
"""The parameters that the rule in a file declares, by key; raises `InputError` where the file is no rule."""
DEFAULT_WEIGHT_MM = 1000.0
STRENGTHS: tuple[Strength, ...] = ("hard", "soft", "off")
PLAIN: Mapping[str, tuple[Form, str]] = {
    "name": (Scalar(Text()), "what plans and checks call the rule, after own:"),
    "why": (Scalar(Text()), "the reason, in words for the planner"),
    "strength": (Scalar(Choice(STRENGTHS)), "default hard"),
    "weight": (Scalar(WEIGHT), "of a soft rule: cost of breaking it once, in idle travel (default 1000 mm)"),
    "scope": (Scalar(Scope()), "within what the rule holds (default sheet)"),
}
SELECT: tuple[Form, str] = (SELECTOR, "which contours the rule is about (default all)")
ENTRY = Group({**PLAIN, "select": SELECT, **DEMANDS}, one_of=tuple(DEMANDS), required=("name",), elsewhere=("file",))
FILE = Group(
    {
        "file": (Scalar(Text()), "a MiniZinc file, beside the profile"),
        **{key: PLAIN[key] for key in ("name", "why", "strength", "weight")},
    },
    required=("file",),
    noun="key of a rule in a file",
    elsewhere=("parameters",),
)


def read_values(form: Group, members: KeyedNodes, problems: Problems, what: str) -> dict[str, Any]:
    """The values of an entry's keys; a soft rule has a weight."""
    strength = next((value.value for key, _, value in members if key == "strength"), "hard")
    for key, _, value in members:
        if key == "weight" and strength != "soft":
            problems.add(value, f"{what}.weight: only a soft rule has a weight, this one is {strength}")
    weight = {"weight": DEFAULT_WEIGHT_MM} if strength == "soft" else {}
    return weight | dict(form.read_members(members, problems, what))


def read_file_entry(
    entry: yaml.Node, members: KeyedNodes, problems: Problems, what: str, parameters_of: ParametersOf
) -> OwnFile | None:
    """The entry; None, with what is wrong noted in `problems`, where it cannot be read.

    Raises InputError if the entry gives parameters and the file is no rule.
    """
    so_far = len(problems.found)
    values = read_values(FILE, members, problems, what)
    if len(problems.found) > so_far:
        return None
    values.setdefault("name", Path(values["file"]).stem)
    file_entry = OwnFile(place=problems.place(entry), **values)
    node = next(value for key, _, value in members if key == "file")
    if file_entry.path.suffix != ".mzn":
        problems.add(node, f"{what}.file: expected a MiniZinc file such as plant_rule.mzn, got {file_entry.file!r}")
        return file_entry
    expect_readable(file_entry.path)  # whether it is there or not
    if not is_file(file_entry.path):
        problems.add(node, f"{what}.file: there is no file {str(file_entry.path)!r}")
        return file_entry
    return with_parameters(file_entry, members, problems, what, parameters_of)


def with_parameters(
    rule: OwnFile, members: KeyedNodes, problems: Problems, what: str, parameters_of: ParametersOf
) -> OwnFile:
    """The rule with the `parameters` among the members of its entry; what is wrong with them is noted."""
    found = [value for key, _, value in members if key == "parameters"]
    if not found:
        return rule
    kinds = parameters_of(rule.path)
    values: dict[str, Any] = {}
    for key, key_node, value in entries(found[0], problems, f"{what}.parameters"):
        if key not in kinds:
            text = unknown("parameter", key, list(kinds)) if kinds else f"{rule.file} declares no parameter"
            problems.add(key_node, f"{what}.parameters: {text}")
            continue
        with noting(problems, value, f"{what}.parameters.{key}"):
            values[key] = kinds[key].read(value)
    return rule.with_parameters(values)


def read_own_rules(node: yaml.Node, problems: Problems, parameters_of: ParametersOf) -> tuple[Own, ...]:
    """The plant's own rules; what is wrong with them is noted in `problems`.

    Raises InputError if an entry gives parameters of a file that is no rule.
    """
    rules: dict[str, Own] = {}
    for number, entry in enumerate(items(node, problems, "own_rules"), 1):
        what = f"own_rules[{number}]"
        so_far = len(problems.found)
        members = list(entries(entry, problems, what))
        is_file = any(key == "file" for key, _, _ in members)
        if len(problems.found) > so_far:
            continue
        rule: Own | None
        if is_file:
            rule = read_file_entry(entry, members, problems, what, parameters_of)
        else:
            rule = read_own_rule(entry, members, problems, what)
        if rule is not None and rule.name in rules:
            problems.add(entry, f"{what}: the name {rule.name!r} is taken by an own rule before it")
        elif rule is not None:
            rules[rule.name] = rule
    return tuple(rules.values())


def read_own_rule(entry: yaml.Node, members: KeyedNodes, problems: Problems, what: str) -> OwnRule | None:
    """The entry; None, with what is wrong noted in `problems`, where it cannot be read."""
    so_far = len(problems.found)
    values = read_values(ENTRY, members, problems, what)
    ask = next((ASKS[key](key, values.pop(key)) for key in ASKS if key in values), None)
    if len(problems.found) == so_far:
        if ask is None:
            problems.add(entry, f"{what}: nothing is asked: give one of {', '.join(ASKS)}")
        elif wrong := ask.wrong():
            node = next(value for key, _, value in members if key == ask.key)
            problems.add(node, f"{what}.{ask.key}{wrong}")
        if "name" not in values:
            problems.add(entry, f"{what}: give the rule a name")
    if ask is None or len(problems.found) > so_far:
        return None
    return OwnRule(ask=ask, place=problems.place(entry), **values)


def own_rules_schema() -> dict[str, Any]:
    """JSON Schema of `own_rules`; it refers to `own_rules_definitions` under `$defs`."""
    parameters = {
        "description": "of a rule in a file: values of the parameters that it declares, by name (default the file's)",
        "type": "object",
        "additionalProperties": {"type": ["integer", "boolean", "string"]},
    }
    entry, file = ENTRY.schema(), FILE.schema()
    file["properties"]["parameters"] = parameters
    return {
        "type": ["array", "null"],
        "description": "rules of the plant's own",
        "items": {"oneOf": [entry, file]},
    }


def own_rules_definitions() -> dict[str, Any]:
    """The `$defs` that the schema of `own_rules` refers to."""
    return {"selector": selector_schema()}


# Values of the plant's own rules that one nest has otherwise: `own_rules.narrow slots first.weight: 300 mm`.

SECTION = "own_rules"
_MAP, _STR = "tag:yaml.org,2002:map", "tag:yaml.org,2002:str"

KeyAndNode = tuple[str, yaml.Node, yaml.Node]
"""What is set: a key with dots, where it stands, and the value."""
Data = dict[str, object]
"""A rule as YAML data; what is set in it is a node."""


def is_own(key: str) -> bool:
    """Whether a key that is set is one of an own rule: `own_rules…` or, as plans call the rule, `own:…`."""
    return key == SECTION or key.startswith((f"{SECTION}.", PREFIX))


def with_own_values(
    own: Sequence[Own], settings: Iterable[KeyAndNode], problems: Problems, parameters_of: ParametersOf
) -> tuple[Own, ...]:
    """The own rules of a profile with what is set in them; what is wrong is noted in `problems`.

    A value that is no mapping is the rule's strength. What is not set stays as it is, however deep.
    """
    changed: dict[str, tuple[yaml.Node, Data]] = {}
    rules = {rule.name: rule for rule in own}
    for rest, key_node, value in _each(settings):
        name = _named(rest, rules)
        if name is None:
            text = unknown("own rule", rest, list(rules)) if rules else "the profile has no own rules"
            problems.add(key_node, f"set: {text}")
            continue
        path = rest[len(name) + 1 :].split(".") if len(rest) > len(name) else []
        if not path and not isinstance(value, yaml.MappingNode):
            path = ["strength"]
        twice = _put(changed.setdefault(name, (key_node, rules[name].plain()))[1], path, value)
        if twice is not None:
            problems.add(key_node, f"set: {'.'.join((SECTION, name, *twice))} is set twice")
    return tuple(
        _changed(rule, *changed[rule.name], problems, parameters_of) if rule.name in changed else rule for rule in own
    )


def _each(settings: Iterable[KeyAndNode]) -> Iterator[KeyAndNode]:
    """What is set, by the name of the rule and what comes after it."""
    for key, key_node, value in settings:
        if key == SECTION:
            if isinstance(value, yaml.MappingNode):
                yield from ((str(name.value), name, of) for name, of in value.value)
            else:
                yield "", key_node, value
        else:
            yield key.removeprefix(PREFIX) if key.startswith(PREFIX) else key[len(SECTION) + 1 :], key_node, value


def _named(rest: str, names: Iterable[str]) -> str | None:
    """The rule that a key begins with the name of; the longest name, since a name may have dots."""
    found = [name for name in names if rest == name or rest.startswith(f"{name}.")]
    return max(found, key=len, default=None)


def _put(data: Data, path: Sequence[str], value: yaml.Node, above: Sequence[str] = ()) -> tuple[str, ...] | None:
    """Put a value where its path leads to, mappings key by key; the path of a value that was set already."""
    if not path:
        members = value.value if isinstance(value, yaml.MappingNode) else ()
        return next(filter(None, [_put(data, [str(key.value)], of, above) for key, of in members]), None)
    here, found = (*above, path[0]), data.get(path[0])
    if path[1:] or isinstance(value, yaml.MappingNode):
        if isinstance(found, yaml.Node):
            return here
        under: Data = dict(found) if isinstance(found, Mapping) else {}
        data[path[0]] = under
        return _put(under, path[1:], value, here)
    data[path[0]] = value
    return here if _is_set(found) else None


def _is_set(value: object) -> bool:
    """Whether something of the value is a node."""
    return isinstance(value, yaml.Node) or (isinstance(value, Mapping) and any(map(_is_set, value.values())))


def _changed(rule: Own, at: yaml.Node, data: Data, problems: Problems, parameters_of: ParametersOf) -> Own:
    what = f"{SECTION}.{rule.name}"
    if _is_set(data["name"]):
        problems.add(at, f"{what}.name: a rule keeps its name")
        return rule
    strength = data["strength"]
    if isinstance(strength, yaml.ScalarNode) and strength.value != "soft" and not _is_set(data.get("weight")):
        data.pop("weight", None)
    members = [(key, _key(key, at), _node(value, at)) for key, value in data.items()]
    if isinstance(rule, OwnRule):
        entry = yaml.MappingNode(_MAP, [member[1:] for member in members], at.start_mark, at.end_mark)
        made = read_own_rule(entry, members, problems, what)
        return rule if made is None else dataclasses.replace(made, place=rule.place)
    for key in (key for key, value in data.items() if _is_set(value) and key not in _OF_FILE):
        problems.add(at, f"{what}: {unknown(FILE.noun, key, _OF_FILE[1:])}")
    known = [member for member in members if member[0] in FILE.forms]
    changed = dataclasses.replace(rule, **{"weight": None} | read_values(FILE, known, problems, what))
    return with_parameters(changed, members, problems, what, parameters_of)


_OF_FILE = ("name", "why", "strength", "weight", "parameters")


def _key(key: str, at: yaml.Node) -> yaml.Node:
    return yaml.ScalarNode(_STR, key, at.start_mark, at.end_mark)


def _node(value: object, at: yaml.Node) -> yaml.Node:
    """Data as YAML; what comes from the profile stands where it is set."""
    if isinstance(value, yaml.Node):
        return value
    if isinstance(value, Mapping):
        return yaml.MappingNode(
            _MAP, [(_key(k, at), _node(v, at)) for k, v in value.items()], at.start_mark, at.end_mark
        )
    if isinstance(value, list | tuple):
        return yaml.SequenceNode("tag:yaml.org,2002:seq", [_node(v, at) for v in value], at.start_mark, at.end_mark)
    node = SafeRepresenter().represent_data(value)
    node.start_mark, node.end_mark = at.start_mark, at.end_mark
    return node
