"""Lists of parts and of sheets, as YAML, JSON, CSV or XLSX: what a row may say, and how it is read."""

from __future__ import annotations

import datetime
import json
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, read_named, utf8_text
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.jobs.nest_job.job import Day, value_schema
from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Text
from kerfwise.rules.options.option import options_of, setting
from kerfwise.rules.options.quantities import LENGTH, positive
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, items
from kerfwise.rules.profile.load import read_fields

from .placement.demand import GRAINS, QUARTERS, Grain
from .tables import (
    Table,
    WrongCell,
    day_in,
    grain_in,
    is_table,
    length_in,
    number_in,
    rank_in,
    read_tables,
    size_in,
    turns_in,
    whole_in,
    yes_in,
)

PARTS, SHEETS = "parts", "sheets"


@dataclass(frozen=True, slots=True)
class BadRow:
    """Something of a list that cannot be nested: what it is called, where it stands, and why."""

    name: str
    place: Place | None
    why: str

    def __str__(self) -> str:
        at = f"{self.place}: " if self.place else ""
        return f"{at}{self.name}: {self.why}" if self.name else f"{at}{self.why}"


@dataclass(frozen=True, slots=True)
class PartList:
    """What a list says: parts, sheets if it names any, the rows of a table that cannot be used, columns not read.

    `left_out` is as a table counts it.
    """

    parts: tuple[PartRow, ...]
    sheets: tuple[SheetRow, ...] = ()
    bad: tuple[BadRow, ...] = ()
    unread: tuple[str, ...] = ()
    left_out: tuple[int, int] = (0, 0)


def is_list(path: Path, head: bytes) -> bool:
    """Whether a file is a list of parts: a table, YAML, or JSON that is no nest."""
    return (
        is_table(path)
        or path.suffix.lower() in (".yaml", ".yml")
        or (path.suffix.lower() == ".json" and b"kerfwise-nest/" not in head)
    )


def read_list(path: Path, skip_bad: bool = False) -> PartList:
    """Read a list of parts; with `skip_bad` rows of a table that are wrong are left out, and named in `bad`.

    Raises InputError if it cannot be read, or is wrong anywhere, with line and column: all mistakes at once.
    """
    if is_table(path):
        return _list_of_tables(path, skip_bad)
    data = read_named(path, "the list of parts", MOST_BYTES_OF_YAML)
    return list_of(utf8_text(data, "a list of parts", path), str(path))


def list_of(text: str, file: str) -> PartList:
    """The list that a text holds.

    Examples
    --------
    >>> found = list_of("parts: [{part: a.dxf, quantity: 3}]", "day.yaml")
    >>> found.parts[0].quantity, str(found.parts[0].place)
    (3, 'day.yaml:1:9')
    """
    problems, root = Problems(file), compose(text, file)
    found: dict[str, yaml.Node] = {}
    for key, key_node, value in entries(root, problems, "list of parts") if root is not None else ():
        if key in (PARTS, SHEETS):
            found[key] = value
        else:
            problems.add(key_node, unknown("key", key, (PARTS, SHEETS)))
    rows = {key: items(found[key], problems, key) if key in found else [] for key in (PARTS, SHEETS)}
    parts = [_part(node, k, problems) for k, node in enumerate(rows[PARTS], 1)]
    sheets = [_sheet(node, k, problems) for k, node in enumerate(rows[SHEETS], 1)]
    problems.raise_any()
    if not parts:
        raise InputError("names no parts: expected parts: [{part: FILE, quantity: N}, …]", file=file)
    return PartList(tuple(parts), tuple(sheets))


def _part(node: yaml.Node, number: int, problems: Problems) -> PartRow:
    what, so_far = f"{PARTS}[{number}]", len(problems.found)
    row = read_fields(entries(node, problems, what), PartRow(), problems, what)
    if not row.part and len(problems.found) == so_far:
        problems.add(node, f"{what}: names no file: expected part: FILE")
    return replace(row, place=problems.place(node))


def _sheet(node: yaml.Node, number: int, problems: Problems) -> SheetRow:
    what, so_far = f"{SHEETS}[{number}]", len(problems.found)
    row = read_fields(entries(node, problems, what), SheetRow(), problems, what)
    if bool(row.size) == bool(row.file) and len(problems.found) == so_far:
        problems.add(node, f"{what}: expected either size: 3000x1500 or file: FILE")
    return replace(row, place=problems.place(node))


# Tables: each row a part, or a sheet of the stock; every cell that is wrong with its line and column.

