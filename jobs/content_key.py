"""Work that was done before is known again by its content: the bytes that it was made of, and all else that counts."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError

UNREADABLE = (OSError, ValueError, InputError)
"""What `contents` raises."""


def key_of(files: Iterable[Path], besides: Mapping[str, Any]) -> str:
    """The sha256 of files, their names among it, and of all that an answer depends on besides them.

    A file that cannot be read counts by its name: it is another one as soon as it can.

    Examples
    --------
    >>> [key_of([], {"work": work}) == key_of([], {"work": 30.0}) for work in (30.0, 20.0)]
    [True, False]
    """
    total = hashlib.sha256(json.dumps(besides, sort_keys=True).encode())
    for file in files:
        try:
            said = hashlib.sha256(contents(file)).hexdigest()
        except UNREADABLE:
            said = "cannot be read"
        total.update(f"\0{file.name}\0{said}".encode("utf-8", "surrogateescape"))
    return total.hexdigest()


def holds(path: Path, sha256: str) -> bool:
    """Whether a file is there and has the content of that sha256."""
    try:
        return hashlib.sha256(contents(path)).hexdigest() == sha256
    except UNREADABLE:
        return False
