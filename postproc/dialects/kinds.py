"""What the keys of a dialect's file may hold: blocks with places for values, lists of them, and line numbers."""

from __future__ import annotations

import string
from dataclasses import dataclass
from typing import Any, NamedTuple

import yaml

from kerfwise.rules.options.kind import OptionKind, Unfit, scalar_text
from kerfwise.rules.options.plain_values import Number
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty

DWELL = "dwell"
"""The name of the place in a list of blocks where the torch waits for the pierce."""
POWERS = ("power", "pierce_power", "mark_power")
"""The names of the S words of a laser in a block."""
MOST_COUNT = 1000


class LineNumbers(NamedTuple):
    """The N word of the first block and the step from block to block."""

    start: int
    step: int


class ProgramNumber(NamedTuple):
    """The number that a program is called by on the control, and how many digits it is written with."""

    number: int
    digits: int


class Powers(NamedTuple):
    """S words of a laser: while it cuts, pierces and marks, where a profile does not say, and that of full power."""

    cut: int
    pierce: int
    mark: int
    full: int


@dataclass(frozen=True, slots=True)
class Block(OptionKind):
    """One block: a line of text, in which `{name}` stands for a value.

    `holes` are the names that may stand there, `needs` those of which one must. With `none` the key may be null, with
    `empty` the text may be "".
    """

    holes: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    none: bool = False
    empty: bool = False

    def read(self, node: yaml.Node) -> str | None:
        if self.none and is_empty(node):
            return None
        text = scalar_text(node, self)
        if not text.isprintable():
            raise Unfit(f"expected one line of text, got {text!r}", node)
        if not text and not self.empty:
            raise self.refuse(node)
        named = _names(text)
        allowed = {(name, "", None) for name in (*self.holes, *self.needs)}
        if not set(named) <= allowed or (self.needs and len([n for n in named if n[0] in self.needs]) != 1):
            raise self.refuse(node)
        return text

    def write(self, value: str | None) -> str:
        return "null" if value is None else value

    def schema(self) -> dict[str, Any]:
        made: dict[str, Any] = {"type": ["string", "null"] if self.none else "string"}
        if not self.empty:
            made["minLength"] = 1
        if self.needs:
            made["pattern"] = r"\{(" + "|".join(self.needs) + r")\}"
        return made

    def expected(self) -> str:
        or_null = ", or null" if self.none else ""
        if self.needs:
            more = "".join(f", {{{name}}}" for name in self.holes)
            return f"one {' or '.join(f'{{{name}}}' for name in self.needs)}{more}, and no other brace{or_null}"
        if self.holes:
            return f"a line of text, with no braces but {', '.join(f'{{{name}}}' for name in self.holes)}{or_null}"
        return f"a line of text without braces{or_null}"


@dataclass(frozen=True, slots=True)
class Blocks(OptionKind):
    """Blocks in the order in which they are written; a single one may stand without a list.

    With `some` there must be one, with `none` the key may be null.
    """

    each: Block = Block()
    none: bool = False
    some: bool = False

    def read(self, node: yaml.Node) -> tuple[str, ...]:
        if self.none and is_empty(node):
            return ()
        if self.some and isinstance(node, yaml.SequenceNode) and not node.value:
            raise self.refuse(node)
        if isinstance(node, yaml.SequenceNode):
            return tuple(str(self.each.read(one)) for one in node.value)
        if isinstance(node, yaml.ScalarNode) and not is_empty(node):
            return (str(self.each.read(node)),)
        raise self.refuse(node)

    def write(self, value: tuple[str, ...]) -> str:
        return yaml.safe_dump(list(value), default_flow_style=True, width=1e9).strip()

    def schema(self) -> dict[str, Any]:
        one = self.each.schema()
        many = {"type": "array", "items": one} | ({"minItems": 1} if self.some else {})
        return {"anyOf": [one, many, *([{"type": "null"}] if self.none else [])]}

    def expected(self) -> str:
        many = "one or more blocks" if self.some else "blocks"
        return f"a block or a list of {many}, each {self.each.expected()}{', or null' if self.none else ''}"


