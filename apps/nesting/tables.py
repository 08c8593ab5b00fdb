"""Lists of parts and stock as tables, CSV and XLSX, in the words that shops have for their columns."""

from __future__ import annotations

import csv
import datetime
import io
import json
import re
import unicodedata
import zipfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from kerfwise.app_modules import library
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, read_named
from kerfwise.encoder.nearest_name import nearest

TABLE_SUFFIXES = (".csv", ".tsv", ".txt", ".xlsx", ".xlsm")


def _plain(text: str) -> str:
    """A head without accents, capitals, blanks and points: `Stück-Zahl` and `STUCKZAHL` are the same."""
    text = text.casefold().replace("ł", "l").replace("ø", "o").replace("ı", "i").replace("æ", "ae")
    bare = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    return "".join(c for c in bare if c.isalnum())


def _read_words() -> tuple[dict[str, list[tuple[int, str]]], Mapping[str, str]]:
    data = json.loads((resources.files(__package__) / "table_words.json").read_text(encoding="utf-8"))
    found: dict[str, list[tuple[int, str]]] = {}
    for column, tiers in data["columns"].items():
        for tier, words in enumerate(tiers):
            for word in words.split():
                found.setdefault(_plain(word), []).append((tier, column))
    return found, data["cells"]


COLUMNS_OF, CELL_WORDS = _read_words()
"""Every word for a column → columns that it may mean, 0 for a word that means nothing else; and the words in cells."""
_UNIT = re.compile(r"[\[(/,]\s*(mm|cm|in|inch|inches|zoll|pulgadas|мм|см|\"|”|″)\s*[\])]?\s*$", re.IGNORECASE)
_MM = {"mm": 1.0, "cm": 10.0, "мм": 1.0, "см": 10.0}
_INCH_MM = 25.4
_ONCE = ("quantity", "material", "thickness", "size")
"""Columns that must not be there twice: nobody knows which counts."""


@dataclass(frozen=True, slots=True)
class Head:
    """The head of a table: its row, which column each cell names, the millimetres of its unit, and how many cells there
    are; `twice` is a column that two cells name alike, `unread` are cells whose word nobody knows.
    """

    line: int
    columns: Mapping[int, str]
    mm: Mapping[int, float]
    wide: int
    twice: tuple[str, str, str] | None = None
    unread: tuple[str, ...] = ()


LONGEST_WORD = 200
"""Letters of what a column may be called."""


def head_of(line: int, cells: Sequence[Any]) -> Head | None:
    """The head that a row of cells is; None where it names neither parts nor sheets.

    A word that may mean one of two columns, such as `pieces`, is the one that no other cell names.

    Examples
    --------
    >>> head_of(1, ["Zeichnung", "Stück", "Dicke [mm]", "Bemerkung"]).columns
    {0: 'part', 1: 'quantity', 2: 'thickness'}
    """
    texts = [text if len(text := str(cell or "").strip()) <= LONGEST_WORD else "" for cell in cells]
    units = [_UNIT.search(text) for text in texts]
    bare = [text[: unit.start()] if unit else text for text, unit in zip(texts, units, strict=True)]
    words = [_plain(re.sub(r"[\[(].*?[\])]", "", text) or text) for text in bare]
    meant = [
        (tier, len(COLUMNS_OF[word]), k, column)
        for k, word in enumerate(words)
        for tier, column in COLUMNS_OF.get(word, ())
    ]
    columns: dict[int, str] = {}
    for _, _, k, column in sorted(meant):
        if k not in columns and column not in columns.values():
            columns[k] = column
    named = set(columns.values())
    sheets = "size" in named or {"width", "length"} <= named
    if not sheets and not ("part" in named and len(texts) - texts.count("") >= 1):
        return None
    mm = {k: _MM.get(unit[1].casefold(), _INCH_MM) for k, unit in enumerate(units) if unit is not None}
    same = [(column, texts[k], texts[j]) for k, column in columns.items() if column in _ONCE
            for tier, _, j, other in meant if other == column and j not in columns and tier == 0
            and (0, column) in COLUMNS_OF[words[k]]]  # fmt: skip
    unread = tuple(text for text, word in zip(texts, words, strict=True) if word and word not in COLUMNS_OF)
    return Head(line, dict(sorted(columns.items())), mm, len(texts), same[0] if same else None, unread)


