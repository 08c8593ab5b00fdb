"""What an SVG file must get right before it is drawn: a library that makes the best of everything loses contours."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from xml.parsers import expat

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers.drawing import check_copies
from kerfwise.encoder.readers.svg_css import (
    LONGEST_ATTRIBUTE,
    called,
    declarations,
    href_of,
    styled,
    tag_of,
    too_long,
    with_style,
)
from kerfwise.encoder.readers.svg_viewports import PX
from kerfwise.encoder.readers.svg_visible import MATTERS, Seen, laid_out

_VARIABLE = re.compile(r"\bvar\(", re.IGNORECASE)
_SUM = re.compile(r"\b(calc|min|max|clamp|abs)\(", re.IGNORECASE)
_QUANTITY = re.compile(r"((?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(%|[a-z]+)?", re.IGNORECASE)
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv
}  # fmt: skip
_FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "calc": float, "min": min, "max": max, "abs": abs, "clamp": lambda low, wanted, high: max(low, min(wanted, high))
}  # fmt: skip


class _NotComputed(Exception):
    """What a value comes to is not known."""


def computed(root: Element, matters: frozenset[str]) -> None:
    """Write into attributes and styles what the variables and sums in them come to.

    `matters`: the properties that decide whether and where something is seen. Raises InputError for one of these that
    cannot be computed, such as a sum of shares and lengths.
    """
    _compute(root, {}, matters)


def _compute(element: Element, variables: Mapping[str, str], matters: frozenset[str]) -> None:
    said = {name: value for name, (value, _) in declarations(element.get("style", "")).items()}
    style = dict(said)
    variables = {**variables, **{name: value for name, value in style.items() if name.startswith("--")}}
    attributes = {name: value for name, value in element.items() if name in matters or name == "font-size"}
    for own in (attributes, style):
        for name, value in list(own.items()):
            if "(" not in value or name.startswith("--"):
                continue
            try:
                text = _without_sums(_without_variables(value, variables))
            except _NotComputed:
                if name in matters:
                    raise _refusal(element, name, value) from None
                continue
            except KeyError:  # a variable that nobody has set: as if the property was not there
                del own[name]
                element.attrib.pop(name, None)
                continue
            if text != value and own is attributes:
                element.set(name, text)
            own[name] = text
    if style != said:
        with_style(element, style)
    for child in element:
        if isinstance(child.tag, str):
            _compute(child, variables, matters)


def _refusal(element: Element, name: str, value: str) -> InputError:
    what = f"{called(element)} has {name}: {value}, which is not computed"
    return InputError(f"{what}; save the drawing as plain SVG")


def _without_variables(text: str, variables: Mapping[str, str]) -> str:
    """A value with its variables replaced, innermost first; KeyError for one that is not set."""
    for _ in range(MOST_VARIABLES):
        found = list(_VARIABLE.finditer(text))
        if not found or len(text) > LONGEST_ATTRIBUTE:
            break
        start, end = found[-1].start(), _end(text, found[-1].end())
        name, comma, instead = text[found[-1].end() : end - 1].partition(",")
        value = variables.get(name.strip(), instead.strip() if comma else None)
        if value is None:
            raise KeyError(name.strip())
        text = text[:start] + value.strip() + text[end:]
    if _VARIABLE.search(text):  # they mean each other
        raise _NotComputed
    return text


MOST_VARIABLES = 100
"""Variables that one value may lead to."""


def _without_sums(text: str) -> str:
    while found := list(_SUM.finditer(text)):
        start, end = found[-1].start(), _end(text, found[-1].end())
        text = f"{text[:start]}{_worked_out(text[start:end])}{text[end:]}"
    return text


def _end(text: str, at: int) -> int:
    """Where the bracket closes that is open at a place."""
    depth = 1
    while depth and at < len(text):
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        at += 1
    if depth:
        raise _NotComputed
    return at


def _worked_out(text: str) -> str:
    """What one function without others in it comes to.

    Examples
    --------
    >>> _worked_out("calc(1 - 1)"), _worked_out("max(2px, 1in)"), _worked_out("clamp(0%, 120%, 100%)")
    ('0', '96px', '100%')
    """
    units = set[str]()

    def plain(found: re.Match[str]) -> str:
        unit = (found[2] or "").lower()
        is_length = unit in PX and unit != ""
        units.add("px" if is_length else unit)
        return repr(float(found[1]) * (PX[unit] if is_length else 1.0))

    name, _, rest = text.partition("(")
    try:
        tree = ast.parse(f"{name.lower()}({_QUANTITY.sub(plain, rest)}", mode="eval")
        value = _value(tree.body)
    except (SyntaxError, ValueError, TypeError, ArithmeticError, RecursionError, MemoryError):
        raise _NotComputed from None
    if len(units - {""}) > 1:
        raise _NotComputed
    return f"{value:.12g}{next(iter(units - {''}), '')}"


def _value(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=float() as number):
            return number
        case ast.UnaryOp(op=ast.UAdd() | ast.USub() as sign, operand=inner):
            return _value(inner) if isinstance(sign, ast.UAdd) else -_value(inner)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_value(left), _value(right))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in _FUNCTIONS:
            return float(_FUNCTIONS[name](*map(_value, args)))
    raise _NotComputed


UNDRAWN = frozenset(
    (
        "clipPath",
        "mask",
        "marker",
        "pattern",
        "filter",
        "symbol",
        "style",
        "metadata",
        "title",
        "desc",
        "script",
        "foreignObject",
    )
)
"""Elements whose shapes are tools of drawing, or say something of it; some are drawn where they are used."""

_NUMBER = r"(?>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_LENGTH = re.compile(rf"\s*(?:{_NUMBER}\s*(?:mm|cm|in|pt|pc|px|q|em|ex|rem|vw|vh|%)?|auto)\s*", re.IGNORECASE)
_COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])([^MmZzLlHhVvCcSsQqTtAa]*)")
_ARC = re.compile(r"[\s,]*".join(["", *(f"({_NUMBER})",) * 3, "[01]", "[01]", *(f"({_NUMBER})",) * 2]))
_TRANSFORMS = re.compile(
    rf"\s*(?:none|(?:(?:matrix|translate|scale|rotate|skewX|skewY)\s*\(\s*(?:{_NUMBER}(?:\s*,\s*|\s*))+\)\s*,?\s*)*)"
)
_TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2}
_SIZES = {
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
    "line": ("x1", "y1", "x2", "y2"),
    "svg": ("width", "height"),
    "use": ("x", "y", "width", "height"),
}


def validate_svg(data: bytes) -> tuple[bytes, Seen]:
    """The file with what it shows and nothing else: styles on their shapes, clones drawn; and what was taken out.

    Raises InputError for a shape with a number or a path that cannot be read, by name and line: SVG would leave it out,
    or part of it. For more clones than can be drawn, and for styles that cannot be told;
    xml.etree.ElementTree.ParseError for what is no XML.
    """
    root = ElementTree.fromstring(data)
    _check(root, data)
    _check_clones(root)
    imported = _IMPORT.findall(" ".join("".join(e.itertext()) for e in root.iter() if tag_of(e) == "style"))
    linked = re.findall(rb"<\?xml-stylesheet[^>]*?\bhref=[\"']([^\"']*)", data[:_HEAD_BYTES])
    styled(root)
    computed(root, MATTERS)
    for element in root.iter():
        _path_of_style(element)
    _check(root)
    seen = laid_out(root)
    seen.missing += [
        f"the style sheet '{name}' is in another file, and not read: look whether it hides anything"
        for name in (*imported, *(link.decode("utf-8", "replace") for link in linked))
    ]
    for element in list(root.iter()):
        for child in list(element):
            if tag_of(child) in UNDRAWN:
                element.remove(child)
    return ElementTree.tostring(root), seen


_IMPORT = re.compile(r"@import\s+(?:url\(\s*)?[\"']?([^\"');]+)")
_HEAD_BYTES = 4000


def _path_of_style(element: ElementTree.Element) -> None:
    """The path that a style gives in place of the attribute."""
    style = declarations(element.get("style", "")).get("d", ("", False))[0] if tag_of(element) == "path" else ""
    if found := re.fullmatch(r"path\(\s*[\"'](.*)[\"']\s*\)|none", style):
        kept = declarations(element.get("style", "")).items()
        with_style(element, {name: text for name, (text, _) in kept if name != "d"})
        element.set("d", found[1] or "")


def _check(root: ElementTree.Element, data: bytes = b"") -> None:
    """Refuse the first shape that cannot be read, with its line in the file's bytes."""
    for number, element in enumerate(root.iter()):
        for wrong in _wrong(element):
            raise InputError(
                f"{called(element)} cannot be read: {wrong}; save it again as plain SVG",
                line=_line_of(data, number) if data else None,
            )


