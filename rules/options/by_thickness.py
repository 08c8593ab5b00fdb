"""Lengths that go with the thickness of the sheet: one number, so many thicknesses, or a small table."""

from __future__ import annotations

import re
from bisect import bisect_left
from dataclasses import dataclass
from typing import Any

import yaml

from .kind import Unfit
from .quantities import LENGTH, Quantity, over_zero

_THICKNESS = over_zero(LENGTH)
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
        return Quantity.read(self, node) if found is None else Thicknesses(float(found[1]))

    def _table(self, node: yaml.MappingNode) -> ThicknessTable:
        if not node.value:
            raise self.refuse(node)
        rows = sorted((_THICKNESS.read(key), Quantity.read(self, value)) for key, value in node.value)
        if len({thickness for thickness, _ in rows}) < len(rows):
            raise Unfit("the same thickness is given twice", node)
        return ThicknessTable(tuple(rows))

    def write(self, value: Any) -> str:
        match value:
            case Thicknesses():
                return f"{value.count:.12g} × thickness"
            case ThicknessTable():
                rows = (f"{_THICKNESS.write(t)}: {Quantity.write(self, length)}" for t, length in value.rows)
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
