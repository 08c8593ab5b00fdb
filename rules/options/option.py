"""Options: the fields of a frozen dataclass, each with its kind, unit and one line of help.

One declaration serves reading a profile, `profile show`, the JSON Schema and the pages of the docs. The key in YAML
is the field's name without its unit: `cut_feed_mm_s` is `cut_feed: 2500 mm/min`.
"""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass
from typing import Any

from .kind import OptionKind
from .plain_values import Number
from .quantities import Quantity


@dataclass(frozen=True, slots=True)
class Option:
    """One option as declared: field name, YAML key, kind, help, and the default of its class."""

    name: str
    key: str
    kind: OptionKind
    help: str
    default: Any

    @property
    def unit(self) -> str:
        """The unit of a bare number in YAML, "" where there is none."""
        return self.kind.bare if isinstance(self.kind, Quantity) else ""


def option(kind: OptionKind, help: str) -> dict[str, Any]:
    """Metadata of a dataclass field that a profile can set: `field(default=…, metadata=option(LENGTH, "…"))`."""
    return {"kind": kind, "help": help}


def options_of(owner: Any) -> tuple[Option, ...]:
    """The options that a dataclass (or an instance of one) declares, in order.

    Examples
    --------
    >>> from kerfwise.rules.options.quantities import LENGTH
    >>> @dataclass(frozen=True)
    ... class Demo:
    ...     reach_mm: float = dataclasses.field(default=25.0, metadata=option(LENGTH, "how far it looks"))
    >>> [(o.name, o.key, o.unit, o.default) for o in options_of(Demo)]
    [('reach_mm', 'reach', 'mm', 25.0)]
    """
    return tuple(
        Option(f.name, _key(f.name, f.metadata["kind"]), f.metadata["kind"], f.metadata["help"], f.default)
        for f in dataclasses.fields(owner)
        if "kind" in f.metadata
    )


def _key(name: str, kind: OptionKind) -> str:
    """The field's name without the unit that its values may state; a bare number of °C keeps its `_c`."""
    return re.sub(r"_(mm_s2|mm_s|mm|s)$" if isinstance(kind, Number) else r"_(mm_s2|mm_s|mm|s|c|kj|m3_h)$", "", name)


@dataclass(frozen=True, slots=True)
class NoOptions:
    """For rules that have nothing to set."""
