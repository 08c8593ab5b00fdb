"""kerfwise-nest/1: a nest as JSON, read and written."""

from __future__ import annotations

import difflib
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from itertools import islice
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.bevels.bevel import Bevel, EdgeBevel
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import places, schema_message, spoken, strict_json, unknown_keys, utf8_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Bridge, Contour, Kind, Nest, Note, Part, Sheet, Source, as_scrap
from kerfwise.encoder.progress_notice import amount

from .drawing import LIMIT_MM, checked_curve
from .options import GIVEN, ReadOptions, contradicted, doubts, mm_of
from .reading import reading_of
from .sheet import overridden, same_size

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator

PART_KEYS = ("id", "outer", "holes", "marks", "tabs", "bevel")


def read_json(data: bytes, options: ReadOptions) -> Nest:
    """The nest in a kerfwise-nest/1 file, not yet validated.

    Raises InputError when it is not JSON, not of this format, or a number in it cannot be a coordinate.
    """
    text, document = _parsed(data)
    if isinstance(document, dict) and isinstance(parts := document.get("parts"), list):
        amount(len(parts), "part", "parts")
    check_schema(document, text)
    if not document["parts"]:
        [(line, column)] = places(text, [["parts"]])
        raise InputError("the nest has no parts: a sheet alone is there to nest parts on", line=line, column=column)
    units, because = _units(document, options)
    scale = mm_of(units) or 1.0
    _check_ids(document["parts"], text)
    parts = tuple(_part(entry, scale) for entry in document["parts"])
    parts = tuple(
        _with_bevels(part, k, entry, scale, text) if "bevel" in entry else part
        for k, (part, entry) in enumerate(zip(parts, document["parts"], strict=True))
    )
    sheet, why, sheet_notes = _sheet(document["sheet"], scale), "as the file says", list[Note]()
    if options.sheet_size_mm is not None and not same_size(_size(sheet), options.sheet_size_mm):
        sheet, why, sheet_notes = overridden(sheet, options.sheet_size_mm)
    other_units = contradicted(document.get("units"), "units", units)
    notes = (*_not_read(document), *other_units, *sheet_notes, *doubts(sheet, units))
    scrap = (_curve(f"scrap{k}", rows, False, scale) for k, rows in enumerate(document.get("scrap", ()), 1))
    bridges = _bridges(document.get("bridges", ()), text, scale)
    reading = reading_of((units, because), sheet, why, (), notes, {})
    return Nest(sheet, parts, notes=notes, scrap=as_scrap(scrap), bridges=bridges, reading=reading)


def _size(sheet: Sheet) -> tuple[float, float]:
    x0, y0, x1, y1 = sheet.bounds
    return x1 - x0, y1 - y0


def sheet_in_json(data: bytes, options: ReadOptions) -> Sheet:
    """The sheet of a kerfwise-nest/1 file without parts, not yet validated.

    Raises InputError when it is not such a file, or has parts.
    """
    text, document = _parsed(data)
    check_schema(document, text)
    if document["parts"]:
        count = len(document["parts"])
        raise InputError(f'holds {count} parts: expected a sheet alone, with "parts": []')
    return _sheet(document["sheet"], mm_of(_units(document, options)[0]) or 1.0)


def _units(document: Mapping[str, Any], options: ReadOptions) -> tuple[str, str]:
    """The unit of a file, and why."""
    if "units" in document and (options.units is None or options.units_by_profile):
        return str(document["units"]), "the file says so"
    return (options.units, GIVEN) if options.units else ("mm", "by default")


def _bridges(entries: Sequence[Mapping[str, Any]], text: str, scale: float) -> tuple[Bridge, ...]:
    def point(at: Sequence[float]) -> tuple[float, float]:
        return at[0] * scale, at[1] * scale

    lines = places(text, [["bridges", k] for k in range(len(entries))])
    return tuple(
        Bridge((row["parts"][0], row["parts"][1]), point(row["from"]), point(row["to"]), row["width"] * scale, k, line)
        for k, (row, (line, _)) in enumerate(zip(entries, lines, strict=True), 1)
    )


def _parsed(data: bytes) -> tuple[str, Any]:
    text = utf8_text(data, "JSON")
    try:
        return text, strict_json(text)  # NaN becomes a text, which the schema refuses in place
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON: {error.msg}", line=error.lineno, column=error.colno) from None
    except ValueError as error:  # a number of thousands of digits
        raise InputError(f"not a nest: {error}") from None


