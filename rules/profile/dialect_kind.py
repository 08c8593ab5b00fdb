"""The name of an NC dialect, or the file of a plant's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.plain_values import Choice

ENDINGS = (".yaml", ".yml")


def is_own_dialect(name: str) -> bool:
    """Whether a profile names a dialect file of its own."""
    return name.endswith(ENDINGS)


@dataclass(frozen=True, slots=True)
class DialectName(Choice):
    """A dialect that comes with kerfwise, or a path that ends in .yaml, as seen from where kerfwise is run."""

    def read(self, node: yaml.Node) -> str | None:
        if isinstance(node, yaml.ScalarNode) and str(node.value).endswith(ENDINGS):
            return str(node.value)
        return Choice.read(self, node)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [Choice.schema(self), {"type": "string", "pattern": r"\.ya?ml$"}]}

    def expected(self) -> str:
        return f"{Choice.expected(self)}, or a dialect file of your own that ends in .yaml"
