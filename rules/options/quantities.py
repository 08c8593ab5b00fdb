"""Quantities: bare numbers in the unit of the kind, or text with a unit of its own: `1.5`, `"1.5 mm"`, `0.1 m/s`."""

from __future__ import annotations

import dataclasses
import re
from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import yaml

from kerfwise.encoder.nearest_name import nearest

from .kind import NUMBER, Choice, Number, OptionKind, Unfit, digits, scalar_text

SPELT_ELSEWHERE = {
    "ipm": "in/min", "inch/min": "in/min", "mpm": "m/min", "mmpm": "mm/min", "mm/m": "mm/min", "mm/sec": "mm/s",
    "inch": "in", "inches": "in", "millimetre": "mm", "millimeter": "mm", "sec": "s", "secs": "s", "seconds": "s",
    "msec": "ms", "millis": "ms", "minutes": "min", "mins": "min",
}  # fmt: skip
"""Units as charts and controls spell them, and the name that they have here."""


@dataclass(frozen=True, slots=True)
class Quantity(OptionKind):
    """A number with a unit: `units` are their sizes in the program's own, `bare` is that of a bare number.

    Every quantity has an end, `at_most`, far beyond what any plant has: sums of costs then fit the engines' integers.
    `likely` are the least and the most that plants have, where that is known: beyond it another unit must be meant.
    """

    name: str
    units: Mapping[str, Fraction]
    bare: str
    at_most: float
    at_least: float | None = 0.0
    above: float | None = None
    example: str = "1.5"
    likely: tuple[float, float] | None = None

    def read(self, node: yaml.Node) -> float:
        found = re.fullmatch(rf"\s*({NUMBER})\s*((?:[A-Za-z/%°][A-Za-z0-9/%]*)?)\s*", digits(node, self))
        if found is None:
            raise self.refuse(node)
        number, unit = found[1], found[2] or self.bare
        if unit not in self.units:
            meant = SPELT_ELSEWHERE.get(unit.lower())
            hint = f": did you mean {meant}?" if meant in self.units else f": expected {self.expected()}"
            raise Unfit(f"unknown unit {unit!r} in {found[0]!r}{hint}", node)
        value = float(Fraction(number) * self.units[unit])
        if (self.at_least is not None and value < self.at_least) or (self.above is not None and value <= self.above):
            raise self.refuse(node)
        if self.likely is not None and not self.likely[0] <= value <= self.likely[1]:
            raise Unfit(self._unlikely(value, number, unit), node)
        if abs(value) > self.at_most:
            most = f"{self._most():g} {self.bare}"
            raise Unfit(f"expected {self.expected()}, and no more than {most}, got {found[0].strip()!r}", node)
        return value

    def _unlikely(self, value: float, number: str, unit: str) -> str:
        """That a value is too small or too large for any plant, with the units in which its number is not."""
        assert self.likely is not None
        low, high = self.likely
        fits = [u for u, size in self.units.items() if low <= float(Fraction(number) * size) <= high]
        meant = [f"{number} {', '.join(fits[:-1])}{' or ' if fits[1:] else ''}{fits[-1]}"] if fits else []
        thousand = float(Fraction(number) * 1000 * self.units[unit])
        if re.fullmatch(r"\d{1,3}\.\d{3}", number) and low <= thousand <= high:
            meant.insert(0, f"{number.replace('.', '')} {unit}")
        hint = f": did you mean {', or '.join(meant)}?" if meant else ""
        return f"{self._short(value)} is not likely, expected {self._short(low)} to {self._short(high)}{hint}"

    def _short(self, value: float) -> str:
        number, _, unit = self.write(value).partition(" ")
        return f"{float(number):.6g} {unit}"

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
        if self.likely is not None:
            low, high = (float(f"{float(Fraction(end) / self.units[self.bare]):.12g}") for end in self.likely)
            number = {"type": "number", "minimum": low, "maximum": high}
        pattern = rf"^\s*{NUMBER}\s*({'|'.join(self.units)})?\s*$"
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
WEIGHT = dataclasses.replace(LENGTH, at_most=1e5)
"""What breaking a soft rule once costs: at most a tenth of what an excuse from a hard rule weighs."""
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
SHARE_OF_POWER = Quantity(
    "a share of full power",
    {"%": Fraction(1)},
    "%",
    at_most=100.0,
    at_least=None,
    above=0.0,
    example="80",
)
AMPS = Quantity("a current", {"A": Fraction(1)}, "A", at_most=2000.0, at_least=None, above=0.0, example="45")
VOLTS = Quantity("a voltage", {"V": Fraction(1)}, "V", at_most=1000.0, at_least=None, above=0.0, example="120")
FLOW = Quantity("a flow", {"m3/h": Fraction(1), "l/min": Fraction(60, 1000)}, "m3/h", at_most=1e4, example="2.5")
MASS = Quantity("a mass", {"kg": Fraction(1)}, "kg", at_most=1e6, example="5")
ENERGY = Quantity("an energy", {"kJ": Fraction(1)}, "kJ", at_most=1e9, example="300")


