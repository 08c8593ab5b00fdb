"""A group of options under one key, such as `drawing: {layers: {cut: …, mark: …}}`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from .kind import OptionKind
from .option import options_of


@dataclass(frozen=True, slots=True)
class Members(OptionKind):
    """The options that the dataclass `owner` declares. A profile is read, shown and described option by option."""

    owner: type

    def read(self, node: yaml.Node) -> object:
        raise self.refuse(node)  # `read_fields` reads each of them, over those of the profile it is based on

    def write(self, value: Any) -> str:
        return f"{{{', '.join(f'{o.key}: {o.kind.write(getattr(value, o.name))}' for o in options_of(value))}}}"

    def schema(self) -> dict[str, Any]:
        members = {o.key: {"description": o.help, **o.kind.schema()} for o in options_of(self.owner)}
        return {"type": ["object", "null"], "properties": members, "additionalProperties": False}

    def expected(self) -> str:
        return "a mapping of " + ", ".join(o.key for o in options_of(self.owner))