_PART_CELLS: Mapping[str, Callable[[Any, float], Any]] = {
    "part": lambda cell, mm: _text(cell),
    "quantity": lambda cell, mm: whole_in(cell, MOST),
    "material": lambda cell, mm: _text(cell),
    "thickness": length_in,
    "order": lambda cell, mm: _text(cell),
    "due": lambda cell, mm: day_in(cell),
    "priority": lambda cell, mm: rank_in(cell),
    "grain": lambda cell, mm: grain_in(cell),
    "rotations": lambda cell, mm: ANY if (turns := turns_in(cell)) == "any" else turns,
    "mirror": lambda cell, mm: yes_in(cell),
}
_STOCK_CELLS: Mapping[str, Callable[[Any, float], Any]] = {
    "size": lambda cell, mm: "{:g}x{:g}".format(*size_in(cell, mm)),
    "width": length_in,
    "length": length_in,
    "part": lambda cell, mm: _text(cell),
    "quantity": lambda cell, mm: None if number_in(str(cell)) == 0 else whole_in(cell, MOST),
    "stock": lambda cell, mm: None if number_in(str(cell)) == 0 else whole_in(cell, MOST),
    "price": lambda cell, mm: _price(cell),
    "remnant": lambda cell, mm: yes_in(cell),
    "material": lambda cell, mm: _text(cell),
    "thickness": length_in,
}
_FIELD = {"thickness": "thickness_mm"}


def _list_of_tables(path: Path, skip_bad: bool) -> PartList:
    problems = Problems(str(path))
    parts: list[PartRow] = []
    sheets: list[SheetRow] = []
    bad: list[BadRow] = []
    unread: list[str] = []
    tables = read_tables(path)
    for table in tables:
        unread += table.head.unread
        cells = _STOCK_CELLS if table.of_stock else _PART_CELLS
        for line, row in table.rows:
            values, wrong = _cells(table, row, cells)
            place = Place(str(path), line, min(table.head.columns) + 1)
            name = str(values.get("part", ""))
            tab = f"tab {table.sheet}: " if table.sheet else ""
            if not wrong:
                try:
                    if table.of_stock:
                        sheets += _sheet_of(values, place)
                    else:
                        parts.append(_part_of(values, place))
                    continue
                except WrongCell as error:
                    wrong = [(place.column, str(error))]
            bad.append(BadRow(name, replace(place, column=wrong[0][0]), tab + "; ".join(text for _, text in wrong)))
            problems.found += [(line, column, tab + text) for column, text in wrong]
    if not skip_bad:
        problems.raise_any()
    if not (parts or sheets or bad):
        raise InputError("has a head and no rows", file=path)
    comments, hidden = (sum(table.left_out[k] for table in tables) for k in (0, 1))
    return PartList(tuple(parts), tuple(sheets), tuple(bad), tuple(unread), (comments, hidden))


def _cells(
    table: Table, row: tuple[Any, ...], kinds: Mapping[str, Callable[[Any, float], Any]]
) -> tuple[dict[str, Any], list[tuple[int, str]]]:
    """What a row says by column, and its mistakes as (column, text); empty cells say nothing."""
    values: dict[str, Any] = {}
    wrong = []
    for at, column in table.head.columns.items():
        cell = row[at] if at < len(row) else None
        dash = isinstance(cell, str) and cell.strip() in ("-", "–")
        if column == "quantity" and dash and kinds is _PART_CELLS:
            wrong.append((at + 1, f"{column}: {cell!r} may be none or one: write how many, or take the row out"))
        if column not in kinds or cell is None or dash or (isinstance(cell, str) and not cell.strip()):
            continue
        try:
            values[column] = kinds[column](cell, table.head.mm.get(at, 1.0))
        except WrongCell as error:
            wrong.append((at + 1, f"{column}: {error}"))
    if over := [cell for cell in row[table.head.wide :] if cell not in (None, "")]:
        says = f"the row has {len(row)} cells, the head {table.head.wide}: {str(over[0])[:20]!r} stands under no column"
        wrong.append((table.head.wide + 1, says + "; write numbers with a decimal comma in quotes, or divide by ;"))
    return values, wrong


def _part_of(values: Mapping[str, Any], place: Place) -> PartRow:
    if not values.get("part"):
        raise WrongCell("names no file of a part")
    return PartRow(**{_FIELD.get(key, key): value for key, value in values.items()}, place=place)


def _sheet_of(values: Mapping[str, Any], place: Place) -> list[SheetRow]:
    """The sheet of a row of stock; none where none is left."""
    file = str(values.get("part", ""))
    size = values.get("size") or (
        "{width:g}x{length:g}".format(**values) if {"width", "length"} <= values.keys() else ""
    )
    if not size and not file.lower().endswith(SUFFIXES):
        raise WrongCell("expected a size such as 3000x1500, width and length, or a file of a sheet")
    count = values.get("stock", values.get("quantity", 0))
    if count is None:
        return []
    kept = {_FIELD.get(k, k): v for k, v in values.items() if k in ("price", "remnant", "material", "thickness")}
    return [SheetRow(size=size, file="" if size else file, stock=count or None, place=place, **kept)]


def _text(cell: Any) -> str:
    """A cell as text; 4711.0, as workbooks have numbers, is 4711."""
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell).strip()


