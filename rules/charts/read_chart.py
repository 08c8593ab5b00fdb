"""A material chart from its file: CSV, YAML, or QtPlasmaC's own material file."""

from __future__ import annotations

import csv
import hashlib
import re
from collections.abc import Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Literal

import yaml

from kerfwise.encoder.bevels.bevel import LEAST_DEG, MOST_DEG
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, read_limited
from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Number, Text, Unfit, noting
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, is_empty, items

from .chart import COLUMNS, Chart, ChartRow, Value, column_of, known_column

ChartUnits = Literal["mm", "inch"]


def shipped_charts() -> dict[str, Path]:
    """Name → file of the charts that come with kerfwise: starting values, each row with its source."""
    folder = Path(str(resources.files(__package__))) / "shipped"
    return {file.stem: file for file in sorted(folder.glob("*.csv"))}


def read_chart(path: str | Path, units: ChartUnits = "mm") -> Chart:
    """Read a chart; `units` are those of QtPlasmaC's files, which do not say theirs.

    Raises InputError if it cannot be read, or has a wrong column, unit or value anywhere: with file and line, all
    mistakes at once.
    """
    file = str(path)
    try:
        data = read_limited(path, MOST_BYTES_OF_YAML)
    except OSError as error:
        raise InputError(f"cannot read the material chart: {error.strerror}", file=file) from None
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read the material chart: no file can have this name ({error})", file=file) from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError("not a material chart: it is not UTF-8 text; save it as UTF-8", file=file, line=line) from None
    problems = Problems(file)
    rows = _rows(text, Path(path), problems, units)
    problems.raise_any()
    if not rows:
        raise InputError("the material chart has no rows", file=file, line=1)
    return Chart(file, hashlib.sha256(data).hexdigest(), tuple(rows))


def _rows(text: str, path: Path, problems: Problems, units: ChartUnits) -> list[ChartRow]:
    match path.suffix.lower():
        case ".csv":
            return csv_rows(text, problems)
        case ".yaml" | ".yml":
            return yaml_rows(text, problems)
        case ".cfg":
            return qtplasmac_rows(text, problems, units)
    raise InputError(
        "a material chart is a .csv, a .yaml, or a .cfg of QtPlasmaC (…_material.cfg): rename it, or give another",
        file=path,
    )


# A material chart as CSV: a head that names the columns and their units, and a row a line.
#
# material, thickness [mm], kerf [mm], feed [mm/min], pierce_delay [s], gas S235, 6, 1.5, 2500, 0.5, O2/air
#
# Cells are divided by commas, semicolons or tabs. Lines that begin with # and empty ones are passed over. A unit
# stands at the head of its column, or in each cell.

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
    written, unit = re.sub(r"[\s-]+", "_", found["name"].strip().lower()), found["unit"]
    name = known_column(written)
    if name is None:
        problems.add(node, _no_column(written))
        return None
    units = column_of(name).units
    allowed = units or (("1",) if isinstance(column_of(name).kind, Number) else ())  # plain numbers: shares
    if unit is not None and unit not in allowed:
        expected = f"one of {', '.join(allowed)}" if allowed else "no unit"
        problems.add(node, f"{name}: unknown unit {unit[:60]!r}, expected {expected}")
        return None
    return name, unit if units else None


def _no_column(name: str) -> str:
    if re.fullmatch(r"kerf_[_\d.,]+", name):
        return f"{name[:60]}: expected the angle of a bevel in degrees, {LEAST_DEG:g} to {MOST_DEG:g}, such as kerf_45"
    return unknown("column", name[:60], COLUMNS)


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
            yield column, cell(column, node_at(text_with_unit(column, text, unit), line))
        except Unfit as error:
            problems.add(node_at(text, line), f"{column}: {error}")


# A material chart as YAML: a list of rows, each a mapping of columns. A bare number has the unit that a profile's
# has.
#
# - {material: S235, thickness: 6 mm, kerf: 1.5 mm, feed: 2500 mm/min, pierce_delay: 0.5 s, gas: O2/air}


