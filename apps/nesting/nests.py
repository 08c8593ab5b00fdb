"""A request becomes nests, checked, tabulated, and written to their folder."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import as_cell, escape_text, json_lines
from kerfwise.encoder.files import is_file, is_folder, read_limited
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.encoder.scrap import largest_rectangle
from kerfwise.postproc.output_files import expect_place, make_folder, write_files
from kerfwise.postproc.report import draw

from .nest_check import CommonEdgeLimits, RequestedPart, RequestedSheet, RequestedSpacing, nest_faults
from .placement.demand import Demand, Spacing
from .placement.fill import too_large
from .placement.layout import Layout, nest_dxf, nests_of
from .placement.shapes import Shapes


@dataclass(frozen=True, eq=False, slots=True)
class Nested:
    """What came of an order: the layout, a nest and its text for each sheet, and what the check found wrong."""

    layout: Layout
    nests: tuple[Nest, ...]
    texts: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def names(self) -> list[str]:
        """What the nests are called: `sheet1`, `sheet2`…"""
        return [f"sheet{k}" for k in range(1, len(self.nests) + 1)]


def expect_room(wanted: Demand, spacing: Spacing) -> None:
    """Refuse an order with a part that fits on no sheet."""
    shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
    if never := too_large(wanted, shapes, spacing):
        raise InputError(
            f"{len(never)} of {len(wanted.types)} parts fit on no sheet, not even on an empty one, with "
            f"{spacing.edge_mm:g} mm to its edge",
            details=tuple(_size(wanted, kind) for kind in never),
        )


def _size(wanted: Demand, kind: int) -> str:
    part = wanted.types[kind]
    x0, y0, x1, y1 = part.part.outer.polygon.bounds
    return f"{part.name} is {x1 - x0:.1f} × {y1 - y0:.1f} mm: give a larger sheet, or allow other rotations"


def nests_from(layout: Layout) -> Nested:
    """A layout as nests, with what the check finds wrong in their texts."""
    nests = nests_of(layout)
    texts = [nest_json(nest) for nest in nests]
    faults = faults_of(texts, layout.wanted, layout.spacing, layout.missing)
    return Nested(layout, tuple(nests), tuple(texts), tuple(faults))


def faults_of(texts: Sequence[str], wanted: Demand, spacing: Spacing, missing: Sequence[int]) -> list[str]:
    """What the check finds wrong in nests of an order; it is told what the order was, and nothing of the layout."""
    parts = [
        RequestedPart(
            kind.name,
            kind.part,
            kind.quantity,
            None if kind.free else kind.turns_deg,
            kind.mirror,
            kind.quantity - lost,
        )
        for kind, lost in zip(wanted.types, missing, strict=True)
    ]
    sheets = [RequestedSheet(stock.name, stock.sheet, stock.count) for stock in wanted.stocks]
    written = {f"sheet{k}": text.encode() for k, text in enumerate(texts, 1)}
    common = spacing.common
    edges = None if common is None else CommonEdgeLimits(common.apart_mm, common.shortest_mm, common.tolerance_mm)
    return nest_faults(written, parts, sheets, RequestedSpacing(spacing.gap_mm, spacing.edge_mm, edges))


# What nests use and leave: a row a sheet and a row a part, for the terminal, as JSON and as CSV.

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
        "use": round(nested.layout.use, 4),
        "sheets": [asdict(row) for row in sheet_uses(nested)],
        "parts": [asdict(row) for row in part_uses(nested)],
    }
    return json_lines(data)


def as_csv(nested: Nested) -> str:
    """The rows of the sheets."""
    text = io.StringIO(newline="")
    rows = [asdict(row) for row in sheet_uses(nested)]
    writer = csv.DictWriter(text, list(SheetUse.__dataclass_fields__), lineterminator="\n")
    writer.writeheader()
    writer.writerows({column: as_cell(value) for column, value in row.items()} for row in rows)
    return text.getvalue()


def lines_of(nested: Nested) -> Iterator[str]:
    """For the terminal."""
    rows = sheet_uses(nested)
    width = max([5, *(len(escape_text(row.stock)) for row in rows)])
    yield f"{'sheet':12} {'stock':{width}} {'parts':>6} {'use':>7} {'waste m²':>9} {'left mm':>15}"
    for row in rows:
        left = f"{row.remnant_width_mm:.0f} × {row.remnant_height_mm:.0f}" if row.remnant_width_mm else "–"
        waste_m2 = row.waste_mm2 / 1e6
        yield f"{row.file:12} {escape_text(row.stock):{width}} {row.parts:6} {row.use:7.1%} {waste_m2:9.3f} {left:>15}"
    parts = part_uses(nested)
    placed = sum(row.placed for row in parts)
    spacing = nested.layout.spacing
    yield (
        f"{placed} of {sum(row.wanted for row in parts)} parts on {len(rows)} sheet{'s' if len(rows) != 1 else ''}, "
        f"{nested.layout.use:.1%} used; {spacing.gap_mm:g} mm between parts, {spacing.edge_mm:g} mm to the edge"
    )
    for part in parts:
        if part.missing:
            yield f"did not fit: {part.missing} of {part.wanted} {escape_text(part.part)}"


# The files of a set of nests in their folder, and what an earlier run left there.

TABLE, ROWS = "nests.json", "nests.csv"
_FILES = "files"


def expect_folder(out: Path) -> None:
    """Say before the work that a folder cannot be that of nests: it is a file, or holds files of others.

    Raises InputError with what to do.
    """
    expect_place(out)
    if not is_folder(out):
        return
    files, folders = written_before(out)
    own = {TABLE, *files, *folders}
    others = sorted(path.name for path in out.iterdir() if path.name[0] != "." and path.name not in own)
    if others:
        raise InputError(
            f"holds files that kerfwise nest did not write, such as {others[0]}: give an empty folder with -o", file=out
        )


def nest_files(nested: Nested, picture: str, dxf: bool) -> dict[str, str | bytes]:
    """The nests and their pictures by the names that they have: `picture` is how the names of these end."""
    files: dict[str, str | bytes] = {}
    for name, nest, text in zip(nested.names, nested.nests, nested.texts, strict=True):
        files[f"{name}.json"] = text
        files[f"{name}{picture}"] = draw(replace(nest, file=f"{name}.json"), None, Path(picture).suffix or picture)
        if dxf:
            files[f"{name}.dxf"] = nest_dxf(nest)
    return files


def write_nests(out: Path, nested: Nested, files: Mapping[str, str | bytes], **about: Any) -> list[Path]:
    """Write these files and the table, or none; those of an earlier run that are not made again are removed.

    Returns
    -------
    The files, the table last.
    """
    all_files = {**files, ROWS: as_csv(nested)}
    all_files[TABLE] = as_json(nested, **about, **{_FILES: list(all_files)})
    make_folder(out)
    before = written_before(out)
    write_files({out / name: content for name, content in all_files.items()})
    remove_earlier(out, before, set(all_files), ())
    return [out / name for name in all_files]


def remove_earlier(out: Path, before: Before, names: AbstractSet[str], folders: Collection[str]) -> None:
    """Remove what an earlier run wrote in a folder, and is not made again."""
    files, groups = before
    for name in sorted(files - names):
        (out / name).unlink(missing_ok=True)
    for name in sorted(groups - set(folders)):
        remove_earlier(out / name, written_before(out / name), set(), ())
        (out / name / TABLE).unlink(missing_ok=True)
        if is_folder(out / name) and not any((out / name).iterdir()):
            (out / name).rmdir()


def _plain_names(names: Sequence[object]) -> set[str]:
    return {name for name in names if isinstance(name, str) and Path(name).name == name}


Before = tuple[set[str], set[str]]


def written_before(out: Path) -> Before:
    """Names of the files that an earlier run wrote, and of the folders of its groups."""
    table = out / TABLE
    if not is_file(table):
        return set(), set()
    try:
        data: Mapping[str, Any] = json.loads(read_limited(table))
        known = data.get("format") == FORMAT
        files, folders = (data.get(key, []) if known else [] for key in (_FILES, "groups"))
        return _plain_names(files), _plain_names(folders)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return set(), set()