def _check_ids(parts: Sequence[Mapping[str, Any]], text: str) -> None:
    seen: dict[str, int] = {}
    for k, part in enumerate(parts):
        first = seen.setdefault(part["id"], k)
        if first != k:
            [(line, column)] = places(text, [["parts", k, "id"]])
            raise InputError(
                f"part number {k + 1} has the id '{part['id']}' of part number {first + 1}; give each part its own",
                line=line,
                column=column,
            )


def _sheet(entry: Mapping[str, Any], scale: float) -> Sheet:
    if "width" in entry:
        return Sheet.rectangle(entry["width"] * scale, entry["height"] * scale)
    return Sheet(
        _curve("the sheet's outline", entry["outline"], True, scale),
        tuple(_curve(f"the sheet's hole {k}", h, True, scale) for k, h in enumerate(entry.get("holes", ()), 1)),
    )


def _part(entry: Mapping[str, Any], scale: float) -> Part:
    name = entry["id"]
    source = Source(*(str(entry.get(key) or "") for key in ("layer", "colour", "linetype", "block")))

    def contour(kind: Kind, rows: Sequence[Sequence[float]], number: str = "") -> Contour:
        closed = kind != "mark" or (len(rows) > 2 and rows[0][:2] == rows[-1][:2])
        contour_id = f"{name}.{kind}{number}"
        return Contour(contour_id, name, kind, _curve(contour_id, rows, closed, scale), source=source)

    return Part(
        name,
        contour("outer", entry["outer"]),
        tuple(contour("hole", rows, str(k)) for k, rows in enumerate(entry.get("holes", ()), 1)),
        tuple(contour("mark", rows, str(k)) for k, rows in enumerate(entry.get("marks", ()), 1)),
        {key: value for key, value in entry.items() if key not in PART_KEYS},
        tabs=tuple(_tab(tab, scale) for tab in entry.get("tabs", ())),
    )


def _with_bevels(part: Part, number: int, entry: Mapping[str, Any], scale: float, text: str) -> Part:
    """The part with the bevels of its contours."""
    of_hole = {hole.id: k for k, hole in enumerate(part.holes)}
    outer, holes = part.outer, list(part.holes)
    bevels = entry["bevel"]
    several = isinstance(bevels, list)
    for k, row in enumerate(bevels if several else [bevels]):
        path: list[str | int] = ["parts", number, "bevel", *([k] if several else [])]
        name = f"{part.id}.{row.get('of', 'outer')}"
        try:
            bevel = Bevel.of_json(row, scale)
            if name not in of_hole and name != outer.id:
                known = ["outer", *(hole.id.rpartition(".")[2] for hole in holes)]
                raise InputError(f"the part has no such contour: expected of: {' or '.join(known)}")
            drawn = outer if name == outer.id else holes[of_hole[name]]
            rows = entry["outer"] if name == outer.id else entry["holes"][of_hole[name]]
            bevelled = _bevelled(drawn, bevel, row.get("edges"), rows, scale)
        except InputError as error:
            [(line, column)] = places(text, [path])
            raise InputError(f"{name}: {error.message}", line=line, column=column) from None
        if name == outer.id:
            outer = bevelled
        else:
            holes[of_hole[name]] = bevelled
    return replace(part, outer=outer, holes=tuple(holes))


def _bevelled(
    drawn: Contour, bevel: Bevel, edges: Sequence[int] | None, rows: Sequence[Sequence[float]], scale: float
) -> Contour:
    """A contour with one more bevel, on all of it or on these edges, counted from 1 in the rows of the file."""
    if drawn.bevel is not None or (edges is None and drawn.edge_bevels):
        raise InputError("it is given a second bevel")
    if edges is None:
        return replace(drawn, bevel=bevel)
    if not edges:
        raise InputError("its bevel has no edges: name some, or leave out edges for the whole contour")
    made = list[EdgeBevel]()
    for number in edges:
        begin, end = rows[(number - 1) % len(rows)], rows[number % len(rows)]
        if not 0 < number <= len(rows) or begin[:2] == end[:2]:
            raise InputError(f"it has no edge {number}: they are counted from 1, each from one vertex to the next")
        edge = Curve.of([[begin[0] * scale, begin[1] * scale, *begin[2:]], [end[0] * scale, end[1] * scale]], False)
        if any(one.is_on(edge.segments[0]) for one in (*drawn.edge_bevels, *made)):
            raise InputError(f"its edge {number} is given a second bevel")
        made.append(EdgeBevel(bevel, edge))
    whole = replace(drawn, edge_bevels=(*drawn.edge_bevels, *made))
    return whole.with_one_bevel


