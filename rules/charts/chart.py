"""A material chart as it was read: rows of values, each with the line of the file that it stands in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .columns import COLUMNS

Value = float | str


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