def yaml_rows(text: str, problems: Problems) -> list[ChartRow]:
    """The rows; what is wrong is noted."""
    try:
        root = compose(text, problems.file)
    except InputError as error:
        if error.line is None and "nested" in error.message:
            raise InputError("not a material chart: nested too deeply", file=problems.file, line=1) from None
        raise
    rows = []
    for node in items(root, problems, "a material chart") if root is not None else ():
        values: dict[str, Value] = {}
        lines: dict[str, int] = {}
        for written, key, value in entries(node, problems, "row"):
            name = known_column(written)
            if name is None:
                problems.add(key, _no_column(written))
            elif name in values:
                problems.add(key, f"the column {name} is there twice")
            elif not is_empty(value):
                with noting(problems, value, name):
                    values[name] = cell(name, value)
                    lines[name] = value.start_mark.line + 1
        called = values.get("name")
        names = (called,) if isinstance(called, str) else ()
        rows.append(ChartRow(node.start_mark.line + 1, values, names, lines))
    return rows


# QtPlasmaC's own material file (`<machine>_material.cfg`), read as it is.
#
# [MATERIAL_NUMBER_1] NAME = S235 6mm KERF_WIDTH = 1.5 PIERCE_DELAY = 0.5
#
# Its numbers have no units: they are those of the machine, which a profile may say to be inches. Times are in s. What
# is not there QtPlasmaC takes for 0; here it is not known.

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
        values, lines = _qtplasmac_values(body, problems, units)
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


def _qtplasmac_values(body: list[Entry], problems: Problems, units: str) -> tuple[dict[str, Value], dict[str, int]]:
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


# One value of a chart, from its text: in its column's unit, within what a plant may have.


def cell(column: str, node: yaml.Node) -> Value:
    """The value of a node in a column.

    Raises Unfit if it is none, or so far off that another unit must be meant.
    """
    kind = column_of(column).kind
    value = kind.read(node)
    if isinstance(value, str):
        return value.strip()
    assert isinstance(value, float | int)
    return float(value)


def text_with_unit(column: str, text: str, unit: str | None) -> str:
    """The text of a cell with its unit: that of the head of its column, or its own.

    Raises Unfit if it has none, or two.
    """
    kind, units, text = column_of(column).kind, column_of(column).units, text.strip()
    if isinstance(kind, Text) or not units:
        return text
    own = text.lstrip("+-.0123456789eE").strip()
    if "," in own or not any(char.isdigit() for char in text):
        return text  # a decimal comma, or no number at all: the kind says what is expected
    if unit is not None and own and own != unit:
        raise Unfit(f"{text!r} stands in a column of {unit}: give one unit")
    if unit is None and not own and len(units) > 1:
        raise Unfit(f"{text!r} has no unit: write {column} [{units[0]}] at the head, or such as '{text} {units[0]}'")
    return text if own or unit is None else f"{text} {unit}"


def node_at(text: str, line: int) -> yaml.ScalarNode:
    """A text of a line as the kinds of options read it; its column in the file is not known."""
    mark = yaml.Mark("", 0, line - 1, 0, "", 0)
    return yaml.ScalarNode("tag:yaml.org,2002:str", text, mark, mark)


# The same as QtPlasmaC's own material file.


def qtplasmac_text(chart: Chart) -> str:
    """The rows of a chart as a material file of QtPlasmaC, in mm; rows without what it needs are left out.

    Raises InputError if no row has speed, pierce delay, pierce height and cut height.
    """
    needed = {column for column, _ in (_READ[key] for key in _NEEDED)}
    whole = [row for row in chart.rows if needed <= row.values.keys()]
    if not whole:
        columns = ", ".join(sorted(needed))
        raise InputError(f"no row has all that QtPlasmaC asks of a material: {columns}", file=chart.file)
    sections = ["# QtPlasmaC materials, in mm, from " + Path(chart.file).name]
    for number, row in enumerate(whole, 1):
        lines = [f"[MATERIAL_NUMBER_{number}]", f"NAME = {row.label.replace(',', '')}"]
        for key, (column, unit) in _READ.items():
            value = row.values.get(column)
            if column != "name" and isinstance(value, float):
                lines.append(f"{key} = {value * (60 if unit == 'speed' else 1):.6g}")
        sections.append("\n".join(lines))
    return "\n\n".join(sections) + "\n"
