"""What nests use and leave: a row a sheet and a row a part, for the terminal, as JSON and as CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from kerfwise.encoder.shown import shown
from kerfwise.nesting.left_over import largest_rectangle

from .run import Nested

FORMAT = "kerfwise-nests/1"


@dataclass(frozen=True, slots=True)
class SheetUse:
    """One sheet: its file, what it is of, and how much of it is parts; `remnant` is the largest rectangle left."""

    file: str
    stock: str
    width_mm: float
    height_mm: float
    parts: int
    use: float
    waste_mm2: float
    remnant_width_mm: float
    remnant_height_mm: float
    price: float | None


@dataclass(frozen=True, slots=True)
class PartUse:
    """One part type: how many were wanted, and how many are on no sheet."""

    part: str
    order: str
    wanted: int
    placed: int
    missing: int


def sheet_uses(nested: Nested) -> list[SheetUse]:
    """A row a sheet."""
    layout = nested.layout
    rows = []
    for name, sheet in zip(nested.names, layout.sheets, strict=True):
        x0, y0, x1, y1 = sheet.stock.sheet.bounds
        metal_mm2, whole_mm2 = sheet.metal_mm2(layout.wanted), sheet.stock.area_mm2
        a0, b0, a1, b1 = largest_rectangle(sheet.stock.sheet, layout.metal_of(sheet), layout.spacing.gap_mm)
        size = (round(x1 - x0, 3), round(y1 - y0, 3))
        left = (round(a1 - a0, 1), round(b1 - b0, 1))
        use, waste_mm2 = round(metal_mm2 / whole_mm2, 4), round(whole_mm2 - metal_mm2, 1)
        stock, parts = sheet.stock, len(sheet.placed)
        rows.append(SheetUse(f"{name}.json", stock.name, *size, parts, use, waste_mm2, *left, stock.price))
    return rows


def part_uses(nested: Nested) -> list[PartUse]:
    """A row a part type."""
    return [
        PartUse(kind.name, kind.order, kind.quantity, kind.quantity - missing, missing)
        for kind, missing in zip(nested.layout.wanted.types, nested.layout.missing, strict=True)
    ]


def as_json(nested: Nested, **about: Any) -> str:
    """Both tables, and what they were made with."""
    spacing = nested.layout.spacing
    data = {
        "format": FORMAT,
        **about,
        "gap_mm": spacing.gap_mm,
        "edge_mm": spacing.edge_mm,
        "use": round(use_of_all(nested), 4),
        "sheets": [asdict(row) for row in sheet_uses(nested)],
        "parts": [asdict(row) for row in part_uses(nested)],
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def as_csv(nested: Nested) -> str:
    """The rows of the sheets."""
    text = io.StringIO(newline="")
    rows = [asdict(row) for row in sheet_uses(nested)]
    writer = csv.DictWriter(text, list(SheetUse.__dataclass_fields__), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def use_of_all(nested: Nested) -> float:
    """Metal of all parts laid, of that of all sheets taken."""
    layout = nested.layout
    whole = sum(sheet.stock.area_mm2 for sheet in layout.sheets)
    return sum(sheet.metal_mm2(layout.wanted) for sheet in layout.sheets) / whole if whole else 0.0


def as_text(nested: Nested) -> str:
    """For the terminal."""
    return "\n".join(_lines(nested))


def _lines(nested: Nested) -> Iterator[str]:
    rows = sheet_uses(nested)
    width = max([5, *(len(shown(row.stock)) for row in rows)])
    yield f"{'sheet':12} {'stock':{width}} {'parts':>6} {'use':>7} {'waste m²':>9} {'left mm':>15}"
    for row in rows:
        left = f"{row.remnant_width_mm:.0f} × {row.remnant_height_mm:.0f}" if row.remnant_width_mm else "–"
        waste_m2 = row.waste_mm2 / 1e6
        yield f"{row.file:12} {shown(row.stock):{width}} {row.parts:6} {row.use:7.1%} {waste_m2:9.3f} {left:>15}"
    parts = part_uses(nested)
    placed = sum(row.placed for row in parts)
    spacing = nested.layout.spacing
    yield (
        f"{placed} of {sum(row.wanted for row in parts)} parts on {len(rows)} sheet{'s' if len(rows) != 1 else ''}, "
        f"{use_of_all(nested):.1%} used; {spacing.gap_mm:g} mm between parts, {spacing.edge_mm:g} mm to the edge"
    )
    for part in parts:
        if part.missing:
            yield f"did not fit: {part.missing} of {part.wanted} {shown(part.part)}"
