"""A kind of value an option can have: how it is read from YAML, written back, and described to an editor."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from typing import Any

import yaml

from .yaml_positions import is_empty, shape

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,2})?"
MOST = 1e9
"""No number of a profile is larger, whatever it is of."""
LONGEST = 60
"""Characters of a number and its unit."""


class Unfit(ValueError):
    """A value that its kind does not accept; the text says what was given and what was expected.

    `node` is the part of the value that is wrong, None for all of it.
    """

    def __init__(self, text: str, node: yaml.Node | None = None) -> None:
        super().__init__(text)
        self.node = node


class OptionKind(ABC):
    """One kind of value."""

    @abstractmethod
    def read(self, node: yaml.Node) -> object:
        """The value of a YAML node, in the program's own units; raises `Unfit`."""

    @abstractmethod
    def write(self, value: Any) -> str:
        """The value as YAML text that reads back the same."""

    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """JSON Schema of the values accepted."""

    @abstractmethod
    def expected(self) -> str:
        """What is accepted, in words."""

    def refuse(self, node: yaml.Node) -> Unfit:
        """The error for a node this kind does not accept."""
        return Unfit(f"expected {self.expected()}, got {shape(node)}{_decimal_comma(node)}", node)


def _decimal_comma(node: yaml.Node) -> str:
    """A hint where a number was written as in German or Russian."""
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
    comma = re.fullmatch(r"\s*[+-]?\d+,\d+\s*[a-z/0-9]*\s*", text)
    return f": write decimals with a point, {text.replace(',', '.').strip()}" if comma else ""


def scalar_text(node: yaml.Node, kind: OptionKind) -> str:
    if not isinstance(node, yaml.ScalarNode) or is_empty(node):
        raise kind.refuse(node)
    return str(node.value)


def digits(node: yaml.Node, kind: OptionKind) -> str:
    """The text of a number, refused where it is longer than any number is."""
    text = scalar_text(node, kind)
    if len(text) > LONGEST:
        raise Unfit(f"expected {kind.expected()}, got a text of {len(text)} characters", node)
    return text
