"""Viewports of SVG files: what shares and font sizes come to in user units, how a box is fitted, what is cut off."""

from __future__ import annotations

import math
import re
from xml.etree.ElementTree import Element

from .svg_css import declarations, properties, tag_of, with_style

VIEWPORT = "kerfwise-viewport"
"""An attribute: of a nested <svg> and of a symbol what is seen of it, in its own units; of a <use> the size around."""

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
        found = _RELATIVE.fullmatch(style.get(name, ""))
        if found is None:
            continue
        number, unit = float(found[1]), found[2]
        per_unit = whole[of] / 100 if unit == "%" else root_em if unit == "rem" else em * _EMS[unit]
        _set(element, style, name, f"{number * per_unit:.12g}")
    if tag == "ellipse":  # a radius that is not given is as long as the other
        for name, other in (("rx", "ry"), ("ry", "rx")):
            if style.get(name, "auto").strip() == "auto" and style.get(other, "auto").strip() != "auto":
                _set(element, style, name, style[other])


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
    around = use.get(VIEWPORT, "0 0").split()
    style = properties(symbol) | {k: v for k, v in properties(use).items() if k in ("width", "height") and v != "auto"}
    size = _size(style, (float(around[0]), float(around[1])))
    box = box_of(symbol)
    if min(size) <= 0 or (box and min(box[2:]) <= 0):
        return None
    seen_of(symbol, size)
    sx, sy, dx, dy = _fit_of(symbol, size)
    if (sx, sy, dx, dy) == (1, 1, 0, 0):
        return ""
    return f"translate({dx:.12g} {dy:.12g}) scale({sx:.12g} {sy:.12g})"


def _fit_of(element: Element, size: Size) -> tuple[float, float, float, float]:
    box = box_of(element)
    return fitted(box, size, element.get("preserveAspectRatio", "")) if box else (1.0, 1.0, 0.0, 0.0)
