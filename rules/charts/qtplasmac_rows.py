"""QtPlasmaC's own material file (`<machine>_material.cfg`), read as it is.

    [MATERIAL_NUMBER_1]
    NAME = S235 6mm
    KERF_WIDTH = 1.5
    PIERCE_DELAY = 0.5

Its numbers have no units: they are those of the machine, which a profile may say to be inches. Times are in s. What is
not there QtPlasmaC takes for 0; here it is not known.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems

from .cells import cell, node_at
from .chart import ChartRow, Value

_READ: Mapping[str, tuple[str, str]] = {
    "NAME": ("name", ""),
    "KERF_WIDTH": ("kerf", "length"),
    "CUT_SPEED": ("feed", "speed"),
    "PIERCE_DELAY": ("pierce_delay", "s"),
    "PIERCE_HEIGHT": ("pierce_height", "length"),
    "CUT_HEIGHT": ("cut_height", "length"),
    "CUT_AMPS": ("amps", "A"),
    "CUT_VOLTS": ("volts", "V"),
}
_NOT_READ = ("THC", "PUDDLE_JUMP_HEIGHT", "PUDDLE_JUMP_DELAY", "PAUSE_AT_END", "GAS_PRESSURE", "CUT_MODE")
"""What concerns the machine alone."""
_NEEDED = ("PIERCE_HEIGHT", "PIERCE_DELAY", "CUT_HEIGHT", "CUT_SPEED")
"""What QtPlasmaC asks of each material."""
_UNITS = {"mm": {"length": "mm", "speed": "mm/min"}, "inch": {"length": "in", "speed": "in/min"}}
_SECTION = re.compile(r"\[\s*MATERIAL_NUMBER_(\d+)\s*\]\s*(?:#.*)?")
_VERSION = re.compile(r"\[\s*VERSION\b[^\]]*\]")
_LEAST_KERF_MM = 0.3


def qtplasmac_rows(text: str, problems: Problems, units: str) -> list[ChartRow]:
    """The materials, by number and name; what is wrong is noted."""
    rows = []
    seen: dict[str, int] = {}
    for number, line, body in _sections(text, problems):
        if number in seen:
            problems.add(node_at("", line), f"material number {number} is there twice, first in line {seen[number]}")
        seen.setdefault(number, line)
        values, lines = _values(body, problems, units)
        sound = all(key in _READ or key in _NOT_READ for _, key, _ in body)
        for key in _NEEDED if sound else ():
            if _READ[key][0] not in values and not any(name == key for _, name, _ in body):
                problems.add(node_at("", line), f"material number {number} lacks {key}")
        names = tuple(str(values[key]) for key in ("name",) if key in values)
        rows.append(ChartRow(line, values, (*names, number), lines))
    return rows


Entry = tuple[int, str, str]


def _sections(text: str, problems: Problems) -> Iterator[tuple[str, int, list[Entry]]]:
    number, begun, skipping = "", 0, False
    body: list[Entry] = []
    for line, raw in enumerate(text.splitlines(), 1):
        row = raw.strip()
        if not row or row.startswith(("#", ";")) or _VERSION.fullmatch(row):
            continue
        if found := _SECTION.fullmatch(row):
            if number:
                yield number, begun, body
            number, begun, body, skipping = str(int(found[1][:9])), line, [], False
        elif row.startswith("["):
            problems.add(node_at("", line), f"expected a section such as [MATERIAL_NUMBER_1], got {row[:60]!r}")
            skipping = True
        elif "=" not in row:
            problems.add(node_at("", line), f"expected a key and its value such as CUT_SPEED = 2500, got {row[:60]!r}")
        elif number and not skipping:
            key, _, value = row.partition("=")
            body.append((line, key.strip(), value.partition("#")[0].strip()))
        elif not skipping:
            problems.add(node_at("", line), f"{row[:60]!r} stands before the first section, [MATERIAL_NUMBER_1]")
    if number:
        yield number, begun, body


def _values(body: list[Entry], problems: Problems, units: str) -> tuple[dict[str, Value], dict[str, int]]:
    values: dict[str, Value] = {}
    lines: dict[str, int] = {}
    for line, key, text in body:
        if key in _NOT_READ:
            continue
        if key not in _READ:
            problems.add(node_at("", line), unknown("key", key[:60], (*_READ, *_NOT_READ)))
            continue
        column, unit = _READ[key]
        if column in lines:
            problems.add(node_at("", line), f"{key} is given twice, first in line {lines[column]}")
            continue
        lines[column] = line
        if not text or (column != "name" and _is_nothing(text) and column != "pierce_delay"):
            continue
        try:
            value = cell(column, node_at(f"{text} {_UNITS[units].get(unit, unit)}".strip(), line))
            if column == "kerf" and units == "mm" and isinstance(value, float) and value < _LEAST_KERF_MM:
                raise Unfit(
                    f"{text} is less than the {_LEAST_KERF_MM:g} mm that plasma burns away: if the file is in "
                    "inches, say material.chart_units: inch in the profile"
                )
            values[column] = value
        except Unfit as error:
            problems.add(node_at("", line), f"{key}: {error}")
    return values, lines


def _is_nothing(text: str) -> bool:
    """Whether it is 0, which stands for a value that nobody has given."""
    return re.fullmatch(r"[+-]?0+\.?0*", text) is not None
