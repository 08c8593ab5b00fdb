"""The page of an SVG file: what a user unit is in mm, and where the sheet's lower left corner would be."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import svgelements

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.questions import Asking

from .options import SMALLEST_SHEET_MM, ReadOptions, mm_of, units_question
from .svg_viewports import fitted

MM_PER_LENGTH = {"mm": 1.0, "cm": 10.0, "q": 0.25, "in": 25.4, "pt": 25.4 / 72, "pc": 25.4 / 6, "px": 25.4 / 96}


SVG_UNITS = ("px", "mm", "pt", "in")
"""What a file without units may be in, the likeliest first."""

HEAD_BYTES = 4000


@dataclass(frozen=True, slots=True)
class Page:
    """How to get from svgelements' pixels (y down) to mm (y up); `sheet` is None where the file gives no size.

    `units` names what the drawing was taken to be in, `because` why.
    """

    to_mm: Any
    units: str
    sheet: Sheet | None
    because: str = ""


def page_of(svg: Any, options: ReadOptions, data: bytes = b"", asking: Asking | None = None) -> Page:
    """The page of a parsed file.

    A user unit is what `options.units` says; else the page's width and height over those of its viewBox; else what the
    program that wrote the file counts in, by its own words in `data`; else that is asked about. svgelements' own
    conversion is undone first: it rounds the inch and guesses a missing side. Raises InputError when the page has no
    size, or stretches the drawing in one direction.
    """
    sides = [_length(svg.values.get(name)) for name in ("width", "height")]
    box = svg.viewbox
    x0, y0, width, height = (box.x, box.y, box.width, box.height) if box else (0.0, 0.0, 0.0, 0.0)
    if box and not (width > 0 and height > 0):
        raise InputError(f"the viewBox is {width} × {height}: expected a width and a height over 0")
    scales = [mm / user for (mm, _), user in zip(sides, (width, height), strict=True) if mm and user]
    stretched = len(scales) == 2 and abs(scales[0] - scales[1]) > 1e-6 * scales[0]
    measured = any(unit.lower() not in ("", "px") for _, unit in sides)
    if options.units is not None:
        scale, units, because = (
            mm_of(options.units) or 1.0,
            options.units,
            "as given (--units, in Python units=, or drawing.units)",
        )
    elif measured and scales:
        scale, units, because = min(scales), "mm", "the page's width and height say so"
    else:
        extent = max(width, height) or max((mm or 0.0) * 96 / 25.4 for mm, _ in sides)
        units, because = _pixels(data, extent, None if measured else asking)
        scale = min(scales, default=25.4 / 96) * (mm_of(units) or 1.0) * 96 / 25.4
    to_user = ~svgelements.Matrix(svg.viewbox_transform or "")
    if stretched and measured and options.units is None:
        paper = float(sides[0][0] or 0.0), float(sides[1][0] or 0.0)
        sx, sy, dx, dy = fitted((x0, y0, width, height), paper, str(svg.values.get("preserveAspectRatio") or ""))
        return Page(
            to_user * svgelements.Matrix(sx, 0, 0, -sy, dx, paper[1] - dy), units, Sheet.rectangle(*paper), because
        )
    if not box:
        pixel = scale * 96 / 25.4
        sides = [(mm if mm is None or unit.lower() not in ("", "px") else mm * pixel, unit) for mm, unit in sides]
    size = (width * scale, height * scale) if box else tuple(mm or 0.0 for mm, _ in sides)
    sheet = Sheet.rectangle(*size) if min(size) > 0 else None
    upright = svgelements.Matrix(scale, 0, 0, -scale, -x0 * scale, y0 * scale + (size[1] if sheet else 0.0))
    return Page(to_user * upright, units, sheet, because)


def _pixels(data: bytes, extent: float, asking: Asking | None) -> tuple[str, str]:
    """What the units of a file without any are, and why: by the words of the program that wrote it, or answered."""
    head = data[:HEAD_BYTES].decode("utf-8", "replace")
    if "Adobe Illustrator" in head:
        return "pt", "Illustrator counts 72 an inch"
    if found := re.search(r'inkscape:version="(\d+)\.(\d+)', data.decode("utf-8", "replace")):
        old = (int(found[1]), int(found[2])) < (0, 92)
        return (
            ("90dpi", f"Inkscape {found[1]}.{found[2]} counts 90 an inch")
            if old
            else ("px", "Inkscape counts 96 an inch")
        )
    likely = [unit for unit in SVG_UNITS if not extent or extent * (mm_of(unit) or 1.0) >= SMALLEST_SHEET_MM]
    question = units_question(
        f"the file names no unit{f', its page is {extent:g} units long' if extent else ''}: what is it in?",
        (*likely, *(unit for unit in SVG_UNITS if unit not in likely)),
        extent,
    )
    if asking is None:
        return "px", "pixels of a page that has a size are 96 an inch"
    return asking.ask(question), "asked: the file names no unit"


def _length(value: object) -> tuple[float | None, str]:
    """A side of the page in mm and its unit; None where it is not given, or only as a share of the window."""
    found = re.fullmatch(r"\s*\+?([0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([a-zA-Z]*)\s*", str(value))
    if not found or (found[2] and found[2].lower() not in MM_PER_LENGTH):
        return None, ""
    return float(found[1]) * MM_PER_LENGTH[found[2].lower() or "px"], found[2]
