"""What variables and sums in the styles of an SVG file come to: `var(--x, 0)`, `calc(1 - 1)`, `max(2px, 1mm)`."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping
from xml.etree.ElementTree import Element

from kerfwise.encoder.errors import InputError

from .svg_css import LONGEST_ATTRIBUTE, called, declarations, with_style
from .svg_viewports import PX

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
