"""The page and viewports of SVG files: user units in mm, shares and font sizes, how a box is fitted and clipped."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element

import svgelements

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Note, Sheet
from kerfwise.encoder.questions import Asking

from .options import GIVEN, SMALLEST_SHEET_MM, ReadOptions, mm_of, units_question
from .svg_css import declarations, properties, tag_of, with_style

VIEWPORT = "kerfwise-viewport"
"""An attribute: of a nested <svg> and of a symbol what is seen of it, in its own units; of a <use> the size around."""
_MADE = "kerfwise-made"
"""An attribute: of an <svg> whose viewBox is not of the drawing."""

PX = {"": 1.0, "px": 1.0, "mm": 96 / 25.4, "cm": 960 / 25.4, "in": 96.0, "pt": 96 / 72, "pc": 16.0, "q": 24 / 25.4}
"""User units of a length, by its unit."""

_PLACE = {"x": 0, "y": 1, "width": 0, "height": 1}
_SIDES = {
    "rect": _PLACE | {"rx": 0, "ry": 1},
    "circle": {"cx": 0, "cy": 1, "r": 2},
    "ellipse": {"cx": 0, "cy": 1, "rx": 0, "ry": 1},
    "line": {"x1": 0, "y1": 1, "x2": 0, "y2": 1},
    "svg": _PLACE,
    "use": _PLACE,
}
"""Of what a share is one: the width, the height, or the mean diagonal of the viewport."""
_STARTS = ("x", "y", "cx", "cy", "x1", "y1", "x2", "y2")
_RELATIVE = re.compile(r"\s*([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*(%|r?em|ex|ch)\s*")
_EMS = {"em": 1.0, "ex": 0.5, "ch": 0.5}
_MEDIUM_PX = 16.0
_SHOWN_BEYOND = ("visible", "auto")

Size = tuple[float, float]


def length_px(text: str) -> float:
    """A length in user units, 0 for what is none.

    Examples
    --------
    >>> length_px("2in"), length_px("7"), length_px("50%")
    (192.0, 7.0, 0.0)
    """
    found = re.fullmatch(r"\s*([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*([a-zA-Z]*)\s*", text)
    if found is None or found[2].lower() not in PX:
        return 0.0
    return float(found[1]) * PX[found[2].lower()]


def box_of(element: Element) -> tuple[float, float, float, float] | None:
    """The viewBox of an element: left, top, width and height; None where it has none."""
    numbers = [float(n) for n in re.split(r"[\s,]+", element.get("viewBox", "").strip()) if n]
    return (numbers[0], numbers[1], numbers[2], numbers[3]) if len(numbers) == 4 else None


def view_size(root: Element) -> Size:
    """Width and height of what shares are of at the root of a file, in user units."""
    box = box_of(root)
    return box[2:] if box else (length_px(root.get("width", "0")), length_px(root.get("height", "0")))


def fitted(box: tuple[float, float, float, float], size: Size, aspect: str) -> tuple[float, float, float, float]:
    """How a viewBox is fitted into a size, by its preserveAspectRatio: the scales and the shifts along x and y.

    Examples
    --------
    >>> fitted((0, 0, 10, 10), (40, 20), "")
    (2.0, 2.0, 10.0, 0.0)
    >>> fitted((0, 0, 10, 10), (40, 20), "xMinYMax slice"), fitted((5, 0, 10, 10), (40, 20), "none")
    ((4.0, 4.0, 0.0, -20.0), (4.0, 2.0, -20.0, 0.0))
    """
    words = [word for word in aspect.split() if word != "defer"] or ["xMidYMid"]
    sx, sy = size[0] / box[2], size[1] / box[3]
    if words[0] != "none":
        sx = sy = max(sx, sy) if "slice" in words else min(sx, sy)
    along = {"xMin": 0.0, "xMax": 1.0}.get(words[0][:4], 0.5), {"YMin": 0.0, "YMax": 1.0}.get(words[0][4:], 0.5)
    free = size[0] - sx * box[2], size[1] - sy * box[3]
    return sx, sy, along[0] * free[0] - sx * box[0], along[1] * free[1] - sy * box[1]


def lengths_resolved(root: Element) -> None:
    """Shares of a viewport and multiples of a font size become user units; nested <svg> get all that they leave out."""
    _resolve(root, view_size(root), _MEDIUM_PX, _MEDIUM_PX, is_root=True)


def _resolve(element: Element, size: Size, em: float, root_em: float, is_root: bool = False) -> None:
    tag = tag_of(element)
    style = properties(element)
    em = _font_px(style.get("font-size", ""), em, root_em)
    for name in ("width", "height"):
        if element.get(name, "").strip() == "auto":
            del element.attrib[name]
    if not is_root:
        _plain_lengths(element, tag, style, size, em, root_em)
    inner = size
    if tag == "svg" and not is_root:
        inner = _nested(element, style, size)
    elif tag == "symbol" and (box := box_of(element)):
        inner = box[2:]
    elif tag == "use":
        element.set(VIEWPORT, f"{size[0]!r} {size[1]!r}")
    for child in element:
        if isinstance(child.tag, str):
            _resolve(child, inner, em, root_em if not is_root else em)


def _plain_lengths(element: Element, tag: str, style: dict[str, str], size: Size, em: float, root_em: float) -> None:
    whole = (*size, math.hypot(*size) / math.sqrt(2))
    for name, of in _SIDES.get(tag, {}).items():
        if name in _STARTS:  # svgelements hands on what an element around says
            element.set(name, element.get(name, "0"))
        found = _RELATIVE.fullmatch(style.get(name, ""))
        if found is None:
            continue
        number, unit = float(found[1]), found[2]
        per_unit = whole[of] / 100 if unit == "%" else root_em if unit == "rem" else em * _EMS[unit]
        _set(element, style, name, f"{number * per_unit:.12g}")
    if tag in ("ellipse", "rect"):  # a radius that is not given, or cannot be, is as long as the other
        for name, other in (("rx", "ry"), ("ry", "rx")):
            if _is_auto(style, name) and not _is_auto(style, other):
                _set(element, style, name, style[other])
            elif tag == "rect" and _is_auto(style, name):
                _set(element, style, name, "0")


def _is_auto(style: dict[str, str], name: str) -> bool:
    text = style.get(name, "auto").strip()
    return text == "auto" or text.startswith("-")


def _set(element: Element, said: dict[str, str], name: str, value: str) -> None:
    """Set an attribute, in the place of what the element's style says of it."""
    style = declarations(element.get("style", ""))
    if style.pop(name, None) is not None:
        with_style(element, {key: text for key, (text, _) in style.items()})
    element.set(name, value)
    said[name] = value