def _line_of(data: bytes, number: int) -> int | None:
    """The line on which an element begins, by its number in the file."""
    lines: list[int] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, attributes: lines.append(parser.CurrentLineNumber)
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError):
        return None
    return lines[number] if number < len(lines) else None


def _check_clones(root: ElementTree.Element) -> None:
    named = {element.get("id", ""): element for element in root.iter()} | {"": root}

    def made_of(name: str) -> tuple[int, list[tuple[str, int]]]:
        inner = list(named[name].iter()) if name in named else []
        clones = [element for element in inner if tag_of(element) == "use"]
        hrefs = map(href_of, clones)
        return len(inner) - len(clones), [(href.removeprefix("#"), 1) for href in hrefs if href.startswith("#")]

    check_copies("", made_of, "clone")


def _wrong(element: Any) -> Iterator[str]:
    tag = tag_of(element)
    yield from filter(None, (too_long(name, value) for name, value in element.items()))
    for key in _SIZES.get(tag, ()):
        attribute = element.get(key)
        if attribute is not None and not _LENGTH.fullmatch(attribute):
            yield f"{key} is {attribute!r}, expected a length"
    box = element.get("viewBox", "") if tag in ("svg", "symbol") else ""
    if box.strip() and (not _only_numbers(box) or len(re.findall(_NUMBER, box)) != 4):
        yield f"its viewBox {_short(box)!r} is not four numbers"
    points = element.get("points", "") if tag in ("polygon", "polyline") else ""
    if not _only_numbers(points):
        yield f"its points {_short(points)!r} are no list of numbers"
    transform = element.get("transform", "")
    if not _TRANSFORMS.fullmatch(transform):
        yield f"its transform is {_short(transform)!r}, expected functions of plain numbers such as rotate(45)"
    if tag == "path":
        yield from path_data_problem(element.get("d", ""))


