"""Lengths that a profile states in mm or in thicknesses of the sheet."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import yaml

from .kind import Kind, Unfit
from .quantities import LENGTH
from .yaml_positions import shape

_NUMBER = r"(?:\d+\.?\d*|\.\d+)"
_PATTERN = rf"\s*({_NUMBER})\s*(?:[×x*]\s*)?(?:thickness|thicknesses)\s*"


@dataclass(frozen=True, slots=True)
class ByThickness:
    """A length of so many thicknesses of the sheet, or, where `thicknesses` is None, of `fixed_mm`.

    Examples
    --------
    >>> ByThickness(1.5).mm(6.0), ByThickness(None, 4.0).mm(6.0)
    (9.0, 4.0)
    """

    thicknesses: float | None = None
    fixed_mm: float = 0.0

    def mm(self, thickness_mm: float) -> float:
        """The length on a sheet of that thickness, mm."""
        return self.fixed_mm if self.thicknesses is None else self.thicknesses * thickness_mm


@dataclass(frozen=True, slots=True)
class LengthByThickness(Kind):
    """A length such as `5 mm`, or a number of thicknesses such as `1.5 × thickness`."""

    def read(self, node: yaml.Node) -> ByThickness:
        found = re.fullmatch(_PATTERN, node.value) if isinstance(node, yaml.ScalarNode) else None
        if found is not None:
            return ByThickness(float(found[1]))
        try:
            return ByThickness(None, LENGTH.read(node))
        except Unfit as error:
            raise Unfit(f"expected {self.expected()}, got {shape(node)}", error.node) from None

    def write(self, value: ByThickness) -> str:
        if value.thicknesses is None:
            return LENGTH.write(value.fixed_mm)
        return f"{value.thicknesses:.12g} × thickness"

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "pattern": f"^{_PATTERN}$"}, *LENGTH.schema()["anyOf"]]}

    def expected(self) -> str:
        return "a length such as '5 mm', or '1.5 × thickness'"