def _tab(entry: Mapping[str, Any], scale: float) -> Tab:
    x, y = entry["at"]
    return Tab((x * scale, y * scale), entry.get("width", 0.0) * scale)


def _curve(name: str, rows: Sequence[Sequence[float]], closed: bool, scale: float) -> Curve:
    try:
        return checked_curve(rows, closed, scale)
    except InputError as error:
        raise InputError(f"{name}: {error.message}") from None


# The published JSON Schema of kerfwise-nest/1, and its complaints in words.

MOST_ERRORS = 20
FORMAT = "kerfwise-nest/1"
FEW = 4
"""Vertices that stand for all of a plain ring."""


@cache
def validator() -> Draft202012Validator:
    """The validator of the schema beside this file."""
    from jsonschema import Draft202012Validator as Validator

    schema = json.loads((files(__package__) / "nest.schema.json").read_text(encoding="utf-8"))
    return Validator(schema)


def check_schema(document: object, text: str) -> None:
    """Hold a parsed file against the schema, and its keys against those that they may be misspelt for.

    A part whose rings are rows of plain numbers is known to pass and is not shown to the schema, which would take
    minutes over the vertices of a large nest. Where the rest of the file is as plain, the schema is not even loaded.
    Raises InputError with a line for each mismatch (the first twenty), naming part, contour, vertex and line.
    """
    parts = document.get("parts") if isinstance(document, dict) else None
    parts = parts if isinstance(parts, list) else []
    ids = [part.get("id") if isinstance(part, dict) else None for part in parts]
    found = list(islice(_slips(document), MOST_ERRORS))
    numbers = [k for k, part in enumerate(parts) if not _plain(part)]
    if numbers or not _plain_but_for_parts(document):
        shown = document
        if isinstance(document, dict) and parts:
            shown = {**document, "parts": [_short(parts[k]) for k in numbers or [0]]}
        for error in islice(validator().iter_errors(shown), MOST_ERRORS):
            path = list(error.absolute_path)
            if len(path) > 1 and path[0] == "parts":
                path[1] = numbers[int(path[1])]
            found.append(([*path, *unknown_keys(error)[:1]], schema_message(error)))
    if found:
        raise _refusal(found, text, ids)


KEYS = {"": ("format", "units", "sheet", "parts", "scrap", "bridges"), "sheet": ("width", "height", "outline", "holes")}
KEYS["parts"] = (
    *PART_KEYS, "priority", "due", "quantity", "thickness", "material", "layer", "colour", "linetype", "block",
)  # fmt: skip
"""The keys of a file, of its sheet, and those of its parts that say something to kerfwise."""


def _objects(document: object) -> Iterator[tuple[list[str | int], str, dict[str, Any]]]:
    """The file, its sheet and its parts, as far as they are objects: where they stand, and which keys are theirs."""
    if not isinstance(document, dict):
        return
    yield [], "", document
    if isinstance(sheet := document.get("sheet"), dict):
        yield ["sheet"], "sheet", sheet
    parts = document.get("parts")
    for k, part in enumerate(parts if isinstance(parts, list) else ()):
        if isinstance(part, dict):
            yield ["parts", k], "parts", part


def _slips(document: object) -> Iterator[tuple[list[str | int], str]]:
    """Keys that are most likely misspelt, which would lose what they say, and numbers that are none."""
    for path, kind, value in _objects(document):
        for key in value.keys() - set(KEYS[kind]):
            near = _meant(key, KEYS[kind])
            if near is not None:
                yield [*path, key], f"unknown key, did you mean '{near}'?"
            elif _holds_contours(value[key]):
                yield [*path, key], "unknown key of what looks like contours: expected outer, holes or marks"
            elif (number := _no_number(value[key])) is not None:
                yield [*path, key], f"{number} given, expected a number"


