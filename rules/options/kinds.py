"""The kinds of value an option can have: how each is read from YAML, written back, and described to an editor.

Quantities are bare numbers in the unit of the kind, or text with a unit of its own: `1.5`, `"1.5 mm"`, `0.1 m/s`.
"""

from __future__ import annotations

import dataclasses
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import yaml

from .suggest import nearest
from .yaml_positions import is_empty, shape

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,2})?"


MOST = 1e9
"""No number of a profile is larger, whatever it is of."""


LONGEST = 60
"""Characters of a number and its unit."""


class Unfit(ValueError):
    """A value that its kind does not accept; the text says what was given and what was expected.

    `node` is the part of the value that is wrong, None for all of it.
    """

    def __init__(self, text: str, node: yaml.Node | None = None) -> None:
        super().__init__(text)
        self.node = node


class Kind(ABC):
    """One kind of value."""

    @abstractmethod
    def read(self, node: yaml.Node) -> object:
        """The value of a YAML node, in the program's own units; raises `Unfit`."""

    @abstractmethod
    def write(self, value: Any) -> str:
        """The value as YAML text that reads back the same."""

    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """JSON Schema of the values accepted."""

    @abstractmethod
    def expected(self) -> str:
        """What is accepted, in words."""

    def refuse(self, node: yaml.Node) -> Unfit:
        """The error for a node this kind does not accept."""
        return Unfit(f"expected {self.expected()}, got {shape(node)}{_decimal_comma(node)}", node)


@dataclass(frozen=True, slots=True)
class Quantity(Kind):
    """A number with a unit: `units` are their sizes in the program's own, `bare` is that of a bare number.

    Every quantity has an end, `at_most`, far beyond what any plant has: sums of costs then fit the engines' integers.
    """

    name: str
    units: Mapping[str, Fraction]
    bare: str
    at_most: float
    at_least: float | None = 0.0
    above: float | None = None
    example: str = "1.5"

    def read(self, node: yaml.Node) -> float:
        found = re.fullmatch(rf"\s*({_NUMBER})\s*((?:[a-z/%°][A-Za-z0-9/%]*)?)\s*", _digits(node, self))
        if found is None:
            raise self.refuse(node)
        number, unit = found[1], found[2] or self.bare
        if unit not in self.units:
            raise Unfit(f"unknown unit {unit!r} in {found[0]!r}: expected {self.expected()}", node)
        value = float(Fraction(number) * self.units[unit])
        if (self.at_least is not None and value < self.at_least) or (self.above is not None and value <= self.above):
            raise self.refuse(node)
        if abs(value) > self.at_most:
            most = f"{self._most():g} {self.bare}"
            raise Unfit(f"expected {self.expected()}, and no more than {most}, got {found[0].strip()!r}", node)
        return value

    def _most(self) -> float:
        return float(Fraction(self.at_most) / self.units[self.bare])

    def write(self, value: float) -> str:
        base = next(unit for unit, size in self.units.items() if size == 1)
        text = f"{float(Fraction(value) / self.units[self.bare]):.12g}"
        exact = float(Fraction(text) * self.units[self.bare]) == value
        return f"{text} {self.bare}" if exact else f"{value!r} {base}"

    def schema(self) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "number", "maximum": self._most()}
        if self.at_least is not None:
            number["minimum"] = self.at_least
        if self.above is not None:
            number["exclusiveMinimum"] = self.above
        pattern = rf"^\s*{_NUMBER}\s*({'|'.join(self.units)})?\s*$"
        return {"anyOf": [number, {"type": "string", "pattern": pattern}]}

    def expected(self) -> str:
        least = "" if self.at_least is None else f" of at least {self.at_least:g}"
        least = f" over {self.above:g}" if self.above is not None else least
        others = ", ".join(u for u in self.units if u != self.bare)
        also = f" (also {others})" if others else ""
        return f"{self.name}{least} such as {self.example} or '{self.example} {self.bare}'{also}"


