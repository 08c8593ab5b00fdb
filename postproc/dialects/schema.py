"""The JSON Schema of a dialect: `python -m kerfwise.postproc.dialects.schema > postproc/dialects/dialect.schema.json`.

It gives editors completion and a first check; the reader of dialects checks the same and more, with better words.
"""

from __future__ import annotations

import dataclasses
import json
import sys

from kerfwise.rules.options.option import options_of

from .dialect import Dialect


def schema_text() -> str:
    """The schema, made from the same declarations that dialects are read with, as the text of its file."""
    keys = options_of(Dialect)
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kerfwise dialect",
        "description": "How one family of controls wants its program spelt.",
        "type": "object",
        "properties": {key.key: {"description": key.help, **key.kind.schema()} for key in keys},
        "required": [key.key for key in keys if key.default is dataclasses.MISSING],
        "additionalProperties": False,
    }
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())
