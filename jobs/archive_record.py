"""What is finished of an archive: known again by its content, so that it is not planned a second time."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.made_of import files_of
from kerfwise.rules.profile.profile import Profile

from .archived import Row

RECORD = "resequence.json"
"""What is kept in the folder of the new programs, of what is finished there."""
_FORMAT = "kerfwise-resequence/1"
_UNREADABLE = (OSError, ValueError, InputError)
"""What `contents` raises."""


def besides_of(profile: Profile, options: Mapping[str, Any], version: str) -> bytes:
    """All that answers depend on besides the program."""
    said = json.dumps({**options, "asked": asdict(options["asked"])}, sort_keys=True)
    parts = [part.encode() for part in (version, profile.sha256, repr(profile.machine), said)]
    for file in files_of(profile):  # a dialect's, above all
        with contextlib.suppress(*_UNREADABLE):
            parts.append(contents(file))
    return b"\0".join(parts)


def key_of(path: Path, besides: bytes) -> str:
    """The sha256 of a program and of all else that its answer depends on; of its name where it cannot be read."""
    try:
        data = contents(path)
    except _UNREADABLE:
        data = str(path).encode("utf-8", "surrogateescape")
    return hashlib.sha256(b"\0".join([data, besides])).hexdigest()


def is_there(path: Path, sha256: str) -> bool:
    """Whether a file is there, and as it was."""
    try:
        return hashlib.sha256(contents(path)).hexdigest() == sha256
    except _UNREADABLE:
        return False


def recorded(out: Path) -> dict[str, Row]:
    """What was finished before; nothing where the record is gone, or is none."""
    try:
        data = json.loads(contents(out / RECORD))
        if data["format"] != _FORMAT:
            return {}
        return {
            row["name"]: Row(**{**row, "idle_mm": tuple(row["idle_mm"]), "time_s": tuple(row["time_s"])})
            for row in data["programs"]
        }
    except (*_UNREADABLE, LookupError, TypeError, RecursionError):
        return {}


def record_of(record: Mapping[str, Row]) -> str:
    """The record as its file holds it."""
    rows = [asdict(record[name]) for name in sorted(record)]
    return json.dumps({"format": _FORMAT, "programs": rows}, indent=1) + "\n"