def positive(quantity: Quantity) -> Quantity:
    """The same quantity, but zero is refused."""
    return dataclasses.replace(quantity, at_least=None, above=0.0)


def likely(quantity: Quantity, least: float, most: float) -> Quantity:
    """The same quantity, between the least and the most that plants have, in the program's own unit."""
    return dataclasses.replace(quantity, likely=(least, most))


# What the settings of plants are like, in profiles and charts alike. Beyond it a number is in another unit.

LEAD = likely(LENGTH, 0.0, 500.0)
THICKNESS = likely(positive(LENGTH), 0.05, 500.0)
KERF = likely(LENGTH, 0.01, 20.0)
CUT_FEED = likely(SPEED, 0.05, 2000.0)
MARK_FEED = likely(SPEED, 0.05, 5000.0)
PIERCE_TIME = likely(DURATION, 0.0, 120.0)
TORCH_HEIGHT = likely(LENGTH, 0.0, 100.0)


@dataclass(frozen=True, slots=True)
class OrWord(OptionKind):
    """A quantity, a number, or the word that stands for None: said elsewhere, or worked out."""

    quantity: Quantity | Number
    none: str

    def read(self, node: yaml.Node) -> float | None:
        text = scalar_text(node, self).strip()
        if text == self.none:
            return None
        try:
            return self.quantity.read(node)
        except Unfit as error:
            hint = f": did you mean {self.none!r}?" if nearest(text, [self.none]) else ""
            message = str(error).replace(self.quantity.expected(), self.expected())
            raise Unfit(f"{message}{hint}", error.node) from None

    def write(self, value: float | None) -> str:
        return self.none if value is None else self.quantity.write(value)

    def schema(self) -> dict[str, Any]:
        other = self.quantity.schema()
        return {"anyOf": [{"const": self.none}, *other.get("anyOf", [other])]}

    def expected(self) -> str:
        return f"{self.quantity.expected()}, or the word {self.none!r}"


@dataclass(frozen=True, slots=True)
class PointXY(OptionKind):
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
class PointOrOff(OptionKind):
    """A point [x, y] in mm, or the word `off`, which may be read as false (see `Choice`)."""

    def read(self, node: yaml.Node) -> tuple[float, float] | str:
        if isinstance(node, yaml.ScalarNode) and node.value in ("off", "false"):
            return "off"
        if not isinstance(node, yaml.SequenceNode):
            raise self.refuse(node)
        return PointXY().read(node)

    def write(self, value: tuple[float, float] | str) -> str:
        return value if isinstance(value, str) else PointXY().write(value)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [Choice(("off",)).schema(), PointXY().schema()]}

    def expected(self) -> str:
        return f"{PointXY().expected()}, or the word 'off'"


@dataclass(frozen=True, slots=True)
class LengthSpan(OptionKind):
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


# Lengths that go with the thickness of the sheet: one number, so many thicknesses, or a small table.