@cache  # a large nest has the same keys thousands of times
def _meant(key: str, known: tuple[str, ...]) -> str | None:
    """The key that a word is most likely misspelt for.

    Examples
    --------
    >>> [_meant(word, ("holes", "width", "units")) for word in ("hole", "Holes", "widht", "unit", "lot", "holder")]
    ['holes', 'holes', 'width', 'units', None, None]
    """
    for name in known:
        alike = difflib.SequenceMatcher(None, key.lower(), name).ratio() >= ALIKE and abs(len(key) - len(name)) < 2
        if alike or sorted(key.lower()) == sorted(name):
            return name
    return None


ALIKE = 0.85
"""One letter in seven may be wrong, left out or too much."""


def _holds_contours(value: object) -> bool:
    """Whether a value is a ring of points or a list of such."""
    if not isinstance(value, list) or len(value) < 1:
        return False
    return _plain_ring(value) or all(map(_plain_ring, value))


def _no_number(value: object) -> str | None:
    """NaN or an infinity somewhere in a value, as the file has it; None where there is none."""
    if (isinstance(value, float) and not math.isfinite(value)) or value in ("NaN", "Infinity", "-Infinity"):
        return str(value)
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return next((number for one in inside if (number := _no_number(one)) is not None), None)


def _not_read(document: Mapping[str, Any]) -> list[Note]:
    """A word on keys of the file and of its sheet that nothing reads; a part may have any, but for what moves it."""
    notes, moved = [], dict[str, int]()
    for _, kind, value in _objects(document):
        for key in value.keys() - set(KEYS[kind]) if kind == "parts" else value:
            if kind == "parts":
                shapes = isinstance(value[key], list) and any(isinstance(one, dict | list) for one in value[key])
                moved[key] = moved.get(key, 0) + (shapes or _MOVES.fullmatch(key) is not None)
            elif key not in KEYS[kind]:
                notes.append(Note("warning", f"nothing reads the key '{key}' of {'the sheet' if kind else 'the file'}"))
    if keys := ", ".join(f"'{key}' ({count})" for key, count in sorted(moved.items()) if count):
        told = f"of parts, {keys} are attributes for rules alone: vertices say what is cut and where"
        notes.append(Note("warning", f"{told}, quantity how many are wanted"))
    return notes


_MOVES = re.compile(
    r"(d?[xy]|pos(ition)?|offset|translat(e|ion)|rot(at(e|ion)|ated)?|angle|scaled?|mirror(ed)?|flip(ped)?|transform"
    r"|matrix|units?|qty|count|copies|pcs|pieces)([_-]?(mm|deg|x|y))?",
    re.IGNORECASE,
)
"""Keys by which other programs say where a part lies, how large it is, and how many are wanted."""


def _refusal(found: list[tuple[list[str | int], str]], text: str, ids: list[object]) -> InputError:
    """One error for all the mismatches, in the order of the file where that is known."""
    at = places(text, [path for path, _ in found])
    order = sorted(range(len(found)), key=lambda k: (at[k][0] or 0, at[k][1] or 0))
    (line, column), first = at[order[0]], found[order[0]]
    if len(found) == 1:
        return InputError(f"not a kerfwise-nest/1 file: {spoken(first[0], ids)}: {first[1]}", line=line, column=column)
    lines = [f" (line {at[k][0]})" if at[k][0] else "" for k in order]
    texts = [f"{spoken(found[k][0], ids)}{where}: {found[k][1]}" for k, where in zip(order, lines, strict=True)]
    return InputError("not a kerfwise-nest/1 file", line=line, column=column, details=tuple(texts))


def _plain_but_for_parts(document: object) -> bool:
    """True for a nest on a rectangle that the schema has nothing to say about, but of its parts."""
    if not isinstance(document, dict) or not document.keys().isdisjoint(("scrap", "bridges")):
        return False
    sheet = document.get("sheet")
    if document.get("format") != FORMAT or document.get("units", "mm") not in ("mm", "cm", "m", "in", "ft"):
        return False
    if not isinstance(sheet, dict) or sheet.keys() != {"width", "height"} or not isinstance(document["parts"], list):
        return False
    return all(type(x) in (int, float) and 0 < x <= LIMIT_MM for x in sheet.values())


def _plain(part: object) -> bool:
    """True for a part that the schema has nothing to say about."""
    if not _has_plain_rings(part) or not isinstance(part, dict) or not isinstance(part.get("id"), str):
        return False
    if not part["id"] or "tabs" in part or "bevel" in part:
        return False
    if not part.keys().isdisjoint(("quantity", "due")):
        return False
    priority, thickness = part.get("priority", 1), part.get("thickness", 1)
    numbers = all(type(number) in (int, float) for number in (priority, thickness)) and priority >= 0 < thickness
    return numbers and all(isinstance(part.get(key, ""), str) for key in KEYS["parts"][-5:])


