"""The published JSON Schema of kerfwise-nest/1, and its complaints in words."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from jsonschema import Draft202012Validator, ValidationError

from ..errors import InputError
from .json_place import line_and_column, spoken
from .limits import LIMIT_MM

MOST_ERRORS = 20
NAMES = {"object": "an object", "array": "a list", "string": "a text", "number": "a number"}
SOUND_PART: dict[str, object] = {"id": "P", "outer": [[0, 0], [1, 1]]}


@cache
def validator() -> Draft202012Validator:
    """The validator of the schema beside this file."""
    schema = json.loads((files(__package__) / "nest.schema.json").read_text(encoding="utf-8"))
    return Draft202012Validator(schema)


def check_schema(document: object, text: str) -> None:
    """Hold a parsed file against the schema.

    A part whose rings are rows of plain numbers is known to pass: the schema sees a small one in its place, as it
    would take a minute over the vertices of a large nest.

    Raises
    ------
    InputError
        With a line for each mismatch (the first twenty), naming part, contour, vertex and line.
    """
    shown, ids = document, []
    if isinstance(document, dict) and isinstance(document.get("parts"), list):
        shown = {**document, "parts": [SOUND_PART if _plain(p) else p for p in document["parts"]]}
        ids = [p.get("id") if isinstance(p, dict) else None for p in document["parts"]]
    errors = sorted(validator().iter_errors(shown), key=lambda e: [str(step) for step in e.absolute_path])
    if not errors:
        return
    lines, first = [], line_and_column(text, list(errors[0].absolute_path))
    for error in errors[:MOST_ERRORS]:
        path = list(error.absolute_path)
        line, _ = line_and_column(text, path) if len(errors) > 1 else (None, None)
        where = spoken(path, ids) + (f" (line {line})" if line else "")
        lines.append(f"{where}: {_said(error)}")
    if len(errors) > MOST_ERRORS:
        lines.append(f"… and {len(errors) - MOST_ERRORS} more")
    if len(lines) == 1:
        raise InputError(f"not a kerfwise-nest/1 file: {lines[0]}", line=first[0], column=first[1])
    raise InputError("not a kerfwise-nest/1 file", line=first[0], column=first[1], details=tuple(lines))


def _plain(part: object) -> bool:
    """True for a part that the schema has nothing to say about."""
    if not isinstance(part, dict) or not isinstance(part.get("id"), str) or not part["id"]:
        return False
    many = [part.get(key, []) for key in ("holes", "marks")]
    return _plain_ring(part.get("outer")) and all(isinstance(m, list) and all(map(_plain_ring, m)) for m in many)


def _plain_ring(rows: object) -> bool:
    return isinstance(rows, list) and len(rows) >= 2 and all(map(_plain_vertex, rows))


def _plain_vertex(row: object) -> bool:
    if not isinstance(row, list) or not 2 <= len(row) <= 3:
        return False
    return all(type(x) in (int, float) and -LIMIT_MM <= x <= LIMIT_MM for x in row)


def _said(error: ValidationError) -> str:
    """The schema's complaint about one value, in the file's own terms."""
    given, bound = _short(error.instance), error.validator_value
    match error.validator:
        case "required":
            return error.message.replace(" is a required property", " missing")
        case "oneOf":
            return "expected either 'width' and 'height', or 'outline'"
        case "const":
            return f"{given} given, expected {bound!r}"
        case "enum" if isinstance(bound, list):
            return f"{given} given, expected one of {', '.join(bound)}"
        case "type":
            return f"{given} given, expected {NAMES[str(bound)]}"
        case "minItems" | "minLength" if not error.instance:
            return "nothing in it"
        case "minItems" | "maxItems":
            return (
                f"{given} given, expected {'at least' if error.validator == 'minItems' else 'at most'} {bound} of them"
            )
        case "minimum" | "maximum" | "exclusiveMinimum":
            words = {"minimum": "at least", "maximum": "at most", "exclusiveMinimum": "over"}
            return f"{given} given, expected {words[error.validator]} {bound}"
    return error.message


def _short(value: object) -> str:
    names: Mapping[type, str] = {dict: "an object", list: "a list"}
    if isinstance(value, list) and len(value) <= 3 and not any(isinstance(x, list | dict) for x in value):
        return json.dumps(value)
    text = names.get(type(value)) or json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "…"