MOST_THICKNESSES = 100.0
_NUMBER = r"(?:\d+\.?\d*|\.\d+)"
_PATTERN = rf"\s*({_NUMBER})\s*(?:[×x*]\s*)?(?:thickness|thicknesses)\s*"


@dataclass(frozen=True, slots=True)
class Thicknesses:
    """A length of so many thicknesses of the sheet.

    Examples
    --------
    >>> Thicknesses(1.5).at(6.0)
    9.0
    """

    count: float

    def at(self, thickness_mm: float) -> float:
        """The length for this thickness."""
        return self.count * thickness_mm


@dataclass(frozen=True, slots=True)
class ThicknessTable:
    """A length by thickness: straight between two rows (thickness, length), mm, and that of the end row beyond.

    Examples
    --------
    >>> lead_in = ThicknessTable(((6.0, 6.0), (12.0, 10.0)))
    >>> lead_in.at(3.0), lead_in.at(9.0), lead_in.at(40.0)
    (6.0, 8.0, 10.0)
    """

    rows: tuple[tuple[float, float], ...]

    def at(self, thickness_mm: float) -> float:
        """The length for this thickness."""
        k = bisect_left(self.rows, (thickness_mm, float("-inf")))
        if k == 0:
            return self.rows[0][1]
        if k == len(self.rows):
            return self.rows[-1][1]
        if self.rows[k][0] == thickness_mm:
            return self.rows[k][1]
        (a, low), (b, high) = self.rows[k - 1], self.rows[k]
        return low + (high - low) * (thickness_mm - a) / (b - a)


ByThickness = float | Thicknesses | ThicknessTable


def length_at(length: ByThickness, thickness_mm: float) -> float:
    """The length for this thickness, whichever way it is given.

    Examples
    --------
    >>> length_at(4.0, 6.0), length_at(Thicknesses(0.5), 6.0)
    (4.0, 3.0)
    """
    return length.at(thickness_mm) if isinstance(length, Thicknesses | ThicknessTable) else length


@dataclass(frozen=True, slots=True)
class LengthByThickness(Quantity):
    """A length such as `6 mm` or `1.5 × thickness`, or a table such as `{6 mm: 6 mm, 12 mm: 10 mm}`."""

    def read(self, node: yaml.Node) -> Any:
        if isinstance(node, yaml.MappingNode):
            return self._table(node)
        found = re.fullmatch(_PATTERN, node.value) if isinstance(node, yaml.ScalarNode) else None
        if found is None:
            return Quantity.read(self, node)
        if (count := float(found[1])) > MOST_THICKNESSES:
            text = f"{count:g} × thickness is not likely, expected {MOST_THICKNESSES:g} × thickness at most"
            raise Unfit(text, node)
        return Thicknesses(count)

    def _table(self, node: yaml.MappingNode) -> ThicknessTable:
        if not node.value:
            raise self.refuse(node)
        rows = sorted((THICKNESS.read(key), Quantity.read(self, value)) for key, value in node.value)
        if len({thickness for thickness, _ in rows}) < len(rows):
            raise Unfit("the same thickness is given twice", node)
        return ThicknessTable(tuple(rows))

    def write(self, value: Any) -> str:
        match value:
            case Thicknesses():
                return f"{value.count:.12g} × thickness"
            case ThicknessTable():
                rows = (f"{THICKNESS.write(t)}: {Quantity.write(self, length)}" for t, length in value.rows)
                return "{" + ", ".join(rows) + "}"
        return Quantity.write(self, value)

    def schema(self) -> dict[str, Any]:
        length = Quantity.schema(self)
        table = {"type": "object", "minProperties": 1, "additionalProperties": length}
        return {"anyOf": [*length["anyOf"], {"type": "string", "pattern": f"^{_PATTERN}$"}, table]}

    def expected(self) -> str:
        also = "'1.5 × thickness', or a table by thickness such as {6 mm: 6 mm, 12 mm: 10 mm}"
        return f"{Quantity.expected(self)}, {also}"


LENGTH_BY_THICKNESS = LengthByThickness(LENGTH.name, LENGTH.units, LENGTH.bare, LENGTH.at_most)