def misspelt(head: Head) -> tuple[str, str] | None:
    """A cell of a head that is one letter off a word for a column that no cell names, and that word.

    Examples
    --------
    >>> misspelt(head_of(1, ["Zeichnung", "Menge", "Dikce", "Kunde"]))
    ('Dikce', 'dicke')
    """
    named = set(head.columns.values())
    for text in head.unread:
        word = _plain(text)
        for known, meanings in COLUMNS_OF.items():
            if len(known) >= _LEAST_WORD and _one_off(word, known) and not named & {column for _, column in meanings}:
                return text, known
    return None


_LEAST_WORD = 5
"""Shorter words are a letter off too many others."""


def _one_off(word: str, known: str) -> bool:
    """Whether one letter is missing, added or another, or two stand in each other's place."""
    k = next((k for k, (a, b) in enumerate(zip(word, known, strict=False)) if a != b), min(len(word), len(known)))
    rest, other = word[k:], known[k:]
    swapped = rest[1::-1] + rest[2:] == other
    return rest[1:] == other or rest == other[1:] or rest[1:] == other[1:] or swapped


# A file as tables: each with its head and its rows of cells, blank rows left out.


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells under a head: (line, cells). `sheet` is the tab of a workbook, "" for CSV.

    `left_out` counts rows under the head that begin with #, and those that a workbook hides, as its filters do.
    """

    sheet: str
    head: Head
    rows: tuple[tuple[int, tuple[Any, ...]], ...]
    left_out: tuple[int, int] = (0, 0)

    @property
    def of_stock(self) -> bool:
        """Whether it lists sheets to cut from, not parts."""
        named = set(self.head.columns.values())
        return "part" not in named or ("size" in named and "quantity" not in named)


def is_table(path: Path) -> bool:
    """Whether a file is read as a table, by its ending.

    Examples
    --------
    >>> is_table(Path("monday.CSV")), is_table(Path("monday.yaml"))
    (True, False)
    """
    return path.suffix.lower() in TABLE_SUFFIXES


def read_tables(path: Path) -> list[Table]:
    """The tables of a file.

    Raises InputError if it cannot be read, or no row names a column of parts or sheets: with the words that it has.
    """
    data = read_named(path, "the list of parts", MOST_BYTES_OF_YAML)
    is_book = path.suffix.lower() in (".xlsx", ".xlsm")
    grids = list(_workbook(data, path)) if is_book else [("", _csv(data, path), frozenset[int]())]
    tables = [table for name, grid, hidden in grids if (table := _table(name, grid, hidden)) is not None]
    if not tables:
        first = next((row for _, grid, _ in grids for row in grid if not _is_comment(row[1])), (1, ()))
        raise InputError(_no_head(first), file=path, line=first[0])
    for table in tables:
        if table.head.twice is not None:
            column, one, other = table.head.twice
            message = f"two columns say {column}: {one!r} and {other!r}: leave one out, or call it otherwise"
            raise InputError(message, file=path, line=table.head.line)
        if (wrong := misspelt(table.head)) is not None:
            message = f"column {wrong[0]!r}: did you mean {wrong[1]!r}? write it so, or call the column otherwise"
            raise InputError(message, file=path, line=table.head.line)
    return tables


Grid = list[tuple[int, tuple[Any, ...]]]
_HEAD_WITHIN = 20
"""A head stands in one of the first rows; above it may be a title."""


def _table(name: str, grid: Grid, hidden: Collection[int] = ()) -> Table | None:
    rows = [row for row in grid if not _is_comment(row[1])]
    head = next((head for row in rows[:_HEAD_WITHIN] if (head := head_of(*row)) is not None), None)
    if head is None:
        return None
    below = [row for row in grid if row[0] > head.line]
    told = rows if 0 in head.columns or str(dict(grid)[head.line][0]) != "#" else grid  # under a head # they are places
    seen = [row for row in told if row[0] > head.line and row[0] not in hidden]
    unseen = sum(row[0] in hidden for row in below)
    return Table(name, head, tuple(seen), (len(below) - unseen - len(seen), unseen))


def _is_comment(cells: Sequence[Any]) -> bool:
    """Whether a row is one for people: it begins with #, and with more than that."""
    return len(str(cells[0] or "")) > 1 and str(cells[0]).startswith("#")


