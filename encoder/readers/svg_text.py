"""Writing of an SVG file as paths of single strokes, in place of its <text>: one path for each run of letters.

The first subpath of each stands where the run begins and is as tall as a capital of it; its strokes follow.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from kerfwise.arrays import Floats

from .lettering import is_of_symbols, lacking, lettering, width_of
from .svg_css import properties, tag_of
from .svg_viewports import PX

TEXT, TROUBLE = "data-kerfwise-text", "data-kerfwise-trouble"
"""What a path of strokes says, and why it has none."""

CAPITAL = 0.716
"""How tall a capital is, as a share of the size of a font: that of Arial and Helvetica."""

UNDRAWN = frozenset({"defs", "clipPath", "mask", "marker", "pattern", "symbol"})
_WORDS = {
    "xx-small": 9.0, "x-small": 10.0, "small": 13.0, "medium": 16.0, "large": 18.0, "x-large": 24.0, "xx-large": 32.0,
}  # fmt: skip
_RAISED = {
    "middle": 0.26, "central": 0.345, "hanging": 0.72, "mathematical": 0.45, "text-before-edge": 0.905,
    "text-top": 0.905, "before-edge": 0.905, "text-after-edge": -0.212, "text-bottom": -0.212, "after-edge": -0.212,
    "ideographic": -0.212,
}  # fmt: skip
"""How far above the base line of Arial other lines are, as a share of the size of a font."""
_INHERITED = (
    "font-size", "font-family", "text-anchor", "dominant-baseline", "letter-spacing", "word-spacing", "text-transform",
    "white-space", "writing-mode", "fill", "stroke", "fill-opacity", "stroke-opacity", "stroke-width", "visibility",
)  # fmt: skip
_PAINT = ("fill", "stroke", "fill-opacity", "stroke-opacity", "stroke-width", "visibility")


@dataclass(slots=True)
class _Style:
    """What holds for the letters of an element: its properties, and the size of its font in user units."""

    said: Mapping[str, str]
    size: float
    hidden: bool = False
    trouble: str = ""


@dataclass(slots=True)
class _Sign:
    """One letter with where its element puts it; None where it follows the one before."""

    sign: str
    style: _Style
    x: float | None = None
    y: float | None = None
    dx: float = 0.0
    dy: float = 0.0
    turn: float = 0.0


@dataclass(slots=True)
class _Run:
    """Letters from one absolute place on."""

    signs: list[_Sign] = field(default_factory=list)
    x: float = 0.0
    y: float = 0.0


def write_out(root: Element, box: tuple[float, float]) -> None:
    """Every <text> that is drawn as a group of paths; `box` is what shares of the page's width and height are of."""
    _write_out(root, _Style({}, 16.0), box)


def _write_out(parent: Element, above: _Style, box: tuple[float, float]) -> None:
    for k, child in enumerate(list(parent)):
        tag = tag_of(child)
        if tag in UNDRAWN:
            continue
        own = _styled(child, above)
        if tag in ("text", "flowRoot"):
            parent[k] = _group(child, own, box)
        else:
            _write_out(child, own, box)


def _styled(element: Element, above: _Style) -> _Style:
    own = properties(element)
    style = dict(above.said) | {name: own[name] for name in _INHERITED if own.get(name, "inherit") != "inherit"}
    if short := re.search(r"(?:^|\s)([0-9.]+\s*(?:px|pt|mm|cm|in|pc|em|%))(?:/\S+)?\s+(\S.*)$", own.get("font", "")):
        own.setdefault("font-size", short[1])
        style["font-family"] = short[2]
    size = _size(own.get("font-size", ""), above.size)
    return _Style(style, size, above.hidden or own.get("display") == "none", above.trouble)


def _size(text: str, above: float) -> float:
    if text in _WORDS:
        return _WORDS[text]
    if text in ("smaller", "larger"):
        return above / 1.2 if text == "smaller" else above * 1.2
    length = _length(text, above, above)
    return above if length is None else length


