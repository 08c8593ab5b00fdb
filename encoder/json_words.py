"""What a JSON Schema has against a value, in the words of the file's author."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jsonschema import ValidationError

NAMES = {
    "object": "an object",
    "array": "a list",
    "string": "a text",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
}


def said(error: ValidationError) -> str:
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
            return f"{given} given, expected {_types(bound)}"
        case "minItems" | "minLength" if not error.instance:
            return "nothing in it"
        case "minItems" | "maxItems" if isinstance(error.instance, list):
            words = {"minItems": "at least", "maxItems": "at most"}
            return f"{len(error.instance)} given, expected {words[error.validator]} {bound}"
        case "minimum" | "maximum" | "exclusiveMinimum":
            words = {"minimum": "at least", "maximum": "at most", "exclusiveMinimum": "over"}
            return f"{given} given, expected {words[error.validator]} {bound}"
    return error.message


def _types(bound: object) -> str:
    words = [bound] if isinstance(bound, str) else bound if isinstance(bound, list) else []
    return " or ".join(NAMES.get(word, "null") for word in words)


def _short(value: object) -> str:
    names: Mapping[type, str] = {dict: "an object", list: "a list"}
    if isinstance(value, list) and len(value) <= 3 and not any(isinstance(x, list | dict) for x in value):
        return json.dumps(value)
    text = names.get(type(value)) or json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "…"
