"""Turns of a part in a list: degrees, a step of degrees, none, or any."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.kind import OptionKind
from kerfwise.rules.options.plain_values import Number

_DEGREES = Number(0, 360)
LEAST_STEP_DEG = 1
ANY: tuple[float, ...] = ()
"""How `any` is kept."""


@dataclass(frozen=True, slots=True)
class Turns(OptionKind):
    """A list of degrees, counter-clockwise; a step such as 45 for every 45°; `none`, as it is drawn; or `any` turn."""

    def read(self, node: yaml.Node) -> tuple[float, ...]:
        if isinstance(node, yaml.SequenceNode) and node.value:
            return tuple(dict.fromkeys(float(_DEGREES.read(one)) % 360 for one in node.value))
        if isinstance(node, yaml.ScalarNode) and node.value == "none":
            return (0.0,)
        if isinstance(node, yaml.ScalarNode) and node.value == "any":
            return ANY
        if not isinstance(node, yaml.ScalarNode):
            raise self.refuse(node)
        step = float(Number(LEAST_STEP_DEG, 360).read(node))
        if 360 % step:
            raise self.refuse(node)
        return tuple(k * step for k in range(int(360 / step)))

    def write(self, value: Any) -> str:
        return "any" if value == ANY else f"[{', '.join(f'{turn:g}' for turn in value)}]"

    def schema(self) -> dict[str, Any]:
        degrees = {"type": "number", "minimum": 0, "maximum": 360}
        step = {"type": "number", "minimum": LEAST_STEP_DEG, "maximum": 360}
        return {"anyOf": [{"enum": ["none", "any"]}, step, {"type": "array", "items": degrees, "minItems": 1}]}

    def expected(self) -> str:
        return "degrees such as [0, 180], a step that 360 is a multiple of such as 45, none, or any"