def _font_px(text: str, em: float, root_em: float) -> float:
    found = _RELATIVE.fullmatch(text)
    if found is not None:
        per_unit = em / 100 if found[2] == "%" else root_em if found[2] == "rem" else em * _EMS[found[2]]
        return float(found[1]) * per_unit
    return length_px(text) or em


def _nested(svg: Element, style: dict[str, str], around: Size) -> Size:
    """The size of what shares in a nested <svg> are of; the <svg> is given its size, and what is seen of it."""
    size = _size(style, around)
    for name, side in zip(("width", "height"), size, strict=True):
        _set(svg, style, name, f"{side:.12g}")
    box = box_of(svg)
    if min(size) <= 0 or (box and min(box[2:]) <= 0):
        svg.set("style", "display:none")
        return size
    if not box:  # without one svgelements leaves it at the origin
        svg.set("viewBox", f"0 0 {size[0]:.12g} {size[1]:.12g}")
        svg.set(_MADE, "")
    seen_of(svg, size)
    return box[2:] if box else size


def _size(style: dict[str, str], around: Size) -> Size:
    width, height = (
        whole if style.get(name, "auto").strip() in ("auto", "100%") else length_px(style[name])
        for name, whole in zip(("width", "height"), around, strict=True)
    )
    return width, height


def seen_of(element: Element, size: Size) -> None:
    """Note on a nested <svg>, or a symbol, of what size it is: what is beyond is not seen, unless it says otherwise."""
    element.attrib.pop(VIEWPORT, None)
    style = properties(element)
    if style.get("overflow", "hidden").strip() in _SHOWN_BEYOND:
        return
    sx, sy, dx, dy = _fit_of(element, size)
    element.set(VIEWPORT, " ".join(f"{n!r}" for n in (-dx / sx, -dy / sy, size[0] / sx, size[1] / sy)))


def symbol_fitted(symbol: Element, use: Element) -> str | None:
    """The transform that fits a symbol, or an <svg>, into the size of its clone; None where nothing of it is seen."""
    if symbol.attrib.pop(_MADE, None) is not None:
        del symbol.attrib["viewBox"]
    around = use.get(VIEWPORT, "0 0").split()
    style = properties(symbol) | {k: v for k, v in properties(use).items() if k in ("width", "height") and v != "auto"}
    size = _size(style, (float(around[0]), float(around[1])))
    box = box_of(symbol)
    if min(size) <= 0 or (box and min(box[2:]) <= 0):
        return None
    seen_of(symbol, size)
    sx, sy, dx, dy = _fit_of(symbol, size)
    if tag_of(symbol) == "svg":
        dx, dy = dx + length_px(style.get("x", "0")), dy + length_px(style.get("y", "0"))
    if (sx, sy, dx, dy) == (1, 1, 0, 0):
        return ""
    return f"translate({dx:.12g} {dy:.12g}) scale({sx:.12g} {sy:.12g})"


def _fit_of(element: Element, size: Size) -> tuple[float, float, float, float]:
    box = box_of(element)
    return fitted(box, size, element.get("preserveAspectRatio", "")) if box else (1.0, 1.0, 0.0, 0.0)


MM_PER_LENGTH = {"mm": 1.0, "cm": 10.0, "q": 0.25, "in": 25.4, "pt": 25.4 / 72, "pc": 25.4 / 6, "px": 25.4 / 96}


SVG_UNITS = ("px", "mm", "pt", "in")
"""What a file without units may be in, the likeliest first."""

HEAD_BYTES = 4000
_SAME_SCALE = 0.01
"""Sizes of pages are rounded: a scale that they make may be off by this share."""


@dataclass(frozen=True, slots=True)
class Page:
    """How to get from svgelements' pixels (y down) to mm (y up); `sheet` is None where the file gives no size.

    `units` names what the drawing was taken to be in, `because` why; `notes` say where the page contradicts them.
    """

    to_mm: Any
    units: str
    sheet: Sheet | None
    because: str = ""
    notes: tuple[Note, ...] = ()


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
    notes: tuple[Note, ...] = ()
    if options.units is not None:
        scale, units, because = mm_of(options.units) or 1.0, options.units, GIVEN
        if measured and scales and abs(min(scales) - scale) > _SAME_SCALE * scale:
            text = f"by the size of its page a unit of the file is {min(scales):.4g} mm"
            notes = (Note("warning", f"{text}, and it is read in {units}, {GIVEN}"),)
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
    return Page(to_user * upright, units, sheet, because, notes)


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
