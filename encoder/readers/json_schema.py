"""The published JSON Schema of kerfwise-nest/1, and its complaints in words."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from itertools import islice
from typing import TYPE_CHECKING

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.json_words import said

from .json_place import places, spoken
from .limits import LIMIT_MM

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator

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
    """Hold a parsed file against the schema.

    A part whose rings are rows of plain numbers is known to pass and is not shown to the schema, which would take
    minutes over the vertices of a large nest. Where the rest of the file is as plain, the schema is not even loaded.

    Raises
    ------
    InputError
        With a line for each mismatch (the first twenty), naming part, contour, vertex and line.
    """
    if _plain_nest(document):
        return
    shown, ids, numbers = document, [], []
    if isinstance(document, dict) and isinstance(document.get("parts"), list):
        parts = document["parts"]
        ids = [p.get("id") if isinstance(p, dict) else None for p in parts]
        numbers = [k for k, p in enumerate(parts) if not _plain(p)]
        shown = {**document, "parts": [parts[k] for k in numbers] or [_short(part) for part in parts[:1]]}
    found: list[tuple[list[str | int], str]] = []
    for error in islice(validator().iter_errors(shown), MOST_ERRORS):
        path = list(error.absolute_path)
        if len(path) > 1 and path[0] == "parts":
            path[1] = numbers[int(path[1])]
        found.append((path, said(error)))
    if found:
        raise _refusal(found, text, ids)


def _refusal(found: list[tuple[list[str | int], str]], text: str, ids: list[object]) -> InputError:
    """One error for all the mismatches, in the order of the file where that is known."""
    at = places(text, [path for path, _ in found])
    order = sorted(range(len(found)), key=lambda k: (at[k][0] or 0, at[k][1] or 0))
    (line, column), first = at[order[0]], found[order[0]]
    if len(found) == 1:
        return InputError(f"not a kerfwise-nest/1 file: {spoken(first[0], ids)}: {first[1]}", line=line, column=column)
    lines = [f" (line {at[k][0]})" if at[k][0] else "" for k in order]
    said = [f"{spoken(found[k][0], ids)}{where}: {found[k][1]}" for k, where in zip(order, lines, strict=True)]
    return InputError("not a kerfwise-nest/1 file", line=line, column=column, details=tuple(said))


def _plain_nest(document: object) -> bool:
    """True for a nest on a rectangle, of plain parts, that the schema has nothing to say about."""
    if not isinstance(document, dict) or not document.keys() <= {"format", "units", "sheet", "parts"}:
        return False
    sheet, parts = document.get("sheet"), document.get("parts")
    if document.get("format") != FORMAT or document.get("units", "mm") not in ("mm", "cm", "m", "in", "ft"):
        return False
    if not isinstance(sheet, dict) or sheet.keys() != {"width", "height"} or not isinstance(parts, list):
        return False
    sized = all(type(x) in (int, float) and 0 < x <= LIMIT_MM for x in sheet.values())
    return sized and all(map(_plain, parts))


def _plain(part: object) -> bool:
    """True for a part that the schema has nothing to say about."""
    if not isinstance(part, dict) or not isinstance(part.get("id"), str) or not part["id"] or "tabs" in part:
        return False
    many = [part.get(key, []) for key in ("holes", "marks")]
    return _plain_ring(part.get("outer")) and all(isinstance(m, list) and all(map(_plain_ring, m)) for m in many)


def _short(part: dict[str, object]) -> dict[str, object]:
    """A plain part with a few of its vertices: the schema says of all the same."""
    outer = part["outer"]
    assert isinstance(outer, list)
    return {**part, "outer": outer[:FEW], **{key: [] for key in ("holes", "marks") if key in part}}


def _plain_ring(rows: object) -> bool:
    return isinstance(rows, list) and len(rows) >= 2 and all(map(_plain_vertex, rows))


def _plain_vertex(row: object) -> bool:
    if not isinstance(row, list) or not 2 <= len(row) <= 3:
        return False
    return all(type(x) in (int, float) and -LIMIT_MM <= x <= LIMIT_MM for x in row)