def path_data_problem(d: str) -> Iterator[str]:
    """What is wrong with the data of a path, the first of it.

    Examples
    --------
    >>> list(path_data_problem("M10 10 Q zz")), list(path_data_problem("m1-1a1 1 0 01.5.5z"))
    (["Q is followed by '', expected 4 numbers or a multiple"], [])
    """
    text = d.strip()
    if text in ("", "none"):
        return
    if text[0] not in "Mm":
        yield f"its path begins with {_short(text)!r}, expected M"
        return
    if rest := _COMMAND.sub("", text).strip():
        yield f"its path holds {_short(rest)!r}"
        return
    for letter, numbers in _COMMAND.findall(text):
        if not _follow(letter.upper(), numbers):
            takes = {"Z": "nothing", "A": "7 numbers"}.get(letter.upper(), f"{_TAKES.get(letter.upper())} numbers")
            more = "" if letter in "Zz" else " or a multiple"
            yield f"{letter} is followed by {_short(numbers.strip())!r}, expected {takes}{more}"
            return


def _follow(letter: str, numbers: str) -> bool:
    """Whether these numbers may follow a command."""
    if letter == "Z":
        return not numbers.strip()
    if letter == "A":
        at = 0
        while found := _ARC.match(numbers, at):
            at = found.end()
        return at > 0 and not numbers[at:].strip(" \t\r\n,")
    count = len(re.findall(_NUMBER, numbers))
    return _only_numbers(numbers) and count > 0 and count % _TAKES[letter] == 0


def _only_numbers(text: str) -> bool:
    return not re.sub(_NUMBER, "", text).strip(" \t\r\n,")


def _short(text: str) -> str:
    return text if len(text) <= 30 else text[:29] + "…"
