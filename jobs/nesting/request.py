"""What is to be nested: lists of parts, sheets and the command line's rows, read as one request."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.contour_checks import sheet_ring_problems
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_limited
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.questions import Questions, QuestionsOfFiles, with_answers
from kerfwise.encoder.readers.drawing import Drawing
from kerfwise.encoder.readers.join import join
from kerfwise.encoder.readers.json_nest import sheet_in_json
from kerfwise.encoder.readers.layers import Layers
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.readers.read import SUFFIXES, file_bytes, read_nest
from kerfwise.encoder.readers.sheet import NO_SHEET, drawn_sheet
from kerfwise.encoder.text import unknown
from kerfwise.jobs.inputs import Tell, silent
from kerfwise.jobs.nest_job import job_beside, read_job
from kerfwise.nesting.blocks import sides_on_axes
from kerfwise.nesting.demand import GRAINS, QUARTERS, Demand, Grain, PartType, Stock, turns_along
from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Text
from kerfwise.rules.options.option import option, options_of
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, items
from kerfwise.rules.profile.load import read_fields

# What was asked for, from files: the command line's parts, lists and sheets as one order.


def order_of(
    parts: Sequence[str],
    sheets: Sequence[str],
    remnants: Sequence[str],
    reading: ReadOptions,
    tell: Tell = silent,
) -> Demand:
    """Read everything that the command line names.

    Parameters
    ----------
    parts
        Files of parts, each with its quantity behind it (`bracket.dxf=12`), and lists of parts.
    sheets
        Sizes such as `3000x1500`, or files, each with how many there are behind it (`3000x1500=4`).
    remnants
        The same, of remnants.
    reading
        How drawings are read.
    tell
        Told what the readers had to say.

    Raises
    ------
    InputError
        For the first thing that cannot be read or used.
    """
    rows: list[tuple[PartRow, Path]] = []
    stock: list[tuple[SheetRow, Path]] = []
    for text in parts:
        for listed, folder in _lists(text):
            rows += ((row, folder) for row in listed.parts)
            stock += ((row, folder) for row in listed.sheets)
    stock += ((_sheet_row(text, remnant=False), Path()) for text in sheets)
    stock += ((_sheet_row(text, remnant=True), Path()) for text in remnants)
    found: list[PartType] = []
    asked: list[Questions] = []
    for row, folder in rows:
        try:
            found += _types(row, folder, reading, tell)
        except Questions as questions:
            asked.append(questions)
    if asked:
        raise QuestionsOfFiles(asked)
    types = _named(found)
    if not stock:
        raise InputError(
            "there is nothing to lay parts on: name sheets such as 3000x1500, or give them in the list of parts"
        )
    return Demand(types, tuple(_stock(row, folder, reading) for row, folder in stock))


def _lists(text: str) -> Iterator[tuple[PartList, Path]]:
    """A word of the command line as a list: one that it names, or one of a single part."""
    path, quantity = _counted(text, "quantity")
    file = Path(path)
    if is_file(file) and is_list(file, read_limited(file)[:4000]):
        if quantity is not None:
            raise InputError(f"a list of parts has quantities of its own: leave ={quantity} out", file=file)
        yield read_list(file), file.parent
    else:
        yield PartList((PartRow(part=path, quantity=1 if quantity is None else quantity),)), Path()


def _counted(text: str, what: str) -> tuple[str, int | None]:
    """A name and the number behind `=`; None where there is none."""
    name, equals, count = text.rpartition("=")
    if not equals or not name:
        return text, None
    if not count.isascii() or not count.isdigit() or not 1 <= int(count) <= MOST:
        raise InputError(f"{text}: the {what} behind = is {count!r}: expected a whole number from 1 to {MOST}")
    return name, int(count)


def _sheet_row(text: str, remnant: bool) -> SheetRow:
    name, stock = _counted(text, "number of sheets")
    if Path(name).suffix.lower() in (".json", ".dxf", ".svg"):
        return SheetRow(file=name, stock=stock, remnant=remnant)
    return SheetRow(size=name, stock=stock, remnant=remnant)


def _types(row: PartRow, folder: Path, reading: ReadOptions, tell: Tell) -> Iterator[PartType]:
    """Each part in a file, as often as its row says."""
    file = folder / row.part
    nest = without_placing_notes(_read(file, row, reading))
    for note in nest.notes:
        tell(f"{file}: {note.text}")
    free = row.rotations == ANY and row.grain is None
    listed = row.rotations or QUARTERS
    turns = listed if row.grain is None else turns_along(row.grain, listed)
    if not turns:
        raise _at(row, f"{row.part}: grain: {row.grain} leaves none of its rotations")
    for part in nest.parts:
        name = file.stem if len(nest.parts) == 1 else f"{file.stem}.{part.id}"
        if free:
            turns = sides_on_axes(part)
        yield PartType(name, part, row.quantity, row.priority, row.order, turns, row.mirror, str(file), free)


def _read(file: Path, row: PartRow, reading: ReadOptions) -> Nest:
    own = None if (beside := job_beside(file)) is None else read_job(beside)
    answers = with_answers(reading.answers, () if own is None else own.answers)
    with _placed(file, row):
        return read_nest(file, replace(reading, frame="part", sheet_size_mm=None, answers=answers))


@contextmanager
def _placed(file: Path, row: PartRow | SheetRow) -> Iterator[None]:
    """Say of a file that is not there where the list names it."""
    try:
        yield
    except InputError as error:
        if row.place is None or error.line is not None or is_file(file):
            raise
        raise _at(row, f"{error.message}: {file}") from None


def _at(row: PartRow | SheetRow, message: str) -> InputError:
    place = row.place
    if place is None:
        return InputError(message)
    return InputError(message, file=place.file, line=place.line, column=place.column)


def _named(types: Iterable[PartType]) -> tuple[PartType, ...]:
    """Each type with a name of its own."""
    found: dict[str, PartType] = {}
    for kind in types:
        name, number = kind.name, 1
        while name.casefold() in found:
            number += 1
            name = f"{kind.name}~{number}"
        found[name.casefold()] = replace(kind, name=name)
    return tuple(found.values())


def _stock(row: SheetRow, folder: Path, reading: ReadOptions) -> Stock:
    if row.file:
        file = folder / row.file
        with _placed(file, row):
            sheet = read_sheet(file, reading)
        name = file.name
    else:
        width, height = _size(row)
        sheet, name = Sheet.rectangle(width, height), f"{width:g}x{height:g}"
    count = 1 if row.remnant and row.stock is None else row.stock
    return Stock(name, sheet, count, row.price, row.remnant)


def _size(row: SheetRow) -> tuple[float, float]:
    width, _, height = row.size.lower().partition("x")
    try:
        size = float(width), float(height)
    except ValueError:
        size = (0.0, 0.0)
    if not (0 < size[0] <= 1e6 and 0 < size[1] <= 1e6):
        raise _at(row, f"{row.size!r} is not a size: write width x height in mm, such as 3000x1500")
    return size


# Lists of parts read, YAML or JSON: every mistake with its line and column.

PARTS, SHEETS = "parts", "sheets"


@dataclass(frozen=True, slots=True)
class PartList:
    """What a list says: parts, and sheets if it names any."""

    parts: tuple[PartRow, ...]
    sheets: tuple[SheetRow, ...] = ()


def is_list(path: Path, head: bytes) -> bool:
    """Whether a file is a list of parts: YAML, or JSON that is no nest."""
    return path.suffix.lower() in (".yaml", ".yml") or (
        path.suffix.lower() == ".json" and b"kerfwise-nest/" not in head
    )


def read_list(path: Path) -> PartList:
    """Read a list of parts.

    Raises
    ------
    InputError
        If it cannot be read, or is wrong anywhere, with line and column: all mistakes at once.
    """
    try:
        text = read_limited(path, MOST_BYTES_OF_YAML).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not a list of parts: the file is not UTF-8 text ({error.reason})", file=path) from None
    except ValueError as error:
        raise InputError(f"cannot read the list: no file can have this name ({error})", file=path) from None
    except OSError as error:
        raise InputError(f"cannot read the list of parts: {error.strerror}", file=path) from None
    return list_of(text, str(path))


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
    parts = [_part(node, k, problems) for k, node in enumerate(_members(found, PARTS, problems), 1)]
    sheets = [_sheet(node, k, problems) for k, node in enumerate(_members(found, SHEETS, problems), 1)]
    problems.raise_any()
    if not parts:
        raise InputError("names no parts: expected parts: [{part: FILE, quantity: N}, …]", file=file)
    return PartList(tuple(parts), tuple(sheets))


def _members(found: Mapping[str, yaml.Node], key: str, problems: Problems) -> list[yaml.Node]:
    return items(found[key], problems, key) if key in found else []


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

    part: str = field(default="", metadata=option(Text(), "file of the part: DXF, SVG or JSON, from the list's folder"))
    quantity: int = field(default=1, metadata=option(Number(1, MOST, whole=True), "how many are wanted"))
    priority: int = field(
        default=1, metadata=option(Number(1, 50, whole=True), "parts of lower numbers are placed first")
    )
    order: str = field(default="", metadata=option(Text(), "the order that it is for"))
    rotations: tuple[float, ...] = field(default=QUARTERS, metadata=option(Turns(), "how it may be turned"))
    grain: Grain | None = field(
        default=None,
        metadata=option(Choice(("none", *GRAINS), none="none"), "how its x axis lies to the sheet's, because of grain"),
    )
    mirror: bool = field(default=False, metadata=option(Flag(), "whether it may be turned over"))
    place: Place | None = None


@dataclass(frozen=True, slots=True)
class SheetRow:
    """A sheet by its size, or by a file, and how many there are."""

    size: str = field(default="", metadata=option(Text(), "width x height in mm, such as 3000x1500"))
    file: str = field(default="", metadata=option(Text(), "file of the sheet, from the list's folder"))
    stock: int | None = field(default=None, metadata=option(Number(1, MOST, whole=True), "how many there are"))
    price: float | None = field(default=None, metadata=option(Number(0), "price of one"))
    remnant: bool = field(default=False, metadata=option(Flag(), "whether it is a remnant, which is used first"))
    place: Place | None = None


# A sheet alone, to lay parts on: a remnant as `solve` writes it, or a drawing of one.


def read_sheet(path: str | Path, options: ReadOptions = ReadOptions()) -> Sheet:  # noqa: B008 - frozen
    """The sheet in a file: JSON (kerfwise-nest/1 without parts), DXF or SVG.

    Of a drawing it is the closed line on the sheet's layer, or the outer one of all closed lines; those in it are its
    holes.

    Raises
    ------
    InputError
        If the file cannot be read, holds parts, or holds no sheet.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"cannot tell the format of '{file.name}': expected {', '.join(SUFFIXES)}", file=file)
    data = file_bytes(file)
    try:
        if suffix == ".json":
            sheet = sheet_in_json(data, options)
        elif suffix == ".dxf":
            from kerfwise.encoder.readers.dxf import read_dxf

            sheet = _drawn(read_dxf(file, data, options), options)
        else:
            from kerfwise.encoder.readers.svg import read_svg

            sheet = _drawn(read_svg(data, options), options)
        if problems := sheet_ring_problems(sheet):
            raise InputError("the sheet cannot be used", details=tuple(problems))
    except InputError as error:
        raise InputError(
            error.message, file=file, line=error.line, column=error.column, details=error.details
        ) from error.__cause__
    return sheet


def _drawn(drawing: Drawing, options: ReadOptions) -> Sheet:
    layers: Layers = options.layers
    on_layer = [piece for piece in drawing.pieces if layers.use(piece.names).purpose == "sheet"]
    joined = join(tuple(on_layer or drawing.pieces), options.join_tolerance_mm)
    if not joined.rings:
        raise InputError("holds no closed line that could be a sheet")
    return drawn_sheet(joined.rings)


def without_placing_notes(nest: Nest) -> Nest:
    """A nest whose sheet does not matter, without the notes on where it was laid."""
    return replace(nest, notes=tuple(note for note in nest.notes if not note.text.startswith(NO_SHEET)))


# The JSON Schema of a list of parts: `python -m kerfwise.jobs.nesting.request > jobs/nesting/parts.schema.json`.

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
    keys = {o.key: {"description": o.help, **_value(o.kind)} for o in options_of(kind)}
    return {"type": "object", "properties": keys, "additionalProperties": False}


def _value(kind: OptionKind) -> Json:
    """A text may be a number to readers of YAML, such as that of an order."""
    return kind.schema() | ({"type": ["string", "number"]} if isinstance(kind, Text) else {})


def schema_text() -> str:
    """The schema as the text of its file."""
    return json.dumps(list_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())
