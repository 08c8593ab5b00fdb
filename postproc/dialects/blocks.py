"""What the keys of a dialect's file may hold: blocks with places for values, lists of them, and counted things."""

from __future__ import annotations

import string
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, cast, get_args

import yaml

from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Flag, Number, OptionKind, Unfit, scalar_text
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty

DWELL = "dwell"
"""The name of the place in a list of blocks where the torch waits for the pierce."""
POWERS = ("power", "pierce_power", "mark_power")
"""The names of the S words of a laser in a block."""
MOST_COUNT = 1000


class LineNumbers(NamedTuple):
    """The N word of the first block, the step from block to block, and the greatest number: then it starts again."""

    start: int
    step: int
    highest: int = 0


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
        result: dict[str, Any] = {"type": ["string", "null"] if self.none else "string"}
        if not self.empty:
            result["minLength"] = 1
        if self.needs:
            result["pattern"] = r"\{(" + "|".join(self.needs) + r")\}"
        return result

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
        if inner.found or not self._needed <= set(values) <= set(self.made._fields):
            raise self.refuse(node)
        limits = dict(zip(self.made._fields, self.most, strict=True))
        return self.made(**{key: int(Number(1, limits[key], whole=True).read(one)) for key, one in values.items()})

    @property
    def _needed(self) -> set[str]:
        return set(self.made._fields) - set(self.made._field_defaults)

    def write(self, value: LineNumbers | ProgramNumber | Powers | None) -> str:
        if value is None:
            return "null"
        items = value._asdict().items()
        return f"{{{', '.join(f'{key}: {number}' for key, number in items if number)}}}"

    def schema(self) -> dict[str, Any]:
        limits = zip(self.made._fields, self.most, strict=True)
        return {
            "type": ["object", "null"],
            "properties": {name: {"type": "integer", "minimum": 1, "maximum": most} for name, most in limits},
            "required": [name for name in self.made._fields if name in self._needed],
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
        inner, kind = Problems(""), Blocks(Block(holes=POWERS))
        values = {key: value for key, _, value in entries(node, inner, "it")}
        if inner.found or not set(values) <= set(self.words):
            raise self.refuse(node)
        return {key: kind.read(value) for key, value in values.items()}

    def write(self, value: dict[str, tuple[str, ...]]) -> str:
        return yaml.safe_dump({k: list(v) for k, v in value.items()}, default_flow_style=True, width=1e9).strip()

    def schema(self) -> dict[str, Any]:
        kind = Blocks(Block(holes=POWERS)).schema()
        return {
            "type": "object",
            "properties": dict.fromkeys(self.words, kind),
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


Where = Literal["anywhere", "header", "off", "on"]
_HOLE = "a pattern such as G59 V{n} F{n}, in which each {…} stands for a number"


class Also(NamedTuple):
    """Words that touch neither the path nor the torch, and where they may stand: before the first cut (header), with
    the torch off, with it on, or anywhere."""

    words: str
    where: Where = "anywhere"


@dataclass(frozen=True, slots=True)
class AlsoList(OptionKind):
    """Words that a control knows besides, each a text, or `{words: …, where: …}`."""

    def read(self, node: yaml.Node) -> tuple[Also, ...]:
        if is_empty(node):
            return ()
        if not isinstance(node, yaml.SequenceNode):
            raise self.refuse(node)
        return tuple(self._one(one) for one in node.value)

    def _one(self, node: yaml.Node) -> Also:
        if isinstance(node, yaml.ScalarNode):
            return Also(self._words(node))
        inner = Problems("")
        values = {key: value for key, _, value in entries(node, inner, "it")}
        if inner.found or "words" not in values or not set(values) <= set(Also._fields):
            raise self.refuse(node)
        where = values["where"].value if "where" in values else "anywhere"
        where = {"true": "on", "false": "off"}.get(where, where)  # as YAML 1.1 has them
        if where not in get_args(Where):
            raise Unfit(f"where: expected one of {', '.join(get_args(Where))}, got {where!r}", values["where"])
        return Also(self._words(values["words"]), cast("Where", where))

    def _words(self, node: yaml.Node) -> str:
        text = scalar_text(node, self).strip()
        names = _names(text)
        if not text.isprintable() or not text or any(not name or spec or turn for name, spec, turn in names):
            raise Unfit(f"expected {_HOLE}, got {text!r}", node)
        return text

    def write(self, value: tuple[Also, ...]) -> str:
        shown = [one.words if one.where == "anywhere" else one._asdict() for one in value]
        return yaml.safe_dump(shown, default_flow_style=True, width=1e9, sort_keys=False).strip()

    def schema(self) -> dict[str, Any]:
        properties = {"words": {"type": "string", "minLength": 1}, "where": {"enum": list(get_args(Where))}}
        pair = {"type": "object", "properties": properties, "required": ["words"], "additionalProperties": False}
        return {"type": ["array", "null"], "items": {"anyOf": [{"type": "string", "minLength": 1}, pair]}}

    def expected(self) -> str:
        return f"a list of {_HOLE}, or of {{words: …, where: header, off, on or anywhere}}"


@dataclass(frozen=True, slots=True)
class Group(OptionKind):
    """The options of the dataclass `owner`, each with its default, under one key; or null.

    A `word` stands for all of them as they are.
    """

    owner: type
    word: str = ""

    def read(self, node: yaml.Node) -> Any:
        if is_empty(node):
            return None
        if self.word and isinstance(node, yaml.ScalarNode) and node.value == self.word:
            return self.owner()
        if not isinstance(node, yaml.MappingNode):
            raise self.refuse(node)
        inner, known = Problems(""), {one.key: one for one in options_of(self.owner)}
        values: dict[str, object] = {}
        for key, key_node, value in entries(node, inner, "it"):
            if key not in known:
                raise Unfit(unknown("key", key, known), key_node)
            try:
                values[known[key].name] = known[key].kind.read(value)
            except Unfit as error:
                raise Unfit(f"{key}: {error}", error.node or value) from None
        if inner.found:
            raise self.refuse(node)
        return self.owner(**values)

    def write(self, value: Any) -> str:
        if value is None:
            return "null"
        options = [one for one in options_of(self.owner) if getattr(value, one.name) != one.default]
        return f"{{{', '.join(f'{one.key}: {one.kind.write(getattr(value, one.name))}' for one in options)}}}"

    def schema(self) -> dict[str, Any]:
        members = {one.key: {"description": one.help, **one.kind.schema()} for one in options_of(self.owner)}
        group = {"type": ["object", "null"], "properties": members, "additionalProperties": False}
        return {"anyOf": [{"const": self.word}, group]} if self.word else group

    def expected(self) -> str:
        group = "a mapping of " + ", ".join(one.key for one in options_of(self.owner))
        return f"{self.word}, or {group}" if self.word else group


@dataclass(frozen=True, slots=True)
class Keyed(OptionKind):
    """A mapping of some of a few words, each to what `each` reads: kept as pairs."""

    words: tuple[str, ...]
    each: OptionKind

    def read(self, node: yaml.Node) -> tuple[tuple[str, Any], ...]:
        if is_empty(node):
            return ()
        inner, made = Problems(""), dict[str, Any]()
        for key, key_node, value in entries(node, inner, "it"):
            if key not in self.words:
                raise Unfit(unknown("key", key, self.words), key_node)
            try:
                made[key] = self.each.read(value)
            except Unfit as error:
                raise Unfit(f"{key}: {error}", error.node or value) from None
        if inner.found:
            raise self.refuse(node)
        return tuple(made.items())

    def write(self, value: tuple[tuple[str, Any], ...]) -> str:
        return f"{{{', '.join(f'{key}: {self.each.write(one)}' for key, one in value)}}}"

    def schema(self) -> dict[str, Any]:
        properties = dict.fromkeys(self.words, self.each.schema())
        return {"type": ["object", "null"], "properties": properties, "additionalProperties": False}

    def expected(self) -> str:
        return f"{self.each.expected()} under {', '.join(self.words[:-1])} or {self.words[-1]}"


@dataclass(frozen=True, slots=True)
class SomeOrAll(OptionKind):
    """A list of some of a few words; true for all of them, false for none."""

    words: tuple[str, ...]

    def read(self, node: yaml.Node) -> tuple[str, ...]:
        if isinstance(node, yaml.ScalarNode):
            return self.words if Flag().read(node) else ()
        return Words(self.words).read(node)

    def write(self, value: tuple[str, ...]) -> str:
        return "true" if value == self.words else "false" if not value else Words(self.words).write(value)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"type": "boolean"}, Words(self.words).schema()]}

    def expected(self) -> str:
        return f"true, false, or {Words(self.words).expected()}"


def _names(text: str) -> list[tuple[str, str | None, str | None]]:
    """The `{name}`s of a text, each with its format and conversion; ("", …) where its braces do not match."""
    try:
        return [(name, spec, turn) for _, name, spec, turn in string.Formatter().parse(text) if name is not None]
    except ValueError:
        return [("", None, None)]
