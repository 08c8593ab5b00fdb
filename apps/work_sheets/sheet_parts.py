"""The parts of a sheet as people count them: kinds with order, size and weight, and a label for each copy."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kerfwise.apps.work_sheets.paper import Paper, qr_items, shortened
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_file, read_limited
from kerfwise.encoder.nest import PART_TYPE, Nest, Part
from kerfwise.encoder.scrap import largest_rectangle
from kerfwise.jobs.inputs import attribute_text
from kerfwise.languages import ENGLISH, ENGLISH_TEXTS, Texts, texts
from kerfwise.postproc.report.plot import A4, pdf_bytes
from kerfwise.postproc.report.scene import FAINT, INK, Scene, SceneLayer, Shape, Style, TextLine
from kerfwise.rules.profile.plant_sections import MATERIALS
from kerfwise.rules.profile.values import ProfileValues


@dataclass(frozen=True, slots=True)
class PartKind:
    """Copies of a part for one order: how many are on the sheet, their size as they lie, mm, and weight of one, kg."""

    name: str
    order: str
    due: str
    count: int
    width_mm: float
    height_mm: float
    weight_kg: float


def part_kinds(nest: Nest, profile: ProfileValues) -> list[PartKind]:
    """The parts of a nest by kind, order and due date, as they come first in it.

    Copies of a list of parts are of one kind; else each part is by itself.
    """
    per_mm2 = profile.material.thickness_mm * MATERIALS[profile.heat.material].density * 1e-9
    found: dict[tuple[str, str, str], list[Part]] = {}
    for part in (nest.drawn or nest).parts:
        found.setdefault((kind_of(part), attribute_text(part, "order"), attribute_text(part, "due")), []).append(part)
    rows = []
    for (name, order, due), parts in found.items():
        x0, y0, x1, y1 = parts[0].outer.polygon.bounds
        weight_kg = float(parts[0].polygon.area) * per_mm2
        rows.append(PartKind(name, order, due, len(parts), x1 - x0, y1 - y0, weight_kg))
    return rows


def kind_of(part: Part) -> str:
    """What a part is a copy of, as its nest says; else its own name."""
    return attribute_text(part, PART_TYPE) or part.id


def left_of(nest: Nest, gap_mm: float) -> tuple[float, float]:
    """Width and height of the largest rectangle along a side of the sheet that no part reaches; 0 for none."""
    x0, y0, x1, y1 = largest_rectangle(nest.sheet, [part.outer.polygon for part in nest.parts], gap_mm)
    return x1 - x0, y1 - y0


_TABLE = "nests.json"
_NUMBER = re.compile(r"sheet(\d+)")


def sheet_number(nest: str | Path, say: Texts = ENGLISH_TEXTS) -> str:
    """Which sheet of a list a nest is, such as `sheet 2 of 3`, by the table beside its file; "" where none says it."""
    path, table = Path(nest), Path(nest).parent / _TABLE
    found = _NUMBER.fullmatch(path.stem)
    if found is None or not is_file(table):
        return ""
    try:
        data: Any = json.loads(read_limited(table))
        count = len(data["sheets"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""
    return sheet_of(int(found[1]), count, say) if 1 <= int(found[1]) <= count else ""


def sheet_of(number: int, count: int, say: Texts = ENGLISH_TEXTS) -> str:
    """Which of so many sheets."""
    return say.tr("sheet {number} of {count}").format(number=number, count=count)


# Labels: one for each copy, 3 × 8 on a sheet of A4, with a code that names part, order and sheet.

_COLUMNS, _ROWS = 3, 8
_EDGE = 14.0
_CODE = 62.0


def labels_pdf(nests: Sequence[tuple[Nest, ProfileValues]], language: str = ENGLISH) -> bytes:
    """A label for each part of each nest, in one PDF; the same nests give the same bytes."""
    labels = [label for nest, profile in nests for label in _labels(nest, profile, texts(language))]
    pages = [
        _page(labels[first : first + _COLUMNS * _ROWS]) for first in range(0, max(len(labels), 1), _COLUMNS * _ROWS)
    ]
    return pdf_bytes(pages, "labels")


@dataclass(frozen=True, slots=True)
class _Label:
    title: str
    lines: tuple[str, ...]
    code: str


def _labels(nest: Nest, profile: ProfileValues, say: Texts) -> Iterator[_Label]:
    material, tr = profile.material, say.tr
    weights = {(row.name, row.order, row.due): row.weight_kg for row in part_kinds(nest, profile)}
    sheet = Path(nest.file or "nest").name
    for part in (nest.drawn or nest).parts:
        order, due = attribute_text(part, "order"), attribute_text(part, "due")
        weight_kg = weights[kind_of(part), order, due]
        lines = (
            tr("order {order}").format(order=order) if order else "",
            tr("due {due}").format(due=due) if due else "",
            f"{material.name}, {material.thickness_mm:g} mm",
            tr("{weight} kg").format(weight=f"{weight_kg:.3g}"),
            sheet,
        )
        code = ";".join((part.id, order, due, material.name, f"{material.thickness_mm:g}", sheet))
        yield _Label(part.id, tuple(filter(None, lines)), code)


def _page(labels: Sequence[_Label]) -> Scene:
    width, height = A4
    wide, high = (width - 2 * _EDGE) / _COLUMNS, (height - 2 * _EDGE) / _ROWS
    paper = Paper("labels")
    for k, label in enumerate(labels):
        x, y = _EDGE + wide * (k % _COLUMNS), _EDGE + high * (k // _COLUMNS)
        paper.put(qr_items(label.code, x + wide - _CODE - 10, y + 10, _CODE))
        room = wide - _CODE - 24
        title = shortened(escape_text(label.title), 11.0, room)
        paper.put([TextLine(x + 8, y + 16, title, 11.0, INK, "start", bold=True)])
        for n, line in enumerate(label.lines):
            text = shortened(escape_text(line), 8.0, room)
            paper.put([TextLine(x + 8, y + 32 + 11 * n, text, 8.0, INK if n == 0 else FAINT, "start")])
    (scene,) = paper.scenes()
    return Scene(width, height, (SceneLayer("labels", scene.layers[0].items[:-2]),), "labels")


# Where the machine's zero lies on the sheet, as a small sketch.


def zero_sketch(nest: Nest, zero: tuple[float, float], x: float, y: float, size: float) -> Iterator[Any]:
    """The sheet's outline, `size` at most, with its upper left corner at the page's (x, y), and a dot at the zero."""
    import numpy as np

    x0, y0, x1, y1 = nest.sheet.bounds
    scale = size / max(x1 - x0, y1 - y0)
    wide, high = scale * (x1 - x0), scale * (y1 - y0)
    ring = np.array([(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)])
    yield Shape((ring,), Style(stroke=INK, width=0.7))
    at_x, at_y = x + scale * (zero[0] - x0), y + high - scale * (zero[1] - y0)
    if -size < at_x - x < 2 * size and -size < at_y - y < 2 * size:
        dot = np.array([(at_x - 2.5, at_y), (at_x, at_y - 2.5), (at_x + 2.5, at_y), (at_x, at_y + 2.5)])
        yield Shape((dot,), Style(fill=INK))


def zero_words(nest: Nest, zero: tuple[float, float], say: Texts = ENGLISH_TEXTS) -> str:
    """Where the zero lies on the sheet, in words: `lower left corner of the sheet`, or how far from it.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(400, 140, part("A", rect(20, 20, 50, 50)))
    >>> zero_words(plate, (0.0, 0.0)), zero_words(plate, (0.0, -20.0))
    ('lower left corner of the sheet', '20 mm below the lower left corner of the sheet')
    """
    x0, y0, x1, y1 = nest.sheet.bounds
    right, upper = zero[0] > (x0 + x1) / 2, zero[1] > (y0 + y1) / 2
    tr = say.tr
    if upper:
        corner = tr("upper right corner of the sheet") if right else tr("upper left corner of the sheet")
    else:
        corner = tr("lower right corner of the sheet") if right else tr("lower left corner of the sheet")
    dx, dy = zero[0] - (x1 if right else x0), zero[1] - (y1 if upper else y0)
    aside = tr("{mm} mm right of") if dx > 0 else tr("{mm} mm left of")
    upwards = tr("{mm} mm above") if dy > 0 else tr("{mm} mm below")
    off = [aside.format(mm=f"{abs(dx):g}")] if abs(dx) > _SAME_MM else []
    off += [upwards.format(mm=f"{abs(dy):g}")] if abs(dy) > _SAME_MM else []
    return tr("{off} the {corner}").format(off=tr(" and ").join(off), corner=corner) if off else corner


_SAME_MM = 0.01