LENGTH = Quantity(
    "a length",
    {"mm": Fraction(1), "cm": Fraction(10), "m": Fraction(1000), "in": Fraction("25.4")},
    "mm",
    at_most=1e6,
)
SPEED = Quantity(
    "a speed",
    {
        "mm/min": Fraction(1, 60),
        "mm/s": Fraction(1),
        "m/min": Fraction(1000, 60),
        "m/s": Fraction(1000),
        "in/min": Fraction("25.4") / 60,
    },
    "mm/min",
    at_most=1e5,
    at_least=None,
    above=0.0,
    example="2500",
)
ACCELERATION = Quantity(
    "an acceleration",
    {"mm/s2": Fraction(1), "m/s2": Fraction(1000), "g": Fraction("9806.65")},
    "m/s2",
    at_most=1e8,
    at_least=None,
    above=0.0,
)
TEMPERATURE = Quantity("a temperature", {"°C": Fraction(1)}, "°C", at_most=1e5, at_least=-273.15, example="115")
DURATION = Quantity(
    "a time", {"s": Fraction(1), "ms": Fraction(1, 1000), "min": Fraction(60)}, "s", at_most=1e5, example="0.5"
)
ENERGY = Quantity("an energy", {"kJ": Fraction(1)}, "kJ", at_most=1e9, example="300")


def over_zero(quantity: Quantity) -> Quantity:
    """The same quantity, but zero is refused."""
    return dataclasses.replace(quantity, at_least=None, above=0.0)


@dataclass(frozen=True, slots=True)
class OrWord(Kind):
    """A quantity, or the word that stands for None: what the profile says elsewhere."""

    quantity: Quantity
    none: str

    def read(self, node: yaml.Node) -> float | None:
        return None if _text(node, self).strip() == self.none else self.quantity.read(node)

    def write(self, value: float | None) -> str:
        return self.none if value is None else self.quantity.write(value)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"const": self.none}, *self.quantity.schema()["anyOf"]]}

    def expected(self) -> str:
        return f"{self.quantity.expected()}, or {self.none!r}"


@dataclass(frozen=True, slots=True)
class Number(Kind):
    """A bare number between two bounds; `whole` for counts."""

    at_least: float | None = None
    at_most: float | None = None
    whole: bool = False

    def read(self, node: yaml.Node) -> float | int:
        text = _digits(node, self).strip()
        if not re.fullmatch(r"[+-]?\d+" if self.whole else _NUMBER, text):
            raise self.refuse(node)
        value = int(text) if self.whole else float(text)
        low = self.at_least is not None and value < self.at_least
        high = self.at_most is not None and value > self.at_most
        if low or high:
            raise self.refuse(node)
        if abs(value) > MOST:
            raise Unfit(f"expected {self.expected()}, and no more than {MOST:g}, got {text!r}", node)
        return value

    def write(self, value: float | int) -> str:
        return repr(value) if self.whole or value != int(value) else str(int(value))

    def schema(self) -> dict[str, Any]:
        made: dict[str, Any] = {"type": "integer" if self.whole else "number"}
        if self.at_least is not None:
            made["minimum"] = self.at_least
        if self.at_most is not None:
            made["maximum"] = self.at_most
        return made

    def expected(self) -> str:
        what = "a whole number" if self.whole else "a number"
        if self.at_least is not None and self.at_most is not None:
            return f"{what} from {self.at_least:g} to {self.at_most:g}"
        if self.at_least is not None:
            return f"{what} of at least {self.at_least:g}"
        return what


@dataclass(frozen=True, slots=True)
class Flag(Kind):
    """true or false."""

    def read(self, node: yaml.Node) -> bool:
        text = _text(node, self).lower()
        if text not in ("true", "yes", "on", "false", "no", "off"):
            raise self.refuse(node)
        return text in ("true", "yes", "on")

    def write(self, value: bool) -> str:
        return "true" if value else "false"

    def schema(self) -> dict[str, Any]:
        return {"type": "boolean"}

    def expected(self) -> str:
        return "true or false"


