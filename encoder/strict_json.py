"""JSON as strict as the profiles' YAML: a key given twice is refused with both places, and foreign text is shown."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from .errors import InputError
from .shown import shown

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\],:]', re.DOTALL)


class _Twice(Exception):
    """A key is given twice."""


def strict_json(text: str) -> Any:
    """The value of a JSON text, `NaN` and the like as texts, every text in it in one line (see `shown`).

    Raises
    ------
    InputError
        If an object has a key twice: with the line and column of the second, and those of the first in words.
    ValueError, RecursionError
        As `json.loads` does.

    Examples
    --------
    >>> strict_json('{"id": "A", "outer": [NaN]}')
    {'id': 'A', 'outer': ['NaN']}
    >>> strict_json('{"id": "A",\\n "id": "B"}')
    Traceback (most recent call last):
    kerfwise.encoder.errors.InputError: 2:2: the key 'id' is given twice, first in line 1, column 2: leave one of them
    """
    try:
        value = json.loads(text, parse_constant=str, object_pairs_hook=_object)
    except _Twice:
        raise _refusal(text) from None
    return _shown(value)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        raise _Twice
    return {shown(key): _shown(value) for key, value in pairs}


def _shown(value: Any) -> Any:
    """Texts in one line; lists of texts as well, objects are seen to already."""
    if isinstance(value, str):
        return shown(value)
    if isinstance(value, list) and any(isinstance(member, str | list) for member in value):
        return [_shown(member) for member in value]
    return value


def _refusal(text: str) -> InputError:
    for key, first, again in _keys_twice(text):
        line, column = _place(text, first)
        message = f"the key '{key}' is given twice, first in line {line}, column {column}: leave one of them"
        at = _place(text, again)
        return InputError(message, line=at[0], column=at[1])
    return InputError("a key is given twice: leave one of them")


def _keys_twice(text: str) -> Iterator[tuple[str, int, int]]:
    """Keys that an object has twice, and where they begin: counted in characters from 0."""
    seen: list[dict[str, int] | None] = []
    last: re.Match[str] | None = None
    for token in _TOKEN.finditer(text):
        sign = token.group()
        if sign in "{[":
            seen.append({} if sign == "{" else None)
        elif sign in "}]" and seen:
            seen.pop()
        elif sign == ":" and last is not None and seen and (keys := seen[-1]) is not None:
            key = json.loads(last.group())
            if keys.setdefault(key, last.start()) != last.start():
                yield key, keys[key], last.start()
        last = token if sign.startswith('"') else None


def _place(text: str, at: int) -> tuple[int, int]:
    before = text[:at]
    return before.count("\n") + 1, at - (before.rfind("\n") + 1) + 1
