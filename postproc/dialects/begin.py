"""A plant's own dialect, begun as a copy of another."""

from __future__ import annotations

import re

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.yaml_edit import with_value

from .load import dialect_text, parse_dialect

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,60}")


def begun(name: str, like: str) -> str:
    """The file of the dialect `like` under another name, with nothing that verified it: what is changed nobody read.

    Raises
    ------
    InputError
        For a name that no dialect can have, and where `like` cannot be read.

    Examples
    --------
    >>> [row for row in begun("shop", "grbl").splitlines() if row.startswith(("name", "verified"))]
    ['name: shop', 'verified_by: []']
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be a dialect's name: expected letters, digits, dots and dashes")
    text = dialect_text(like)
    parse_dialect(text, like)
    text = with_value(text, ["name"], name)
    if "verified_by" in yaml.safe_load(text):
        text = with_value(text, ["verified_by"], "[]")
    return f"# Begun as a copy of {like}. Change what differs; `kerfwise profile check` reads it back.\n{text}"
