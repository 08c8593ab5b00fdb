"""Which row of a chart a profile means: by its name, or by what stands in its columns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.kind import OptionKind, Unfit, scalar_text
from kerfwise.rules.options.plain_values import Text
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import is_empty

from .chart import Value
from .columns import COLUMNS

AUTO = "auto"
RowChoice = tuple[tuple[str, Value], ...]
"""Column and value, pair by pair."""


@dataclass(frozen=True, slots=True)
class RowChoiceKind(OptionKind):
    """A row's name, or a mapping such as `{material: S355, thickness: 8 mm, amps: 45}`; `auto` stands for None."""

    def read(self, node: yaml.Node) -> RowChoice | None:
        if not isinstance(node, yaml.MappingNode):
            text = scalar_text(node, self).strip()
            if not text:
                raise self.refuse(node)
            return None if text == AUTO else (("name", text),)
        found: dict[str, Value] = {}
        for key, value in node.value:
            name = str(key.value)
            if name not in COLUMNS:
                raise Unfit(unknown("column", name, COLUMNS), key)
            if name in found:
                raise Unfit(f"{name} is given twice", key)
            read = COLUMNS[name].kind.read(value) if not is_empty(value) else None
            if not isinstance(read, str | float | int):
                raise Unfit(f"{name}: expected {COLUMNS[name].kind.expected()}, got nothing", value)
            found[name] = read
        if not found:
            raise self.refuse(node)
        return tuple(found.items())

    def write(self, value: Any) -> str:
        if value is None:
            return AUTO
        pairs = [f"{name}: {COLUMNS[name].kind.write(one)}" for name, one in value]
        return f"{{{', '.join(pairs)}}}"

    def schema(self) -> dict[str, Any]:
        keys = {name: {"description": column.help, **column.kind.schema()} for name, column in COLUMNS.items()}
        mapping = {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [Text().schema(), {"type": "integer"}, mapping]}

    def expected(self) -> str:
        return "a row's name, or some of its columns such as {material: S235, thickness: 6 mm}"


ROW_CHOICE = RowChoiceKind()