def _length(text: str, em: float, whole: float) -> float | None:
    """A length in user units; shares are of `whole`, None for what is no length."""
    found = re.fullmatch(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([a-zA-Z%]*)\s*", text)
    if found is None:
        return None
    number, unit = float(found[1]), found[2].lower()
    if unit in PX:
        return number * PX[unit]
    return number * {"em": em, "rem": 16.0, "ex": em / 2, "%": whole / 100}.get(unit, math.nan)


# The letters of an element, in order, with their places.


def _signs(element: Element, style: _Style, preserve: bool, box: tuple[float, float]) -> Iterator[_Sign]:
    space = element.get("{http://www.w3.org/XML/1998/namespace}space")
    if space or style.said.get("white-space"):
        preserve = space == "preserve" or style.said.get("white-space", "").startswith(("pre", "break-spaces"))
    own: list[_Sign] = [_Sign(sign, style) for sign in _plain(element.text, preserve, style)]
    for child in element:
        tag = tag_of(child)
        if tag in ("tspan", "a", "flowPara", "flowSpan"):
            own += _signs(child, _styled(child, style), preserve, box)
        elif tag == "textPath":
            along = _styled(child, style)
            along.trouble = "it runs along a path"
            own += _signs(child, along, preserve, box)
        own += [_Sign(sign, style) for sign in _plain(child.tail, preserve, style)]
    for name, whole in (("x", box[0]), ("y", box[1]), ("dx", box[0]), ("dy", box[1])):
        lengths = [_length(word, style.size, whole) for word in re.split(r"[\s,]+", element.get(name, "").strip())]
        for sign, length in zip(own, lengths, strict=False):
            if length is not None and getattr(sign, name) in (None, 0.0):
                setattr(sign, name, length)
    turns = [_length(word, 1.0, 1.0) for word in re.split(r"[\s,]+", element.get("rotate", "").strip())]
    for n, sign in enumerate(own if turns[0] is not None else ()):
        sign.turn = sign.turn or (turns[min(n, len(turns) - 1)] or 0.0)
    yield from own


def _plain(text: str | None, preserve: bool, style: _Style) -> str:
    plain = text or ""
    plain = re.sub(r"[\n\r\t]", " ", plain) if preserve else re.sub(r"[ \n\r\t]+", " ", plain)
    cases = {"uppercase": str.upper, "lowercase": str.lower, "capitalize": str.title}
    change = cases.get(style.said.get("text-transform", ""))
    return change(plain) if change else plain


def _collapsed(signs: Sequence[_Sign], preserve: bool) -> list[_Sign]:
    """Without spaces at the beginning, at the end, and after others."""
    if preserve:
        return list(signs)
    kept: list[_Sign] = []
    for k, sign in enumerate(signs):
        if sign.sign != " " or (kept and kept[-1].sign != " "):
            kept.append(sign)
        elif k + 1 < len(signs):  # where it was to stand the next one does
            after = signs[k + 1]
            after.x = sign.x if after.x is None else after.x
            after.y = sign.y if after.y is None else after.y
            after.dx, after.dy, after.turn = after.dx or sign.dx, after.dy or sign.dy, after.turn or sign.turn
    while kept and kept[-1].sign == " ":
        kept.pop()
    return kept


def _group(text: Element, style: _Style, box: tuple[float, float]) -> Element:
    """The group that stands in the place of a <text>."""
    space = str(text.tag)[: -len(tag_of(text))]
    named = {k: v for k, v in text.items() if k == "id" or k.rpartition("}")[2] == "label"}
    gone = {*named, "x", "y", "dx", "dy", "rotate", "textLength", "lengthAdjust"}
    group = Element(f"{space}g", {k: v for k, v in text.items() if k not in gone})
    group.tail = text.tail
    if tag_of(text) == "flowRoot":
        style.trouble = "it flows into a shape"
    if style.said.get("writing-mode", "").startswith(("tb", "vertical")):
        style.trouble = "it runs from top to bottom"
    preserve = text.get("{http://www.w3.org/XML/1998/namespace}space") == "preserve"
    preserve = preserve or style.said.get("white-space", "").startswith(("pre", "break-spaces"))
    signs = [sign for sign in _collapsed(list(_signs(text, style, preserve, box)), preserve) if not sign.style.hidden]
    for run in _runs(signs):
        if words := "".join(sign.sign for sign in run.signs).strip():
            path = SubElement(group, f"{space}path", named)
            first = run.signs[0].style
            for name in _PAINT:
                if name in first.said:
                    path.set(name, first.said[name])
            path.set(TEXT, words)
            if trouble := _trouble(run, words):
                path.set(TROUBLE, trouble)
            path.set("d", _drawn(run, text, not trouble))
    return group


def _runs(signs: Sequence[_Sign]) -> Iterator[_Run]:
    run, x, y = _Run(), 0.0, 0.0
    for n, sign in enumerate(signs):
        if n and (sign.x is not None or sign.y is not None):
            yield run
        if not n or sign.x is not None or sign.y is not None:
            # a run that states one of the two only goes on from where the one before it ends
            x = sign.x if sign.x is not None else x + _advance(run)
            y = sign.y if sign.y is not None else y + sum(one.dy for one in run.signs)
            run = _Run([], x, y)
        run.signs.append(sign)
    if run.signs:
        yield run


def _spacing(sign: _Sign) -> float:
    """How much further off the next letter is than the font has it."""
    style = sign.style.said
    more = _length(style.get("letter-spacing", ""), sign.style.size, 0.0) or 0.0
    return more + ((_length(style.get("word-spacing", ""), sign.style.size, 0.0) or 0.0) if sign.sign == " " else 0.0)


def _advance(run: _Run) -> float:
    return sum(sign.dx + width_of(sign.sign) * CAPITAL * sign.style.size + _spacing(sign) for sign in run.signs)


def _trouble(run: _Run, words: str) -> str:
    for sign in run.signs:
        font = sign.style.said.get("font-family", "").split(",")[0].strip("'\" ")
        if sign.style.trouble:
            return sign.style.trouble
        if is_of_symbols(font):
            return f"its font {font} shows signs in the place of letters"
        if not sign.style.size > 0:
            return "it has no height"
    if lacks := lettering(words).lacks:
        return lacking(lacks)
    return ""


def _drawn(run: _Run, text: Element, with_strokes: bool) -> str:
    """The data of the path: the height of a capital where the run begins, then the strokes of its letters."""
    first = run.signs[0].style
    width = _advance(run)
    factor, more = _fitted(run, text, width)
    whole = width * factor + more * (len(run.signs) - 1)
    x = run.x - whole * {"middle": 0.5, "end": 1.0}.get(first.said.get("text-anchor", "start"), 0.0)
    y = run.y + _RAISED.get(first.said.get("dominant-baseline", ""), 0.0) * first.size
    rows = [f"M{x:.9g} {y:.9g}v{-CAPITAL * (first.size or 1.0):.9g}"]
    for sign in run.signs if with_strokes else ():
        x, y = x + sign.dx, y + sign.dy
        size = CAPITAL * sign.style.size
        letters = lettering(sign.sign)
        for stroke in letters.strokes:
            rows.append(_path(_turned(stroke * (size * factor, -size), sign.turn) + np.array([x, y])))
        x += (letters.width * size + _spacing(sign)) * factor + more
    return "".join(rows)


def _fitted(run: _Run, text: Element, width: float) -> tuple[float, float]:
    """By how much letters are widened, and how much further they stand apart, so that a text is as long as stated."""
    length = _length(text.get("textLength", ""), run.signs[0].style.size, 0.0)
    if not length or not width or len(list(text)) or len(run.signs) < 2:
        return 1.0, 0.0
    if text.get("lengthAdjust") == "spacingAndGlyphs":
        return length / width, 0.0
    return 1.0, (length - width) / (len(run.signs) - 1)


def _turned(points: Floats, degrees: float) -> Floats:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return points @ np.array([[c, s], [-s, c]]) if degrees else points


def _path(points: Floats) -> str:
    closed = len(points) > 3 and bool((points[0] == points[-1]).all())
    rows = [f"{x:.9g} {y:.9g}" for x, y in (points[:-1] if closed else points).tolist()]
    return f"M{'L'.join(rows)}{'Z' if closed else ''}"
