"""Lengths that go with the thickness of the sheet: one number, or a small table."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from typing import Any

import yaml

from .kind import Unfit
from .quantities import LENGTH, Quantity, over_zero

_THICKNESS = over_zero(LENGTH)


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


LengthOf = float | ThicknessTable


def length_at(length: LengthOf, thickness_mm: float) -> float:
    """The length for this thickness, whichever way it is given."""
    return length.at(thickness_mm) if isinstance(length, ThicknessTable) else length


@dataclass(frozen=True, slots=True)
class LengthOrTable(Quantity):
    """A length such as `6 mm`, or one for each of some thicknesses such as `{6 mm: 6 mm, 12 mm: 10 mm}`."""

    def read(self, node: yaml.Node) -> Any:
        if not isinstance(node, yaml.MappingNode):
            return Quantity.read(self, node)
        if not node.value:
            raise self.refuse(node)
        rows = sorted((_THICKNESS.read(key), Quantity.read(self, value)) for key, value in node.value)
        if len({thickness for thickness, _ in rows}) < len(rows):
            raise Unfit("the same thickness is given twice", node)
        return ThicknessTable(tuple(rows))

    def write(self, value: Any) -> str:
        if not isinstance(value, ThicknessTable):
            return Quantity.write(self, value)
        return "{" + ", ".join(f"{_THICKNESS.write(t)}: {Quantity.write(self, v)}" for t, v in value.rows) + "}"

    def schema(self) -> dict[str, Any]:
        length = Quantity.schema(self)
        table = {"type": "object", "minProperties": 1, "additionalProperties": length}
        return {"anyOf": [*length["anyOf"], table]}

    def expected(self) -> str:
        return f"{Quantity.expected(self)}, or a table by thickness such as {{6 mm: 6 mm, 12 mm: 10 mm}}"


LENGTH_OR_TABLE = LengthOrTable(LENGTH.name, LENGTH.units, LENGTH.bare, LENGTH.at_most)
