"""Criteria: what a selector asks of one fact; how values are read from YAML and described to an editor."""

from __future__ import annotations

import dataclasses
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any, Protocol

import yaml

from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Text, Unfit, noting
from kerfwise.rules.options.quantities import DURATION, LENGTH
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty, shape

# Criteria: what a selector asks of one fact, such as `"< 6"`, `2..6`, `[hole, outer]`, `P1*` or `true`.

ROUNDING_MM = 1e-6
"""Numbers that differ by less are equal: no choice may hang on the last bit of a coordinate."""


class Criterion(ABC):
    """One question about the value of a fact."""

    @abstractmethod
    def met(self, value: object) -> bool:
        """Whether a value answers it; a value that is not known (None) never does."""

    @abstractmethod
    def plain(self) -> object:
        """The YAML data that reads back as this criterion."""


@dataclass(frozen=True, slots=True)
class NumberSpan(Criterion):
    """A stretch of numbers; `negated` for all but it, `given` is how it was written.

    Examples
    --------
    >>> NumberSpan(high=6.0, without_high=True).met(6.0), NumberSpan(high=6.0).met(6.0)
    (False, True)
    """

    low: float = -math.inf
    high: float = math.inf
    without_low: bool = False
    without_high: bool = False
    negated: bool = False
    given: str = ""

    def met(self, value: object) -> bool:
        number = number_of(value)
        return number is not None and self._holds(number)

    def surely_met(self, value: float, slack_mm: float) -> bool:
        """Whether it holds for every number this near to the value."""
        return all(self._holds(v) for v in (value - slack_mm, value, value + slack_mm))

    def perhaps_met(self, value: float, slack_mm: float) -> bool:
        """Whether it holds for some number this near to the value."""
        return any(self._holds(v) for v in (value - slack_mm, value, value + slack_mm))

    def _holds(self, value: float) -> bool:
        low = self.low + ROUNDING_MM if self.without_low else self.low - ROUNDING_MM
        high = self.high - ROUNDING_MM if self.without_high else self.high + ROUNDING_MM
        above = value > low if self.without_low else value >= low
        below = value < high if self.without_high else value <= high
        return (above and below) != self.negated

    def plain(self) -> object:
        if re.fullmatch(r"-?\d+", self.given):
            return int(self.given)
        return self.given


@dataclass(frozen=True, slots=True)
class Pattern(Criterion):
    """A text, with * for any run of characters and ? for one."""

    pattern: str

    def met(self, value: object) -> bool:
        return value is not None and not isinstance(value, bool) and fnmatchcase(str(value), self.pattern)

    def plain(self) -> object:
        return self.pattern


@dataclass(frozen=True, slots=True)
class Truth(Criterion):
    """true or false."""

    wanted: bool

    def met(self, value: object) -> bool:
        return isinstance(value, bool) and value is self.wanted

    def plain(self) -> object:
        return self.wanted


@dataclass(frozen=True, slots=True)
class AnyOf(Criterion):
    """At least one of several."""

    criteria: tuple[Criterion, ...]

    def met(self, value: object) -> bool:
        return any(c.met(value) for c in self.criteria)

    def plain(self) -> object:
        return [c.plain() for c in self.criteria]