@dataclass(frozen=True, slots=True)
class Counted(OptionKind):
    """Whole numbers under their names, such as `{start: 10, step: 10}`, or null."""

    made: type[LineNumbers] | type[ProgramNumber] | type[Powers]
    shown: str
    most: tuple[int, ...] = (MOST_COUNT, MOST_COUNT)

    def read(self, node: yaml.Node) -> LineNumbers | ProgramNumber | Powers | None:
        if is_empty(node):
            return None
        if not isinstance(node, yaml.MappingNode):
            raise self.refuse(node)
        inner = Problems("")
        values = {key: value for key, _, value in entries(node, inner, "it")}
        if inner.found or set(values) != set(self.made._fields):
            raise self.refuse(node)
        limits = zip(self.made._fields, self.most, strict=True)
        return self.made(*(int(Number(1, most, whole=True).read(values[name])) for name, most in limits))

    def write(self, value: LineNumbers | ProgramNumber | Powers | None) -> str:
        if value is None:
            return "null"
        return f"{{{', '.join(f'{key}: {number}' for key, number in value._asdict().items())}}}"

    def schema(self) -> dict[str, Any]:
        limits = zip(self.made._fields, self.most, strict=True)
        return {
            "type": ["object", "null"],
            "properties": {name: {"type": "integer", "minimum": 1, "maximum": most} for name, most in limits},
            "required": list(self.made._fields),
            "additionalProperties": False,
        }

    def expected(self) -> str:
        return f"{self.shown} (up to {' and '.join(map(str, dict.fromkeys(self.most)))}) or null"


@dataclass(frozen=True, slots=True)
class Assumptions(OptionKind):
    """Comments by process, and of what marks under "marks"."""

    words: tuple[str, ...]

    def read(self, node: yaml.Node) -> dict[str, tuple[str, ...]]:
        if not isinstance(node, yaml.MappingNode):
            raise self.refuse(node)
        inner, told = Problems(""), Blocks(Block(holes=POWERS))
        values = {key: value for key, _, value in entries(node, inner, "it")}
        if inner.found or not set(values) <= set(self.words):
            raise self.refuse(node)
        return {key: told.read(value) for key, value in values.items()}

    def write(self, value: dict[str, tuple[str, ...]]) -> str:
        return yaml.safe_dump({k: list(v) for k, v in value.items()}, default_flow_style=True, width=1e9).strip()

    def schema(self) -> dict[str, Any]:
        told = Blocks(Block(holes=POWERS)).schema()
        return {
            "type": "object",
            "properties": dict.fromkeys(self.words, told),
            "additionalProperties": False,
        }

    def expected(self) -> str:
        return f"lists of comments under {', '.join(self.words[:-1])} or {self.words[-1]}"


@dataclass(frozen=True, slots=True)
class Words(OptionKind):
    """A list of some of a few words."""

    words: tuple[str, ...]

    def read(self, node: yaml.Node) -> tuple[str, ...]:
        if not isinstance(node, yaml.SequenceNode) or not node.value:
            raise self.refuse(node)
        found = tuple(str(one.value) for one in node.value if isinstance(one, yaml.ScalarNode))
        if len(found) < len(node.value) or not set(found) <= set(self.words):
            raise self.refuse(node)
        return found

    def write(self, value: tuple[str, ...]) -> str:
        return f"[{', '.join(value)}]"

    def schema(self) -> dict[str, Any]:
        return {"type": "array", "minItems": 1, "items": {"enum": list(self.words)}}

    def expected(self) -> str:
        return f"a list of {', '.join(self.words)}"


def _names(text: str) -> list[tuple[str, str | None, str | None]]:
    """The `{name}`s of a text, each with its format and conversion; ("", …) where its braces do not match."""
    try:
        return [(name, spec, turn) for _, name, spec, turn in string.Formatter().parse(text) if name is not None]
    except ValueError:
        return [("", None, None)]
