"""One value of a chart, from its text: in its column's unit, within what a plant may have."""

from __future__ import annotations

import yaml

from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.plain_values import Text

from .chart import Value, written
from .columns import COLUMNS


def cell(column: str, node: yaml.Node) -> Value:
    """The value of a node in a column.

    Raises
    ------
    Unfit
        If it is none, or so far off that another unit must be meant.
    """
    kind = COLUMNS[column].kind
    value = kind.read(node)
    if isinstance(value, str):
        return value.strip()
    assert isinstance(value, float | int)
    _expect_likely(column, float(value), node)
    return float(value)


def _expect_likely(column: str, value: float, node: yaml.Node) -> None:
    """Refuse a value that is so small or great that another unit must be meant."""
    least, most = COLUMNS[column].least, COLUMNS[column].most
    if (least is not None and value < least) or (most is not None and value > most):
        low, high = (written(column, bound) for bound in (least or 0.0, most or value))
        raise Unfit(f"{written(column, value)} is not likely, expected {low} to {high}: is it in another unit?", node)


def in_unit(column: str, text: str, unit: str | None) -> str:
    """The text of a cell with its unit: that of the head of its column, or its own.

    Raises
    ------
    Unfit
        If it has none, or two.
    """
    kind, units, text = COLUMNS[column].kind, COLUMNS[column].units, text.strip()
    if isinstance(kind, Text) or not units:
        return text
    own = text.lstrip("+-.0123456789eE").strip()
    if "," in own or not any(char.isdigit() for char in text):
        return text  # a decimal comma, or no number at all: the kind says what is expected
    if unit is not None and own and own != unit:
        raise Unfit(f"{text!r} stands in a column of {unit}: give one unit")
    if unit is None and not own and len(units) > 1:
        raise Unfit(f"{text!r} has no unit: write {column} [{units[0]}] at the head, or such as '{text} {units[0]}'")
    return text if own or unit is None else f"{text} {unit}"


def node_at(text: str, line: int) -> yaml.ScalarNode:
    """A text of a line as the kinds of options read it; its column in the file is not known."""
    mark = yaml.Mark("", 0, line - 1, 0, "", 0)
    return yaml.ScalarNode("tag:yaml.org,2002:str", text, mark, mark)