def number_of(value: object) -> float | None:
    """The number that a value is or spells, None for any other."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


# How the criteria of each kind of fact are read from YAML and described to an editor.

SIGNED_LENGTH = dataclasses.replace(LENGTH, at_least=None)
_TRUTHS = {"true": True, "yes": True, "on": True, "false": False, "no": False, "off": False}


@dataclass(frozen=True)
class ValueKind:
    """A kind of value that facts have: what is accepted of it in words and as JSON Schema, and how one is read."""

    expects: str
    one: Mapping[str, Any]
    criterion: Callable[[str, yaml.Node, ValueKind], Criterion]
    unit: str = ""
    listed: bool = True

    def read(self, node: yaml.Node) -> Criterion:
        """The criterion that a node states, any of several for a list; raises `Unfit`."""
        if self.listed and isinstance(node, yaml.SequenceNode) and node.value:
            return AnyOf(tuple(self.read_one(member) for member in node.value))
        return self.read_one(node)

    def read_one(self, node: yaml.Node) -> Criterion:
        """The criterion of one scalar."""
        if not isinstance(node, yaml.ScalarNode) or is_empty(node) or not node.value.strip():
            raise self.refuse(node)
        return self.criterion(str(node.value).strip(), node, self)

    def plain(self, value: Criterion) -> object:
        """The YAML data that reads back as a criterion of this kind."""
        return value.plain()

    def schema(self) -> dict[str, Any]:
        """JSON Schema of what `read` accepts."""
        return (
            {"anyOf": [self.one, {"type": "array", "items": self.one, "minItems": 1}]} if self.listed else {**self.one}
        )

    def refuse(self, node: yaml.Node) -> Unfit:
        """The error for a node this kind does not accept."""
        return Unfit(f"expected {self.expects}, got {shape(node)}")

    @property
    def single(self) -> ValueKind:
        """The same without lists."""
        return dataclasses.replace(self, listed=False)


def number_kind(operand: OptionKind, unit: str = "") -> ValueKind:
    """Numbers of one unit."""

    def number(text: str, node: yaml.Node, kind: ValueKind) -> float:
        try:
            return float(operand.read(yaml.ScalarNode("tag:yaml.org,2002:str", text.strip())))  # type: ignore[arg-type]
        except Unfit:
            raise kind.refuse(node) from None

    def span(text: str, node: yaml.Node, kind: ValueKind) -> Criterion:
        low, dots, high = text.partition("..")
        if dots:
            span = NumberSpan(number(low, node, kind), number(high, node, kind), given=text)
            if span.low > span.high:
                raise Unfit(f"{text!r} is empty: write the smaller number first")
            return span
        operator, rest = re.fullmatch(r"(<=|>=|!=|<|>|=)?\s*(.*)", text, re.DOTALL).groups()  # type: ignore[union-attr]
        value = number(rest, node, kind)
        match operator:
            case "<" | "<=":
                return NumberSpan(high=value, without_high=operator == "<", given=text)
            case ">" | ">=":
                return NumberSpan(low=value, without_low=operator == ">", given=text)
        return NumberSpan(value, value, negated=operator == "!=", given=text)

    one = {"anyOf": [{"type": "number"}, {"type": "string", "pattern": r"^\s*(<=|>=|!=|<|>|=)?\s*[-+0-9.]"}]}
    of = f" of {unit}" if unit else ""
    return ValueKind(f"a number{of} such as 6, '< 6', '>= 6', '!= 6' or 2..6, or a list of them", one, span, unit)


def word_kind(words: tuple[str, ...]) -> ValueKind:
    """One of a few words."""
    expects = f"{Choice(words).expected()}, or a list of them"
    return ValueKind(expects, {"enum": list(words)}, lambda _, node, kind: Pattern(str(Choice(words).read(node))))


def _flag(text: str, node: yaml.Node, kind: ValueKind) -> Criterion:
    if text.lower() not in _TRUTHS:
        raise kind.refuse(node)
    return Truth(_TRUTHS[text.lower()])


def _free(text: str, node: yaml.Node, kind: ValueKind) -> Criterion:
    """Whatever a nest's author has written."""
    if node.tag == "tag:yaml.org,2002:bool":
        return _flag(text, node, kind)
    if re.match(r"[<>=!]", text) or re.fullmatch(r"[-+.\d]+", text):
        return COUNTED.read_one(node)
    return Pattern(text)


LENGTHS = number_kind(SIGNED_LENGTH, "mm")
AREAS = number_kind(Number(0), "mm²")
COUNTED = number_kind(Number())
SECONDS = number_kind(DURATION, "s")
KILOGRAMS = number_kind(Number(0), "kg")
TEXTS = ValueKind(
    "a text such as P1 or 'P*', or a list of them",
    {"type": ["string", "number"]},
    lambda text, node, kind: Pattern(text),
)
FLAGS = ValueKind("true or false", {"type": "boolean"}, _flag, listed=False)
FREE = ValueKind(
    "a number such as 1, '> 1' or 1..3, a text such as 'P*', true or false, or a list of them",
    {"type": ["string", "number", "boolean"]},
    _free,
)


SHOWN = 8
"""So many values of a fact are shown in a message."""


