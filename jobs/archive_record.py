"""What is finished of an archive: known again by its content, so that it is not planned a second time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import contents
from kerfwise.rules.profile.profile import Profile

from .archived import Row
from .content_key import UNREADABLE

RECORD = "resequence.json"
"""What is kept in the folder of the new programs, of what is finished there."""
_FORMAT = "kerfwise-resequence/1"


def besides_of(profile: Profile, options: Mapping[str, Any], version: str) -> dict[str, Any]:
    """All that answers depend on besides the program and the files of the profile."""
    of_profile = {"profile": profile.sha256, "machine": repr(profile.machine)}
    return {"version": version, **of_profile, **options, "asked": asdict(options["asked"])}


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
    except (*UNREADABLE, LookupError, TypeError, RecursionError):
        return {}


def record_of(record: Mapping[str, Row]) -> str:
    """The record as its file holds it."""
    rows = [asdict(record[name]) for name in sorted(record)]
    return json.dumps({"format": _FORMAT, "programs": rows}, indent=1) + "\n"
