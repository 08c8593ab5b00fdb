"""What is to be nested: lists of parts, sheets and the command line's rows, read as one request."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PureWindowsPath
from typing import ClassVar

from kerfwise.encoder.contour_checks import sheet_ring_problems
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_file, is_folder, read_limited
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import QUANTITY_KEY, Nest, Part, Sheet
from kerfwise.encoder.questions import Questions, QuestionsOfFiles, with_answers
from kerfwise.encoder.readers.drawing import Drawing
from kerfwise.encoder.readers.join import join
from kerfwise.encoder.readers.json_nest import sheet_in_json
from kerfwise.encoder.readers.layers import Layers
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.readers.read import SUFFIXES, file_bytes, known_suffix, read_nest, unpacked
from kerfwise.encoder.readers.sheet import NO_SHEET, drawn_sheet
from kerfwise.jobs.inputs import Tell, silent
from kerfwise.jobs.nest_job import job_beside, read_job

from .part_list import ANY, MOST, BadRow, PartList, PartRow, SheetRow, is_list, read_list
from .placement.blocks import sides_on_axes
from .placement.demand import QUARTERS, Demand, PartType, Stock, turns_along
from .tables import WrongCell, is_table, length_in, whole_in

_MOST_NAMED = 8


@dataclass(frozen=True, eq=False, slots=True)
class Order:
    """What is to be nested, and what of the lists cannot be: `bad` is empty unless bad parts may be left out."""

    wanted: Demand
    bad: tuple[BadRow, ...] = ()


def order_of(
    parts: Sequence[str],
    sheets: Sequence[str],
    remnants: Sequence[str],
    reading: ReadOptions,
    tell: Tell = silent,
    *,
    skip_bad: bool = False,
    name_pattern: str | None = None,
) -> Order:
    """Read everything that the command line names.

    `parts`: files of parts, each with its quantity behind it (`bracket.dxf=12`), folders of them, and lists of parts.
    `sheets`: sizes such as `3000x1500`, or files, each with how many there are behind it (`3000x1500=4`), and lists of
    stock. `remnants`: the same, of remnants. `reading`: how drawings are read. `tell`: told what the readers had to
    say. `skip_bad`: whether parts that cannot be read are left out, each with its reason. `name_pattern`: what the
    names of files say, such as `{part}_{quantity}x`: see `NamePattern`. Raises InputError for all that cannot be read
    or used, unless it may be left out.
    """
    names = None if name_pattern is None else NamePattern(name_pattern)
    rows: list[tuple[PartRow, Path]] = []
    stock: list[tuple[SheetRow, Path]] = []
    bad: list[BadRow] = []
    for text in parts:
        for listed, folder in _lists(text, names, skip_bad, bad):
            rows += ((row, folder) for row in listed.parts)
            stock += ((row, folder) for row in listed.sheets)
            bad += listed.bad
            if listed.unread:
                tell(escape_text(f"{text}: columns that are not read: {join_names(listed.unread, _MOST_NAMED)}"))
            for count, why in zip(listed.left_out, ("begin with #", "are hidden in the workbook"), strict=True):
                if count:
                    tell(escape_text(f"{text}: rows that are not read, as they {why}: {count}"))
    for text in (*sheets, *remnants):
        if is_table(file := Path(text)):
            stock += ((row, file.parent) for row in read_list(file).sheets)
    for remnant, texts in ((False, sheets), (True, remnants)):
        stock += ((_sheet_row(text, remnant), Path()) for text in texts if not is_table(Path(text)))
    types = _named(_types_of(rows, reading, tell, skip_bad, bad))
    if not types:
        message = "no part can be nested" if bad else "the lists name sheets and no parts: name files of parts, too"
        raise InputError(message, details=tuple(map(str, bad)))
    if not stock:
        raise InputError(
            "there is nothing to lay parts on: name sheets such as 3000x1500, or give them in the list of parts"
        )
    return Order(Demand(types, tuple(_stock(row, folder, reading) for row, folder in stock)), tuple(bad))


def part_types(parts: Sequence[str], reading: ReadOptions, tell: Tell = silent) -> tuple[PartType, ...]:
    """The parts that words name, as on the command line, without anything to lay them on."""
    rows = [(row, folder) for text in parts for listed, folder in _lists(text, None, False, []) for row in listed.parts]
    return _named(_types_of(rows, reading, tell, False, []))


def _types_of(
    rows: Sequence[tuple[PartRow, Path]], reading: ReadOptions, tell: Tell, skip_bad: bool, bad: list[BadRow]
) -> list[PartType]:
    """All parts of all rows; those that cannot be read are noted in `bad`, or raised together."""
    found: list[PartType] = []
    questions: list[Questions] = []
    wrong: list[InputError] = []
    for row, folder in rows:
        try:
            found += _types(row, folder, reading, tell)
        except InputError as error:
            if isinstance(error, Questions):
                questions.append(error)
            if skip_bad:
                bad.append(BadRow(row.part, row.place, _in_a_line(error)))
            elif not isinstance(error, Questions):
                wrong.append(error)
    if len(wrong) > 1:
        head = f"{len(wrong)} of {len(rows)} parts cannot be used (--skip-bad nests the others)"
        listed = {row.place.file for row, _ in rows if row.place is not None}
        named = ", ".join(sorted(listed or {str(error.file) for error in wrong if error.file}))
        raise InputError(f"{named}: {head}" if named else head, details=tuple(map(_in_a_line, wrong)))
    if wrong:
        raise wrong[0]
    if questions and not (skip_bad and found):
        raise QuestionsOfFiles(questions)
    return found


def _in_a_line(error: InputError) -> str:
    if isinstance(error, Questions):
        texts = (f"{q.id}: {q.text} ({', '.join(q.flag(choice) for choice in q.choices)})" for q in error.questions)
        return f"{error.file}: nobody has answered {'; '.join(texts)}" if error.file else "; ".join(texts)
    return " ".join(str(error).split())


class NamePattern:
    """What the names of files say: text, `*` for anything, and {part}, {quantity}, {material}, {thickness}, {order}.

    Examples
    --------
    >>> NamePattern("{order}_{part}_{quantity}x_*").row("4711_bracket_12x_v2").quantity
    12
    """

    _KINDS: ClassVar[Mapping[str, str]] = {
        "part": ".+?", "quantity": "\\d+", "material": ".+?", "thickness": "[\\d.,]+", "order": ".+?",
        "priority": "\\d+",
    }  # fmt: skip

    def __init__(self, text: str) -> None:
        self._text = text
        problem = ""
        for piece in re.split(r"(\{[^{}]*\}|\*)", text):
            name = piece[1:-1] if piece.startswith("{") else ""
            if name and name not in self._KINDS:
                raise InputError(f"--name-pattern {text!r}: {unknown('field', name, self._KINDS)}")
            problem += ".*?" if piece == "*" else f"(?P<{name}>{self._KINDS[name]})" if name else re.escape(piece)
        try:
            self._pattern = re.compile(problem, re.IGNORECASE)
        except re.error:
            raise InputError(f"--name-pattern {text!r}: each field may stand in it once") from None

    def row(self, stem: str) -> PartRow:
        """What the name of a file says of its part.

        Raises InputError if the name is not like the pattern, or says a number that cannot be.
        """
        found = self._pattern.fullmatch(stem)
        if found is None:
            raise InputError(f"the name {stem!r} is not like --name-pattern {self._text!r}")
        values = {key: value for key, value in found.groupdict().items() if key != "part"}
        try:
            row = PartRow(material=values.get("material", ""), order=values.get("order", ""))
            if "thickness" in values:
                row = replace(row, thickness_mm=length_in(values["thickness"]))
            if "priority" in values:
                row = replace(row, priority=whole_in(values["priority"], 50))
            return replace(row, quantity=whole_in(values["quantity"], MOST)) if "quantity" in values else row
        except WrongCell as error:
            raise InputError(f"the name {stem!r}: {error}") from None


def _lists(text: str, names: NamePattern | None, skip_bad: bool, bad: list[BadRow]) -> Iterator[tuple[PartList, Path]]:
    """A word of the command line as a list: one that it names, or one of a single part or of a folder."""
    path, quantity = _counted(text, "quantity")
    file = Path(path)
    if is_table(file) or (is_file(file) and is_list(file, read_limited(file)[:4000])):
        if quantity is not None:
            raise InputError(f"a list of parts has quantities of its own: leave ={quantity} out", file=file)
        yield read_list(file, skip_bad), file.parent
        return
    files = _drawings(file) if file.is_dir() else [file]
    if not files:
        raise InputError("the folder holds no drawing of a part", file=file)
    for one in files:
        try:
            row = PartRow() if names is None else names.row(one.stem)
        except InputError as error:
            if not skip_bad:
                raise InputError(error.message, file=one) from None
            bad.append(BadRow(one.name, None, error.message))
            continue
        named = str(one) if one is not file else path
        yield PartList((replace(row, part=named, quantity=row.quantity if quantity is None else quantity),)), Path()


def _drawings(folder: Path) -> list[Path]:
    """The drawings of a folder by name: plans, tables of nests and lists are none."""
    found = sorted(one for one in folder.iterdir() if one.suffix.lower() in SUFFIXES and is_file(one))
    return [one for one in found if one.suffix.lower() != ".json" or not is_list(one, read_limited(one)[:4000])]


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
    if Path(name).suffix.lower() in SUFFIXES:
        return SheetRow(file=name, stock=stock, remnant=remnant)
    return SheetRow(size=name, stock=stock, remnant=remnant)


def _types(row: PartRow, folder: Path, reading: ReadOptions, tell: Tell) -> Iterator[PartType]:
    """Each part in a file, as often as its row says."""
    file = _file_of(_in_folder(folder, row.part))
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
        quantity = row.quantity or _drawn_quantity(part)
        if row.quantity is None and quantity > 1:
            tell(f"{file}: {quantity} copies of {name}, as the drawing or its name says (say how many to have others)")
        kind = PartType(name, part, quantity, row.priority, escape_text(row.order), turns, row.mirror, str(file), free)
        due = "" if row.due is None else row.due.isoformat()
        yield replace(kind, material=escape_text(row.material), thickness_mm=row.thickness_mm, due=due)


def _in_folder(folder: Path, name: str) -> Path:
    r"""A file of a list by its path, one of Windows too; `C:\parts\a.dxf`, if not there, is looked for beside it."""
    if is_file(folder / name) or not re.search(r"[A-Za-z]:|\\", name):
        return folder / name
    path = PureWindowsPath(name)
    inside = folder / path.as_posix()
    return inside if not path.drive and is_folder(inside.parent) else folder / path.name


def _drawn_quantity(part: Part) -> int:
    """How many of a part its drawing says, by the names of blocks, layers and the file; 1 where it says nothing."""
    quantity = next((value for key, value in part.attributes.items() if key.lower() == QUANTITY_KEY), None)
    return quantity if isinstance(quantity, int) and 1 <= quantity <= MOST else 1


def _file_of(file: Path) -> Path:
    """The file that a list names; where it names none with an ending, the drawing of that name."""
    if is_file(file) or not file.name:
        return file
    names = [file.name] if file.suffix.lower() in SUFFIXES else [file.name + suffix for suffix in SUFFIXES]
    there = [one for name in names if is_file(one := file.with_name(name))]
    if not there and is_folder(file.parent):  # written on a system that does not tell capitals apart
        folded = {name.casefold() for name in names}
        there = [one for one in sorted(file.parent.iterdir()) if one.name.casefold() in folded and is_file(one)]
    return there[0] if len(there) == 1 else file


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
    return Stock(name, sheet, count, row.price, row.remnant, escape_text(row.material), row.thickness_mm)


def _size(row: SheetRow) -> tuple[float, float]:
    width, _, height = row.size.lower().partition("x")
    try:
        size = float(width), float(height)
    except ValueError:
        size = (0.0, 0.0)
    if not (0 < size[0] <= 1e6 and 0 < size[1] <= 1e6):
        raise _at(row, f"{row.size!r} is not a size: write width x height in mm, such as 3000x1500")
    return size


# A sheet alone, to lay parts on: a remnant as `solve` writes it, or a drawing of one.


def read_sheet(path: str | Path, options: ReadOptions = ReadOptions()) -> Sheet:  # noqa: B008 - frozen
    """The sheet in a file: JSON (kerfwise-nest/1 without parts), DXF or SVG.

    Of a drawing it is the closed line on the sheet's layer, or the outer one of all closed lines; those in it are its
    holes. Raises InputError if the file cannot be read, holds parts, or holds no sheet.
    """
    file = Path(path)
    suffix = known_suffix(file)
    data = file_bytes(file)
    try:
        if suffix == ".json":
            sheet = sheet_in_json(data, options)
        elif suffix == ".dxf":
            from kerfwise.encoder.readers.dxf import read_dxf

            sheet = _drawn(read_dxf(file, data, options), options)
        else:
            from kerfwise.encoder.readers.svg import read_svg

            sheet = _drawn(read_svg(unpacked(data, file), options), options)
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
