"""Options: the fields of a frozen dataclass, each with its kind, unit and one line of help.

One declaration serves reading a profile, `profile show`, the JSON Schema and the pages of the docs. The key in YAML
is the field's name without its unit: `cut_feed_mm_s` is `cut_feed: 2500 mm/min`.
"""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass
from typing import Any

import yaml

from .kind import Number, OptionKind
from .quantities import Quantity


@dataclass(frozen=True, slots=True)
class Option:
    """One option as declared: field name, YAML key, kind, help, and the default of its class.

    `named` has the value that a switch of its group is given where a profile has the group and says none of its
    switches: with `cuts: {links: {}}` there are links as long as is usual. It is empty for options that are no switch.
    """

    name: str
    key: str
    kind: OptionKind
    help: str
    default: Any
    named: tuple[Any, ...] = ()

    @property
    def unit(self) -> str:
        """The unit of a bare number in YAML, "" where there is none."""
        return self.kind.bare if isinstance(self.kind, Quantity) else ""


def option(kind: OptionKind, help: str, named: tuple[Any, ...] = ()) -> dict[str, Any]:
    """Metadata of a dataclass field that a profile can set: `field(default=…, metadata=option(LENGTH, "…"))`."""
    return {"kind": kind, "help": help, "named": named}


def setting(default: Any, kind: OptionKind, help: str, named: tuple[Any, ...] = ()) -> Any:
    """A dataclass field that a profile can set: `reach_mm: float = setting(25.0, LENGTH, "how far it looks")`."""
    return dataclasses.field(default=default, metadata=option(kind, help, named))


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
        Option(
            f.name,
            _key(f.name, f.metadata["kind"]),
            f.metadata["kind"],
            f.metadata["help"],
            f.default,
            f.metadata.get("named", ()),
        )
        for f in dataclasses.fields(owner)
        if "kind" in f.metadata
    )


def _key(name: str, kind: OptionKind) -> str:
    """The field's name without the unit that its values may state; a bare number of °C keeps its `_c`."""
    return re.sub(r"_(mm_s2|mm_s|mm|s)$" if isinstance(kind, Number) else r"_(mm_s2|mm_s|mm|s|c|kj|m3_h)$", "", name)


@dataclass(frozen=True, slots=True)
class NoOptions:
    """For rules that have nothing to set."""


# A group of options under one key, such as `drawing: {layers: {cut: …, mark: …}}`.


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
