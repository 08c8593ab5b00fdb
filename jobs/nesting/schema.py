"""The JSON Schema of a list of parts: `python -m kerfwise.jobs.nesting.schema > jobs/nesting/parts.schema.json`."""

from __future__ import annotations

import json
import sys
from typing import Any

from kerfwise.rules.options.kind import OptionKind, Text
from kerfwise.rules.options.option import options_of

from .request import PartRow, SheetRow

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