def _no_head(row: tuple[int, tuple[Any, ...]]) -> str:
    cells = [str(cell) for cell in row[1] if cell not in (None, "")]
    shown = ", ".join(repr(cell[:30]) for cell in cells[:8]) or "nothing"
    near = next((n for cell in cells if (n := nearest(_plain(cell), [w for w in COLUMNS_OF if len(w) > 3]))), None)
    hint = f"; did you mean {near!r}?" if near else ""
    return (
        f"no row names the columns: expected a head such as part; quantity; material; thickness, got {shown}{hint} "
        "(`kerfwise nest new-list` writes one)"
    )


def _csv(data: bytes, path: Path) -> Grid:
    text = _decoded(data, path)
    text = re.sub(r"\Asep=(.)\r?\n", lambda found: "\n", text, flags=re.IGNORECASE)
    return max((_rows(text, divider) for divider in ";,\t|"), key=_fits)


def _fits(grid: Grid) -> tuple[int, int]:
    """How well a way of dividing a text fits: columns that the head names, and rows as wide as it."""
    table = _table("", grid)
    if table is None:
        return 0, 0
    wide = max(table.head.columns) + 1
    return len(table.head.columns), sum(len(cells) >= wide for _, cells in table.rows)


def _rows(text: str, divider: str) -> Grid:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=divider, skipinitialspace=True)
    rows: Grid = []
    line = 0
    try:
        for cells in reader:
            begun, line = line + 1, reader.line_num
            stripped = tuple(cell.strip() for cell in cells)
            if any(stripped):
                rows.append((begun, stripped))
    except csv.Error:  # a quote that nothing closes, or a cell past all limits: another divider may do
        return []
    return rows


