"""How far an own rule reaches: over the whole sheet, or within each part, zone, or group of one attribute."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.kind import OptionKind
from kerfwise.rules.options.plain_values import Choice

from .named_facts import ATTRIBUTE, KnownFacts

WORDS = ("sheet", "part", "zone")


@dataclass(frozen=True, slots=True)
class Scope(OptionKind):
    """sheet, part, zone, or attribute.<name>: the parts that the nest gives the same value there."""

    def read(self, node: yaml.Node) -> str:
        text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
        if text.startswith(ATTRIBUTE) and text != ATTRIBUTE:
            return text
        if text not in WORDS:
            raise self.refuse(node)
        return text

    def write(self, value: str) -> str:
        return value

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [Choice(WORDS).schema(), {"type": "string", "pattern": r"^attribute\..+"}]}

    def expected(self) -> str:
        return f"{', '.join(WORDS)} or {ATTRIBUTE}<name>"


def groups(known: KnownFacts, scope: str) -> list[tuple[int, ...]]:
    """Contour numbers group by group; a contour without a value for the scope is in none.

    Examples
    --------
    >>> from kerfwise.rules.own.measures import measured
    >>> from kerfwise.rules.own.named_facts import known_of_nest
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> two = part("A", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]), part("B", rect(110, 10, 80, 80))
    >>> plate = nest(300, 100, *two)
    >>> groups(known_of_nest(measured(plate, None, long_ratio=4, web_mm=25)), "part")
    [(0, 1), (2,)]
    """
    if scope == "sheet":
        return [tuple(range(len(known.nest.contours)))]
    found: dict[str, list[int]] = {}
    for k, value in enumerate(known.values(scope)):
        if value is not None:
            found.setdefault(str(value), []).append(k)
    return [tuple(members) for members in found.values()]