def _has_plain_rings(part: object) -> bool:
    if not isinstance(part, dict):
        return False
    many = [part.get(key, []) for key in ("holes", "marks")]
    return _plain_ring(part.get("outer")) and all(isinstance(m, list) and all(map(_plain_ring, m)) for m in many)


def _short(part: Any) -> Any:
    """A part with a few of its vertices, where they are plain: the schema says of all the same."""
    if not _has_plain_rings(part):
        return part
    return {**part, "outer": part["outer"][:FEW], **{key: [] for key in ("holes", "marks") if key in part}}


def _plain_ring(rows: object) -> bool:
    return isinstance(rows, list) and len(rows) >= 2 and all(map(_plain_vertex, rows))


def _plain_vertex(row: object) -> bool:
    if not isinstance(row, list) or not 2 <= len(row) <= 3:
        return False
    return all(type(x) in (int, float) and -LIMIT_MM <= x <= LIMIT_MM for x in row)


def nest_json(nest: Nest) -> str:
    """The nest as kerfwise-nest/1, a part a line."""
    rows = ",\n  ".join(json.dumps(_part_data(part), ensure_ascii=False) for part in nest.parts)
    sheet = json.dumps(_sheet_data(nest.sheet))
    scrap = json.dumps([_open(line.curve) for line in nest.scrap])
    more = f',\n "scrap": {scrap}' if nest.scrap else ""
    return f'{{"format": "kerfwise-nest/1", "units": "mm",\n "sheet": {sheet},\n "parts": [\n  {rows}\n ]{more}}}\n'


def _part_data(part: Part) -> dict[str, Any]:
    source = part.outer.source
    drawn = {"layer": source.layer, "colour": source.colour, "block": source.block}
    attributes = {key: value for key, value in drawn.items() if value} | part.attributes
    entry: dict[str, Any] = {"id": part.id, **attributes, "outer": part.outer.curve.as_rows()}
    if part.holes:
        entry["holes"] = [hole.curve.as_rows() for hole in part.holes]
    if part.marks:
        entry["marks"] = [_open(mark.curve) for mark in part.marks]
    if part.tabs:
        entry["tabs"] = [{"at": tab.at, **({"width": tab.width_mm} if tab.width_mm else {})} for tab in part.tabs]
    contours = (("outer", part.outer), *((f"hole{k}", hole) for k, hole in enumerate(part.holes, 1)))
    bevels = [{"of": of, **row} for of, contour in contours for row in _bevels(contour)]
    return entry | ({"bevel": bevels} if bevels else {})


def _bevels(contour: Contour) -> Iterator[dict[str, Any]]:
    """The bevels of a contour as a nest file has them, those of single edges with the numbers of their vertices."""
    if contour.bevel is not None:
        yield contour.bevel.as_json()
    each = contour.bevel_of_edge if contour.edge_bevels else ()
    for bevel in dict.fromkeys(one for one in each if one is not None):
        yield bevel.as_json() | {"edges": [k for k, one in enumerate(each, 1) if one == bevel]}


def _open(curve: Curve) -> list[list[float]]:
    """A mark's rows; one that closes ends where it began."""
    rows = curve.as_rows()
    return [*rows, rows[0][:2]] if curve.closed else rows


def _sheet_data(sheet: Sheet) -> dict[str, Any]:
    x0, y0, x1, y1 = sheet.bounds
    if not sheet.holes and (x0, y0) == (0, 0) and sheet.polygon.area == x1 * y1:
        return {"width": x1, "height": y1}
    return {
        "outline": sheet.outline.as_rows(),
        **({"holes": [h.as_rows() for h in sheet.holes]} if sheet.holes else {}),
    }


_DXF_IN_MM = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n9\n$MEASUREMENT\n70\n1\n0\nENDSEC\n"


def dxf_in_mm(text: str) -> str:
    """A DXF without a header, with one that says that it is in millimetres: who reads it does not have to ask.

    Examples
    --------
    >>> dxf_in_mm("0\\nSECTION\\n2\\nENTITIES\\n").count("SECTION")
    2
    """
    return _DXF_IN_MM + text