def _decoded(data: bytes, path: Path) -> str:
    """The text of a list: UTF-8, UTF-16 as Excel writes it, or Windows' own letters."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", "replace")
    if b"\0" in data:
        raise InputError("not a list of parts: it is no text; save it as CSV or XLSX", file=path)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _workbook(data: bytes, path: Path) -> Iterator[tuple[str, Grid, frozenset[int]]]:
    """Every visible tab of a workbook, its values as they were calculated, and the rows in it that are hidden."""
    openpyxl = library("openpyxl", "a list of parts as .xlsx", "nest")  # loaded by those who have workbooks only

    try:
        book = openpyxl.load_workbook(io.BytesIO(data), data_only=True)
        for tab in book.worksheets:
            if tab.sheet_state == "visible":
                rows = ((k, tuple(row)) for k, row in enumerate(tab.iter_rows(values_only=True), 1))
                hidden = frozenset(k for k, row in tab.row_dimensions.items() if row.hidden)
                yield tab.title, [(k, row) for k, row in rows if any(cell not in (None, "") for cell in row)], hidden
    except (zipfile.BadZipFile, KeyError, ValueError, OSError, TypeError, EOFError) as error:
        raise InputError(f"not a workbook that can be read ({error}): save it as .xlsx or as CSV", file=path) from None


# Cells as values: decimal commas, fractions of an inch, days, yes and no, in the words that people have for them.


class WrongCell(ValueError):
    """A cell that cannot be what its column says; the text says what was expected."""


_YES, _NO, _ALONG, _ACROSS = (frozenset(CELL_WORDS[key].split()) for key in ("yes", "no", "along", "across"))
_RANKS: Mapping[str, int] = {
    word: rank for rank, key in enumerate(("rush", "normal", "low"), 1) for word in CELL_WORDS[key].split()
}


def number_in(text: str) -> float:
    """The number in a text, with a decimal point or comma, fractions too.

    Examples
    --------
    >>> number_in("1,5"), number_in("12.25"), number_in("1 1/4"), number_in("1.234,5")
    (1.5, 12.25, 1.25, 1234.5)
    """
    bare = re.sub(r"[\s\u00a0\u202f']", "", text)
    if found := re.fullmatch(r"(?:(\d+)[\s-]+)?(\d+)/(\d+)", text.strip()):
        if int(found[3]) == 0:
            raise WrongCell(f"{text!r} divides by 0")
        return int(found[1] or 0) + int(found[2]) / int(found[3])
    if re.fullmatch(r"[+-]?\d{1,3}(\.\d{3})+,\d+", bare):
        bare = bare.replace(".", "").replace(",", ".")
    elif re.fullmatch(r"[+-]?\d{1,3}(,\d{3})+\.\d+", bare):
        bare = bare.replace(",", "")
    elif bare.count(",") == 1 and "." not in bare:
        bare = bare.replace(",", ".")
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)", bare) or not bare.isascii():
        raise WrongCell(f"expected a number, got {text[:40]!r}")
    return float(bare)


def whole_in(cell: Any, most: int) -> int:
    """A whole number from 1 on; thousands that could be decimals are refused."""
    text = str(cell).strip()
    text = re.sub(r"\s*(x|pcs?|stk|stück|st|szt|ks|db|adet|шт|pz|uds?|kpl)\.?$", "", text, flags=re.IGNORECASE)
    if isinstance(cell, str) and re.fullmatch(r"\d{1,3}[.,]\d{3}", text):
        raise WrongCell(
            f"{text!r} may be {text[:-4]} or {re.sub('[.,]', '', text)}: write it without the point or comma"
        )
    value = number_in(text)
    if value != int(value) or not 1 <= value <= most:
        raise WrongCell(f"expected a whole number from 1 to {most}, got {text[:40]!r}")
    return int(value)


def length_in(cell: Any, mm: float = 1.0) -> float:
    """A length over 0, mm; `mm` is what the unit in the head is, a unit in the cell goes before it.

    Examples
    --------
    >>> length_in("6 mm"), length_in('1/4"'), length_in("0,8"), round(length_in("0.5 in"), 2)
    (6.0, 6.35, 0.8, 12.7)
    """
    text = str(cell).strip().replace("”", '"').replace("″", '"')
    found = re.fullmatch(r"(.*?)\s*(mm|мм|cm|см|m|м|in|inch|inches|zoll|\")?\.?", text, re.IGNORECASE)
    assert found is not None
    unit = (found[2] or "").casefold()
    scale = {**_MM, "m": 1000.0, "м": 1000.0, "": mm}.get(unit, _INCH_MM)
    try:
        value = round(number_in(found[1]) * scale, 6)
    except WrongCell:
        raise WrongCell(f"expected a length, got {text[:40]!r}") from None
    if not 0 < value <= 1e6:
        raise WrongCell(f"expected a length over 0, got {text[:40]!r}")
    return value


def size_in(cell: Any, mm: float = 1.0) -> tuple[float, float]:
    """Width and length of a sheet, mm, such as `3000 x 1500` or `3000×1500 mm`."""
    sides = re.split(r"\s*[xX×*хХ]\s*", re.sub(r"\s*mm\b", "", str(cell).strip()))
    if len(sides) != 2:
        raise WrongCell(f"expected width x length such as 3000x1500, got {str(cell)[:40]!r}")
    return length_in(sides[0], mm), length_in(sides[1], mm)


def day_in(cell: Any) -> datetime.date:
    """A day: 2026-12-24, 24.12.2026, or 24/12/2026 where it can be no other.

    Examples
    --------
    >>> day_in("24.12.2026").isoformat(), day_in("12/24/2026").isoformat()
    ('2026-12-24', '2026-12-24')
    """
    if isinstance(cell, datetime.datetime):
        return cell.date()
    if isinstance(cell, datetime.date):
        return cell
    text = str(cell).strip()
    numbers = [int(part) for part in re.findall(r"\d+", text)][:3]
    try:
        if re.match(r"\d{4}[-./年]", text) and len(numbers) == 3:
            return datetime.date(*numbers)
        if len(numbers) == 3:
            one, other, year = numbers
            year += 2000 if year < 100 else 0
            if "/" in text and one <= 12 and other <= 12 and one != other:
                both = datetime.date(year, other, one), datetime.date(year, one, other)
                raise WrongCell(f"{text!r} may be {both[0]} or {both[1]}: write it so, year-month-day")
            day, month = (other, one) if other > 12 else (one, other)
            return datetime.date(year, month, day)
    except ValueError as error:
        raise error if isinstance(error, WrongCell) else WrongCell(f"there is no such day as {text!r}") from None
    raise WrongCell(f"expected a day such as 2026-12-24, got {text[:40]!r}")


def rank_in(cell: Any) -> int:
    """A priority: a number from 1 to 50, 1 first, or a word such as rush, normal, low."""
    word = _plain(str(cell))
    if word in _RANKS:
        return _RANKS[word]
    if word in _YES and not word.isdigit():
        return 1
    if word in _NO and not word.isdigit():
        return _RANKS["normal"]
    try:
        return whole_in(cell, 50)
    except WrongCell:
        raise WrongCell(
            f"expected a number from 1 (first) to 50, or rush, normal, low; got {str(cell)[:40]!r}"
        ) from None


def grain_in(cell: Any) -> str | None:
    """`along`, `across` or None."""
    word = _plain(str(cell))
    if word in _ALONG:
        return "along"
    if word in _ACROSS:
        return "across"
    if word in _NO or not word:
        return None
    raise WrongCell(f"expected along, across or none, got {str(cell)[:40]!r}")


def turns_in(cell: Any) -> tuple[float, ...] | str:
    """Degrees such as `0/180`, one step such as 90, or `any`.

    Examples
    --------
    >>> turns_in("0/180"), turns_in("90"), turns_in("none"), turns_in("any")
    ((0.0, 180.0), (0.0, 90.0, 180.0, 270.0), (0.0,), 'any')
    """
    text = str(cell).strip()
    word = _plain(text)
    if word in {"any", "free", "all", "frei", "beliebig", "libre", "libero", "dowolny", "vapaa", "любой"}:
        return "any"
    if word in _NO and word != "0":
        return (0.0,)
    degrees = [number_in(part) % 360 for part in re.split(r"\s*[/;|°+&]\s*|\s+|,(?=\s*\d{2,})", text) if part]
    if not degrees:
        raise WrongCell(f"expected degrees such as 0/180, a step such as 90, none or any; got {text[:40]!r}")
    if len(degrees) > 1 or degrees[0] == 0:
        return tuple(dict.fromkeys(degrees))
    if 360 % degrees[0]:
        raise WrongCell(f"expected a step that 360 is a multiple of, such as 90, got {text[:40]!r}")
    return tuple(k * degrees[0] for k in range(int(360 / degrees[0])))


def yes_in(cell: Any) -> bool:
    """Yes or no."""
    word = _plain(str(cell))
    if word in _YES:
        return True
    if word in _NO or not word:
        return False
    raise WrongCell(f"expected yes or no, got {str(cell)[:40]!r}")


# A new list, to fill in.

TEMPLATE = """\
# One row a part, for kerfwise nest parts.csv -o OUT and the sheets; rows that begin with # are not read.
# part: DXF, SVG or JSON, from this file's folder. due: year-month-day. priority: 1 is first, or rush, normal, low.
# grain: along, across or none. rotations: 0/180, a step such as 90, none or any. mirror: yes or no.
part;quantity;material;thickness [mm];order;due;priority;grain;rotations;mirror
bracket.dxf;12;S235;6;4711;2026-12-24;normal;none;90;no
flange.dxf;40;S235;10;4712;;rush;along;0/180;no
"""


def template_workbook() -> bytes:
    """The same as a workbook, with a second tab for the stock."""
    book = library("openpyxl", "a list of parts as .xlsx", "nest").Workbook()
    parts = book.active
    parts.title = "parts"
    for row in TEMPLATE.splitlines()[3:]:
        parts.append([int(cell) if cell.isdigit() else cell for cell in row.split(";")])
    stock = book.create_sheet("stock")
    stock.append(["size", "stock", "price", "remnant", "material", "thickness [mm]"])
    stock.append(["3000x1500", 4, 320, "no", "S235", 6])
    buffer = io.BytesIO()
    book.save(buffer)
    return buffer.getvalue()
