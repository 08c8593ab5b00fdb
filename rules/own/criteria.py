"""Criteria: what a selector asks of one fact, how it is read from YAML and described to an editor."""

from __future__ import annotations

import dataclasses
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

import yaml

from kerfwise.rules.options.kind import Choice, Number, OptionKind, Unfit
from kerfwise.rules.options.quantities import DURATION, LENGTH
from kerfwise.rules.options.yaml_positions import is_empty, shape

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


class ValueKind(ABC):
    """A kind of value that facts have."""

    unit: str = ""

    def read(self, node: yaml.Node) -> Criterion:
        """The criterion that a node states, any of several for a list; raises `Unfit`."""
        if isinstance(node, yaml.SequenceNode) and node.value:
            return AnyOf(tuple(self.read_one(member) for member in node.value))
        return self.read_one(node)

    @abstractmethod
    def read_one(self, node: yaml.Node) -> Criterion:
        """The criterion of one scalar."""

    @abstractmethod
    def expected(self) -> str:
        """What is accepted, in words."""

    @abstractmethod
    def schema_of_one(self) -> dict[str, Any]:
        """JSON Schema of one scalar."""

    def schema(self) -> dict[str, Any]:
        """JSON Schema of what `read` accepts."""
        one = self.schema_of_one()
        return {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}]}

    def text(self, node: yaml.Node) -> str:
        """The text of a scalar."""
        if not isinstance(node, yaml.ScalarNode) or is_empty(node) or not node.value.strip():
            raise self.refuse(node)
        return str(node.value).strip()

    def refuse(self, node: yaml.Node) -> Unfit:
        """The error for a node this kind does not accept."""
        return Unfit(f"expected {self.expected()}, got {shape(node)}")


@dataclass(frozen=True)
class NumberKind(ValueKind):
    """Numbers of one unit."""

    operand: OptionKind
    unit: str = ""

    def read_one(self, node: yaml.Node) -> Criterion:
        text = self.text(node)
        low, dots, high = text.partition("..")
        if dots:
            span = NumberSpan(self._operand(low, node), self._operand(high, node), given=text)
            if span.low > span.high:
                raise Unfit(f"{text!r} is empty: write the smaller number first")
            return span
        operator, operand = re.fullmatch(r"(<=|>=|!=|<|>|=)?\s*(.*)", text, re.DOTALL).groups()  # type: ignore[union-attr]
        value = self._operand(operand, node)
        match operator:
            case "<" | "<=":
                return NumberSpan(high=value, without_high=operator == "<", given=text)
            case ">" | ">=":
                return NumberSpan(low=value, without_low=operator == ">", given=text)
            case _:
                return NumberSpan(value, value, negated=operator == "!=", given=text)

    def _operand(self, text: str, node: yaml.Node) -> float:
        try:
            value = self.operand.read(yaml.ScalarNode("tag:yaml.org,2002:str", text.strip()))
        except Unfit:
            raise self.refuse(node) from None
        assert isinstance(value, int | float)
        return float(value)

    def expected(self) -> str:
        unit = f" of {self.unit}" if self.unit else ""
        return f"a number{unit} such as 6, '< 6', '>= 6', '!= 6' or 2..6, or a list of them"

    def schema_of_one(self) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": r"^\s*(<=|>=|!=|<|>|=)?\s*[-+0-9.]"}]}


@dataclass(frozen=True)
class WordKind(ValueKind):
    """One of a few words."""

    words: tuple[str, ...]

    def read_one(self, node: yaml.Node) -> Criterion:
        return Pattern(str(Choice(self.words).read(node)))

    def expected(self) -> str:
        return f"{Choice(self.words).expected()}, or a list of them"

    def schema_of_one(self) -> dict[str, Any]:
        return {"enum": list(self.words)}


class TextKind(ValueKind):
    """Any text, with * and ? for what is left open."""

    def read_one(self, node: yaml.Node) -> Criterion:
        return Pattern(self.text(node))

    def expected(self) -> str:
        return "a text such as P1 or 'P*', or a list of them"

    def schema_of_one(self) -> dict[str, Any]:
        return {"type": ["string", "number"]}


class FlagKind(ValueKind):
    """true or false."""

    def read(self, node: yaml.Node) -> Criterion:
        return self.read_one(node)

    def read_one(self, node: yaml.Node) -> Criterion:
        text = self.text(node).lower()
        if text not in _TRUTHS:
            raise self.refuse(node)
        return Truth(_TRUTHS[text])

    def expected(self) -> str:
        return "true or false"

    def schema_of_one(self) -> dict[str, Any]:
        return {"type": "boolean"}

    def schema(self) -> dict[str, Any]:
        return self.schema_of_one()


class FreeKind(ValueKind):
    """Whatever a nest's author has written: a number, a text, or true and false."""

    def read_one(self, node: yaml.Node) -> Criterion:
        text = self.text(node)
        if isinstance(node, yaml.ScalarNode) and node.tag == "tag:yaml.org,2002:bool":
            return Truth(_TRUTHS[text.lower()])
        if re.match(r"[<>=!]", text) or re.fullmatch(r"[-+.\d]+", text):
            return COUNTED.read_one(node)
        return Pattern(text)

    def expected(self) -> str:
        return "a number such as 1, '> 1' or 1..3, a text such as 'P*', true or false, or a list of them"

    def schema_of_one(self) -> dict[str, Any]:
        return {"type": ["string", "number", "boolean"]}


LENGTHS = NumberKind(SIGNED_LENGTH, "mm")
AREAS = NumberKind(Number(0), "mm²")
COUNTED = NumberKind(Number())
SECONDS = NumberKind(DURATION, "s")
KILOGRAMS = NumberKind(Number(0), "kg")


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
