"""A scene as SVG text: the same scene gives the same bytes."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import groupby

from kerfwise.arrays import Floats

from .scene import CAP_HEIGHT, HALO, Dot, Item, Scene, Shape, Style, TextLine

FONT = "DejaVu Sans, Verdana, Arial, sans-serif"


def svg_text(scene: Scene) -> str:
    """The scene as a complete SVG document.

    Every layer is a group with the layer's name as its id; what belongs to a cut has `data-cut`, its place in the
    cutting order.
    """
    width, height = _number(scene.width), _number(scene.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
        f' font-family="{FONT}">',
        f"<title>{_clean(scene.title)}</title>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
    ]
    for layer in scene:
        lines.append(f'<g id="{layer.name}">')
        for attributes, items in groupby(layer.items, key=_shared):
            lines.append(f"<g{attributes}>")
            lines.extend(_element(item) for item in items)
            lines.append("</g>")
        lines.append("</g>")
    lines.append("</svg>")
    return "\n".join(lines) + "\n"


def _number(value: float) -> str:
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _clean(text: str) -> str:
    """Text safe inside an element: XML forbids most control characters."""
    return escape("".join(c if c.isprintable() else " " for c in text), quote=False)


def _shared(item: Item) -> str:
    """The attributes that neighbouring items of one look can share by standing on their group."""
    if isinstance(item, TextLine):
        halo = f' stroke="{item.halo}" stroke-linejoin="round" paint-order="stroke"' if item.halo else ""
        weight = ' font-weight="bold"' if item.bold else ""
        return f' class="text" fill="{item.colour}" text-anchor="{item.anchor}"{weight}{halo}'
    return "".join(_painted(item.style))


def _painted(style: Style) -> Iterator[str]:
    yield f' fill="{style.fill or "none"}"'
    if style.stroke:
        yield f' stroke="{style.stroke}" stroke-width="{_number(style.width)}"'
        yield ' stroke-linejoin="round" stroke-linecap="round"'
    if style.dash:
        yield f' stroke-dasharray="{" ".join(map(_number, style.dash))}"'


def _element(item: Item) -> str:
    cut = f' data-cut="{item.cut}"' if item.cut else ""
    if isinstance(item, Dot):
        return f'<circle cx="{_number(item.x)}" cy="{_number(item.y)}" r="{_number(item.radius)}"{cut}/>'
    if isinstance(item, Shape):
        path = "".join(_path(line, item.closed) for line in item.lines)
        return f'<path d="{path}"{cut}>{_title(item.title)}</path>' if item.title else f'<path d="{path}"{cut}/>'
    x, y = _number(item.x), _number(item.y)
    turn = f' transform="rotate(-90 {x} {y})"' if item.turned else ""
    rim = f' stroke-width="{_number(HALO * item.size)}"' if item.halo else ""
    baseline = _number(item.y + item.size * CAP_HEIGHT / 2)
    size = _number(item.size)
    return f'<text x="{x}" y="{baseline}" font-size="{size}"{rim}{turn}{cut}>{_clean(item.text)}</text>'


def _title(text: str) -> str:
    return f"<title>{_clean(text)}</title>"


def _path(line: Floats, closed: bool) -> str:
    points = " ".join(f"{_number(x)},{_number(y)}" for x, y in line.tolist())
    return f"M{points}{'Z' if closed else ''}"
