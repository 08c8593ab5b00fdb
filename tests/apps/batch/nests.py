"""A folder of ten small nests, of which two are broken."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

BROKEN = ("more/overlapping", "off the sheet")


def plate(width: float, parts: dict[str, tuple[float, float, float, float]], hole_mm: float = 0.0) -> dict[str, Any]:
    """Rectangles (x, y, width, height) on a sheet 200 mm high; each has a round hole of that radius."""
    rows = []
    for name, (x, y, w, h) in parts.items():
        outer = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
        cx, cy = x + w / 2, y + h / 2
        hole = [[cx - hole_mm, cy, 1.0], [cx + hole_mm, cy, 1.0]]
        rows.append({"id": name, "outer": outer, "holes": [hole] if hole_mm else []})
    return {"format": "kerfwise-nest/1", "sheet": {"width": width, "height": 200.0}, "parts": rows}


def row_of(count: int, size_mm: float, hole_mm: float = 0.0) -> dict[str, Any]:
    """So many squares in a row."""
    squares = {f"P{k}": (20 + k * (size_mm + 15), 40.0, size_mm, size_mm) for k in range(1, count + 1)}
    return plate(60 + (count + 1) * (size_mm + 15), squares, hole_mm)


NESTS: dict[str, dict[str, Any]] = {
    "one": row_of(1, 80),
    "two": row_of(2, 60),
    "two with holes": row_of(2, 60, 12),
    "three": row_of(3, 50),
    "three with holes": row_of(3, 70, 15),
    "more/one": row_of(1, 100, 20),
    "more/four": row_of(4, 40),
    "more/stacked": plate(200, {"A": (20, 20, 120, 60), "B": (20, 100, 120, 60)}, 10),
    "more/overlapping": plate(200, {"A": (20, 20, 100, 60), "B": (60, 40, 100, 60)}),
    "off the sheet": plate(200, {"A": (150, 20, 100, 60)}),
}


def write_nests(folder: Path, names: tuple[str, ...] = tuple(NESTS)) -> Path:
    """The nests as files under a folder, which is made."""
    for name in names:
        file = folder / f"{name}.json"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(NESTS[name]), encoding="utf-8")
    return folder
