"""A material chart as CSV: a head that names the columns and their units, and a row a line.

    material, thickness [mm], kerf [mm], feed [mm/min], pierce_delay [s], gas
    S235, 6, 1.5, 2500, 0.5, O2/air

Cells are divided by commas, semicolons or tabs. Lines that begin with # and empty ones are passed over. A unit stands
at the head of its column, or in each cell.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.plain_values import Number
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems

from .cells import cell, in_unit, node_at
from .chart import ChartRow, Value
from .columns import COLUMNS

_HEAD = re.compile(r"(?P<name>[^\[\]()]*?)\s*(?:[\[(]\s*(?P<unit>[^\[\]()]*?)\s*[\])])?")
_LONGEST_CELL = 200
Head = tuple[str, str | None] | None
Numbered = tuple[int, list[str]]


def csv_rows(text: str, problems: Problems) -> list[ChartRow]:
    """The rows; what is wrong is noted."""
    lines = _lines(text, problems)
    if not lines:
        return []
    (at, names), *rest = lines
    heads = [_head(at, k, name, problems) for k, name in enumerate(names)]
    known = [head[0] for head in heads if head is not None]
    for name in dict.fromkeys(known):
        if known.count(name) > 1:
            problems.add(node_at("", at), f"the column {name} is there twice")
    if problems.found:
        return []
    return [row for line, cells in rest if (row := _row(line, cells, heads, problems)) is not None]


def _lines(text: str, problems: Problems) -> list[Numbered]:
    """The rows of cells that hold something, with their lines."""
    kept = [(k, row) for k, row in enumerate(text.splitlines(), 1) if row.strip() and not row.lstrip().startswith("#")]
    if not kept:
        return []
    divider = max(",;\t", key=kept[0][1].count)
    found = []
    for line, row in kept:
        if row.count('"') % 2:
            raise InputError('a " that nothing closes', file=problems.file, line=line, column=row.rindex('"') + 1)
        try:
            cells = next(csv.reader([row], delimiter=divider, skipinitialspace=True, strict=True))
        except csv.Error as error:
            raise InputError(f"not a row of CSV: {error}", file=problems.file, line=line) from None
        if any(one.strip() for one in cells):
            found.append((line, [one.strip() for one in cells]))
    return found


def _head(line: int, number: int, text: str, problems: Problems) -> Head:
    """The column and unit that a cell of the head names."""
    found = _HEAD.fullmatch(text)
    node = node_at(text, line)
    if found is None or not found["name"]:
        problems.add(node, f"column {number + 1}: expected a name and its unit such as 'kerf [mm]', got {text[:60]!r}")
        return None
    name, unit = re.sub(r"[\s-]+", "_", found["name"].strip().lower()), found["unit"]
    if name not in COLUMNS:
        problems.add(node, unknown("column", name[:60], COLUMNS))
        return None
    units = COLUMNS[name].units
    allowed = units or (("1",) if isinstance(COLUMNS[name].kind, Number) else ())  # plain numbers: shares
    if unit is not None and unit not in allowed:
        expected = f"one of {', '.join(allowed)}" if allowed else "no unit"
        problems.add(node, f"{name}: unknown unit {unit[:60]!r}, expected {expected}")
        return None
    return name, unit if units else None


def _row(line: int, cells: list[str], heads: list[Head], problems: Problems) -> ChartRow | None:
    if len(cells) > len(heads) and any(cells[len(heads) :]):
        text = f"the row has {len(cells)} cells, the head {len(heads)} columns; decimals are written with a point"
        problems.add(node_at("", line), text)
        return None
    values = dict(_values(line, cells, heads, problems))
    name = values.get("name")
    return ChartRow(line, values, (name,) if isinstance(name, str) else ())


def _values(line: int, cells: list[str], heads: list[Head], problems: Problems) -> Iterator[tuple[str, Value]]:
    for text, head in zip(cells, heads, strict=False):
        if head is None or not text:
            continue
        column, unit = head
        try:
            if len(text) > _LONGEST_CELL:
                raise Unfit(f"a text of {len(text)} characters")
            yield column, cell(column, node_at(in_unit(column, text, unit), line))
        except Unfit as error:
            problems.add(node_at(text, line), f"{column}: {error}")
