"""A material chart as it was read: rows of values, each with the line of the file that it stands in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from .columns import COLUMNS

Value = float | str
SAME_MM = 1e-6


@dataclass(frozen=True, slots=True)
class ChartRow:
    """One row: the line it begins in, what it is called by, and its values by column, in the profile's own units.

    `names` are its own name and, in QtPlasmaC's files, its number; `lines` are the lines of values that have their own.
    """

    line: int
    values: Mapping[str, Value]
    names: tuple[str, ...] = ()
    lines: Mapping[str, int] | None = None

    def line_of(self, column: str) -> int:
        """The line that a value stands in."""
        return (self.lines or {}).get(column, self.line)

    @property
    def label(self) -> str:
        """What the row is called in messages."""
        told = [written(column, self.values[column]) for column in ("material", "thickness") if column in self.values]
        return self.names[0] if self.names else ", ".join(told) or f"line {self.line}"


@dataclass(frozen=True, slots=True)
class Chart:
    """A chart: its file, the sha256 of its bytes, and its rows in the order of the file."""

    file: str
    sha256: str
    rows: tuple[ChartRow, ...]


def same(one: Value | None, other: Value | None, rel_tol: float = 1e-9, abs_tol: float = SAME_MM) -> bool:
    """Whether two values are equal, but for capitals and rounding; what is not there equals nothing.

    Examples
    --------
    >>> same("O2", "o2 "), same(6.0, 6.0000001), same(6.0, 6.1), same(None, 6.0)
    (True, True, False, False)
    """
    if isinstance(one, str) or isinstance(other, str):
        return str(one).strip().casefold() == str(other).strip().casefold()
    return one is not None and other is not None and math.isclose(one, other, rel_tol=rel_tol, abs_tol=abs_tol)


def written(column: str, value: Value) -> str:
    """A value as a person reads it.

    Examples
    --------
    >>> written("feed", 2500 / 60), written("gas", "O2"), written("thickness", 6.0)
    ('2500 mm/min', 'O2', '6 mm')
    """
    return str(value) if isinstance(value, str) else _short(COLUMNS[column].kind.write(value))


def _short(text: str) -> str:
    number, _, unit = text.partition(" ")
    return f"{float(number):.6g} {unit}".strip()