def _price(cell: Any) -> float:
    text = str(cell).strip().strip("€$£ ").removesuffix("EUR").removesuffix("USD").removesuffix("zł").strip()
    if (value := number_in(text)) < 0:
        raise WrongCell(f"expected a price of 0 or more, got {text!r}")
    return value


_DEGREES = Number(0, 360)
LEAST_STEP_DEG = 1
ANY: tuple[float, ...] = ()
"""How `any` is kept."""


@dataclass(frozen=True, slots=True)
class Turns(OptionKind):
    """A list of degrees, counter-clockwise; a step such as 45 for every 45°; `none`, as it is drawn; or `any` turn."""

    def read(self, node: yaml.Node) -> tuple[float, ...]:
        if isinstance(node, yaml.SequenceNode) and node.value:
            return tuple(dict.fromkeys(float(_DEGREES.read(one)) % 360 for one in node.value))
        if isinstance(node, yaml.ScalarNode) and node.value == "none":
            return (0.0,)
        if isinstance(node, yaml.ScalarNode) and node.value == "any":
            return ANY
        if not isinstance(node, yaml.ScalarNode):
            raise self.refuse(node)
        step = float(Number(LEAST_STEP_DEG, 360).read(node))
        if 360 % step:
            raise self.refuse(node)
        return tuple(k * step for k in range(int(360 / step)))

    def write(self, value: Any) -> str:
        return "any" if value == ANY else f"[{', '.join(f'{turn:g}' for turn in value)}]"

    def schema(self) -> dict[str, Any]:
        degrees = {"type": "number", "minimum": 0, "maximum": 360}
        step = {"type": "number", "minimum": LEAST_STEP_DEG, "maximum": 360}
        return {"anyOf": [{"enum": ["none", "any"]}, step, {"type": "array", "items": degrees, "minItems": 1}]}

    def expected(self) -> str:
        return "degrees such as [0, 180], a step that 360 is a multiple of such as 45, none, or any"


# The rows of a list of parts, and of the command line: what they may say.

MOST = 100_000


@dataclass(frozen=True, slots=True)
class PartRow:
    """A file of parts, and how often each part in it is wanted."""

    part: str = setting("", Text(), "file of the part: DXF, SVG or JSON, from the list's folder")
    quantity: int | None = setting(
        None, Number(1, MOST, whole=True), "how many are wanted, else what its drawing says, or 1"
    )
    priority: int = setting(1, Number(1, 50, whole=True), "parts of lower numbers are placed first")
    order: str = setting("", Text(), "the order that it is for")
    rotations: tuple[float, ...] = setting(QUARTERS, Turns(), "how it may be turned")
    grain: Grain | None = setting(
        None, Choice(("none", *GRAINS), none="none"), "how its x axis lies to the sheet's, because of grain"
    )
    mirror: bool = setting(False, Flag(), "whether it may be turned over")
    material: str = setting("", Text(), "grade of its sheet, where the list is for several")
    thickness_mm: float | None = setting(
        None, positive(LENGTH), "thickness of its sheet, where the list is for several"
    )
    due: datetime.date | None = setting(None, Day(), "day on which it has to be ready")
    place: Place | None = None


@dataclass(frozen=True, slots=True)
class SheetRow:
    """A sheet by its size, or by a file, and how many there are."""

    size: str = setting("", Text(), "width x height in mm, such as 3000x1500")
    file: str = setting("", Text(), "file of the sheet, from the list's folder")
    stock: int | None = setting(None, Number(1, MOST, whole=True), "how many there are")
    price: float | None = setting(None, Number(0), "price of one")
    remnant: bool = setting(False, Flag(), "whether it is a remnant, which is used first")
    material: str = setting("", Text(), "its grade; parts of another are not laid on it")
    thickness_mm: float | None = setting(None, positive(LENGTH), "its thickness; parts of another are not laid on it")
    place: Place | None = None


# The JSON Schema of a list of parts: `python -m kerfwise.apps.nesting.part_list > apps/nesting/parts.schema.json`.

Json = dict[str, Any]


def list_schema() -> Json:
    """The schema, made from the declarations that lists are read with."""
    sheet = _row(SheetRow) | {"oneOf": [{"required": ["size"]}, {"required": ["file"]}]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kerfwise list of parts",
        "description": "Parts with quantities, and what there is to cut them from.",
        "type": "object",
        "additionalProperties": False,
        "required": ["parts"],
        "properties": {
            "parts": {
                "description": "files of parts, and how often each is wanted",
                "type": "array",
                "items": _row(PartRow) | {"required": ["part"]},
                "minItems": 1,
            },
            "sheets": {
                "description": "sheets and remnants; they may be named on the command line, too",
                "type": "array",
                "items": sheet,
            },
        },
    }


def _row(kind: type) -> Json:
    keys = {o.key: {"description": o.help, **value_schema(o.kind)} for o in options_of(kind)}
    return {"type": "object", "properties": keys, "additionalProperties": False}


def schema_text() -> str:
    """The schema as the text of its file."""
    return json.dumps(list_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())
