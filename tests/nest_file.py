"""Nest files of a few parts, for tests that begin at the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def nest_file(path: Path | str, parts: list[dict[str, Any]], size: tuple[float, float] = (400, 140)) -> Path:
    """A kerfwise-nest/1 file of parts such as `{"id": "P1", "outer": rows, "holes": [rows]}`."""
    sheet = {"width": size[0], "height": size[1]}
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}
    path = Path(path)
    path.write_text(json.dumps(nest), encoding="utf-8")
    return path