@dataclass(frozen=True, slots=True)
class Choice(Kind):
    """One of a few words. `none` is the word that stands for None, if any.

    A bare `off` is false to readers of YAML 1.1, such as most of Python's: it may be written so where it is a word.
    """

    words: tuple[str, ...]
    none: str | None = None

    def read(self, node: yaml.Node) -> str | None:
        text = _text(node, self)
        if text == "false" and "off" in self.words:
            text = "off"
        if text not in self.words:
            guess = nearest(text, self.words)
            hint = f": did you mean {guess!r}?" if guess else ""
            raise Unfit(f"{self.refuse(node)}{hint}", node)
        return None if text == self.none else text

    def write(self, value: str | None) -> str:
        return self.none if value is None and self.none is not None else str(value)

    def schema(self) -> dict[str, Any]:
        return {"enum": [*self.words, *([False] if "off" in self.words else [])]}

    def expected(self) -> str:
        return "one of " + ", ".join(self.words)


@dataclass(frozen=True, slots=True)
class Text(Kind):
    """Any text that is not empty; `pattern` says that it must be a regular expression."""

    pattern: bool = False

    def read(self, node: yaml.Node) -> str:
        text = _text(node, self)
        if not text.strip():
            raise self.refuse(node)
        if self.pattern:
            try:
                re.compile(text)
            except re.error as error:
                raise Unfit(f"expected {self.expected()}, got {text!r}: {error}", node) from None
        return text

    def write(self, value: str) -> str:
        # Dumped inside a list, so that it is quoted wherever a comma or brace would need it.
        style = None if value.isprintable() else '"'
        dumped = yaml.safe_dump([value], allow_unicode=True, width=1e9, default_flow_style=True, default_style=style)
        return str(dumped).strip()[1:-1]

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "minLength": 1} | ({"format": "regex"} if self.pattern else {})

    def expected(self) -> str:
        return "a regular expression such as 'mark|scribe'" if self.pattern else "a text"


@dataclass(frozen=True, slots=True)
class PointXY(Kind):
    """A point [x, y] in mm."""

    def read(self, node: yaml.Node) -> tuple[float, float]:
        if not isinstance(node, yaml.SequenceNode) or len(node.value) != 2:
            raise self.refuse(node)
        signed = dataclasses.replace(LENGTH, at_least=None)
        x, y = (signed.read(member) for member in node.value)
        return x, y

    def write(self, value: tuple[float, float]) -> str:
        return f"[{value[0]!r}, {value[1]!r}]"

    def schema(self) -> dict[str, Any]:
        member = dataclasses.replace(LENGTH, at_least=None).schema()
        return {"type": "array", "items": member, "minItems": 2, "maxItems": 2}

    def expected(self) -> str:
        return "a point [x, y] in mm"


@dataclass(frozen=True, slots=True)
class Span(Kind):
    """Two lengths [least, most], the first less than the second; `none` is the word for not known."""

    none: str

    def read(self, node: yaml.Node) -> tuple[float, float] | None:
        if isinstance(node, yaml.ScalarNode) and node.value == self.none:
            return None
        if not isinstance(node, yaml.SequenceNode) or len(node.value) != 2:
            raise self.refuse(node)
        low, high = PointXY().read(node)
        if low >= high:
            raise Unfit(f"expected {self.expected()}, got {low:g} and {high:g}", node)
        return low, high

    def write(self, value: tuple[float, float] | None) -> str:
        return self.none if value is None else PointXY().write(value)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"const": self.none}, PointXY().schema()]}

    def expected(self) -> str:
        return f"[least, most] in mm, the least first, or {self.none!r}"


def _decimal_comma(node: yaml.Node) -> str:
    """A hint where a number was written as in German or Russian."""
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
    comma = re.fullmatch(r"\s*[+-]?\d+,\d+\s*[a-z/0-9]*\s*", text)
    return f": write decimals with a point, {text.replace(',', '.').strip()}" if comma else ""


def _text(node: yaml.Node, kind: Kind) -> str:
    if not isinstance(node, yaml.ScalarNode) or is_empty(node):
        raise kind.refuse(node)
    return str(node.value)


def _digits(node: yaml.Node, kind: Kind) -> str:
    """The text of a number, refused where it is longer than any number is."""
    text = _text(node, kind)
    if len(text) > LONGEST:
        raise Unfit(f"expected {kind.expected()}, got a text of {len(text)} characters", node)
    return text
