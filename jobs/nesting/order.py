"""What was asked for, from files: the command line's parts, lists and sheets as one order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.contents import contents, is_file
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.questions import Questions, QuestionsOfFiles, with_answers
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.readers.read import read_nest
from kerfwise.encoder.readers.stock import read_sheet, without_place
from kerfwise.jobs.given import Tell, silent
from kerfwise.jobs.nest_job import job_beside, read_job
from kerfwise.nesting.defining_line import sides_on_axes
from kerfwise.nesting.wanted import QUARTERS, PartType, Stock, Wanted, turns_along

from .part_list import PartList, is_list, read_list
from .rows import MOST, PartRow, SheetRow
from .turns import ANY


def order_of(
    parts: Sequence[str],
    sheets: Sequence[str],
    remnants: Sequence[str],
    reading: ReadOptions,
    tell: Tell = silent,
) -> Wanted:
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
    return Wanted(types, tuple(_stock(row, folder, reading) for row, folder in stock))


def _lists(text: str) -> Iterator[tuple[PartList, Path]]:
    """A word of the command line as a list: one that it names, or one of a single part."""
    path, quantity = _counted(text, "quantity")
    file = Path(path)
    if is_file(file) and is_list(file, contents(file)[:4000]):
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
    nest = without_place(_read(file, row, reading))
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