def none_has(fact: str, text: object, values: Iterable[object]) -> str:
    """That no contour has this value of a fact, and which there are.

    Examples
    --------
    >>> none_has("layer", "A", ["B", "", None, "C", "B"])
    "none has the layer 'A'; there is 'B', 'C'"
    """
    there = sorted({str(value) for value in values if value not in (None, "")})
    shown = ", ".join(f"'{value}'" for value in there[:SHOWN]) + (", …" if len(there) > SHOWN else "")
    return f"none has the {fact} {text!r}; there is {shown or 'nothing of that kind'}"


KeyedNodes = list[tuple[str, yaml.Node, yaml.Node]]


class Form(Protocol):
    """One form of value."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        """The value of a node; None, with what is wrong noted, where it cannot be read."""

    def plain(self, value: Any) -> object:
        """The YAML data that reads back as the value."""

    def schema(self) -> dict[str, Any]:
        """JSON Schema of what is accepted."""


@dataclass(frozen=True)
class Scalar:
    """One value of an option's kind, or a criterion."""

    kind: OptionKind | ValueKind

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        with noting(problems, node, what):
            return self.kind.read(node)
        return None

    def plain(self, value: Any) -> object:
        if isinstance(self.kind, ValueKind):
            return self.kind.plain(value)
        return value if isinstance(self.kind, Choice | Number | Text) else self.kind.write(value)

    def schema(self) -> dict[str, Any]:
        return self.kind.schema()


class _True(Scalar):
    """For keys that say all by being there."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        if super().read(node, problems, what) is False:
            problems.add(node, f"{what}: expected true; leave the key out to ask nothing")
        return True

    def plain(self, value: Any) -> object:
        return True

    def schema(self) -> dict[str, Any]:
        return {"const": True}


TRUE = _True(Flag())


@dataclass(frozen=True)
class Group:
    """A mapping of keys, each with its form and a line of help: those `required`, one of `one_of`, some of `any_of`.

    Whether these are there, the reader of the whole sees. `example` says what a mapping without keys lacks, "" where
    that is nobody's business here; keys that are read `elsewhere` are left alone.
    """

    forms: Mapping[str, tuple[Form, str]]
    one_of: tuple[str, ...] = ()
    any_of: tuple[str, ...] = ()
    required: tuple[str, ...] = ()
    example: str = ""
    noun: str = "key"
    elsewhere: tuple[str, ...] = ()

    def read(self, node: yaml.Node, problems: Problems, what: str) -> tuple[tuple[str, Any], ...]:
        if self.example and (is_empty(node) or not isinstance(node, yaml.MappingNode) or not node.value):
            problems.add(node, f"{what}: expected {self.example}, got {shape(node)}")
            return ()
        return tuple(self.read_members(list(entries(node, problems, what)), problems, what))

    def read_members(self, members: KeyedNodes, problems: Problems, what: str) -> Iterator[tuple[str, Any]]:
        """The keys that are known with their values, as far as these can be read."""
        only = next((key for key, _, _ in members if key in self.one_of), None)
        for key, key_node, value in members:
            if key in self.elsewhere:
                continue
            if key not in self.forms:
                valid = [*self.forms, *self.elsewhere]
                problems.add(key_node, f"{what}: {unknown(self.noun, key, valid)}")
            elif key in self.one_of and key != only:
                text = f"a rule asks one thing, this one asks {only} and {key}; write two rules"
                problems.add(key_node, f"{what}: {text}")
            else:
                read = self.forms[key][0].read(value, problems, f"{what}.{key}")
                if read is not None:
                    yield key, read

    def plain(self, value: tuple[tuple[str, Any], ...]) -> dict[str, object]:
        return {key: self.forms[key][0].plain(one) for key, one in value}

    def schema(self) -> dict[str, Any]:
        told = {key: {"description": help} if help else {} for key, (_, help) in self.forms.items()}
        keys = {key: told[key] | form.schema() for key, (form, _) in self.forms.items()}
        wanted = {"oneOf": self.one_of, "anyOf": self.any_of}
        asked = {word: [{"required": [key]} for key in some] for word, some in wanted.items() if some}
        least = {"minProperties": 1} if self.example else {}
        required = {"required": list(self.required)} if self.required else {}
        closed = {"type": "object", "properties": keys} | required | {"additionalProperties": False}
        return closed | asked | least
