"""A dialect: how one family of controls wants its program spelt. Data, a file each."""

from __future__ import annotations

import string
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, get_args

import yaml

from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Text, Unfit, scalar_text
from kerfwise.rules.options.option import option
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty
from kerfwise.rules.profile.plant_sections import PROCESSES, PierceDwell, Process

# What the keys of a dialect's file may hold: blocks with places for values, lists of them, and line numbers.

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


ControlName = Literal["linuxcnc-qtplasmac", "linuxcnc", "grbl", "eia", "burny", "essi", "essi-radius"]
ArcCentre = Literal["relative", "absolute", "radius", "none"]
Positions = Literal["absolute", "incremental"]
_TEXT, _BLOCK = Text(), Block()
_TOOL = Blocks(Block(holes=(DWELL, "mm_min", *POWERS)), some=True)
_LINE, _ARC = Block(holes=("x", "y"), empty=True), Block(holes=("x", "y", "i", "j", "r"))


@dataclass(frozen=True, slots=True)
class Dialect:
    """What a control wants to read.

    Keys without a default stand in each file. A block is a line of the program. In a block `{name}` stands for a value,
    and nothing but the names told here may stand in braces.
    """

    name: str = field(metadata=option(_TEXT, "the name that a profile uses"))
    title: str = field(metadata=option(_TEXT, "the control's own name"))
    suffix: str = field(metadata=option(_TEXT, "the ending of its files"))
    control: ControlName = field(
        metadata=option(
            Choice(get_args(ControlName)), "which of the check's readers reads its programs back, with words of its own"
        )
    )
    processes: tuple[Process, ...] = field(
        metadata=option(Words(PROCESSES), "the processes that it is for; others are refused")
    )
    assumes: Mapping[str, tuple[str, ...]] = field(
        metadata=option(
            Assumptions((*PROCESSES, "marks", "torches")), "what each program assumes of the machine, a comment each"
        )
    )
    header: tuple[str, ...] = field(
        metadata=option(
            Blocks(Block(holes=("program",))), "blocks before the first cut, with {program} for the program's number"
        )
    )
    footer: tuple[str, ...] = field(metadata=option(Blocks(some=True), "blocks after the last cut: the program's end"))
    torch_on: tuple[str, ...] = field(
        metadata=option(
            _TOOL, "what starts the torch; {dwell} alone is where it waits for the pierce, else it waits behind all"
        )
    )
    torch_off: tuple[str, ...] = field(metadata=option(Blocks(some=True), "what stops the torch"))
    mark_on: tuple[str, ...] = field(
        metadata=option(Blocks(_TOOL.each, none=True), "what starts the tool that marks; null for none")
    )
    mark_off: tuple[str, ...] = field(metadata=option(Blocks(none=True), "what stops it"))
    rapid: str = field(
        metadata=option(_LINE, 'travel: a word, or a block with {x} and {y}; "" where controls tell it by the torch')
    )
    line: str = field(metadata=option(_LINE, "a line with the torch on, as rapid"))
    arc_cw: str = field(metadata=option(_ARC, "an arc clockwise: a word, or a block with {x}, {y}, {i}, {j}, {r}"))
    arc_ccw: str = field(metadata=option(_ARC, "an arc counter-clockwise, as arc_cw"))
    arc_centre: ArcCentre = field(
        metadata=option(
            Choice(get_args(ArcCentre)),
            "whether I and J count from the arc's start (relative) or from the origin (absolute), or R stands for them "
            "(radius), or there are no arcs (none) and chords are written",
        )
    )
    feed: str = field(metadata=option(Block(needs=("mm_min",)), "the feed word, with {mm_min}"))
    dwell: tuple[str, ...] = field(
        metadata=option(
            Blocks(Block(holes=("seconds", "milliseconds")), some=True),
            "the blocks that wait, one of them with {seconds} or {milliseconds}",
        )
    )
    pierce_dwell: PierceDwell = field(
        metadata=option(
            Choice(("machine", "program")), "whether the program waits for the pierce, or the machine does so by itself"
        )
    )
    comment: str | None = field(
        metadata=option(
            Block(needs=("text",), none=True),
            "a block that only a person reads, with {text}; null where there are none",
        )
    )
    line_numbers: LineNumbers | None = field(
        metadata=option(Counted(LineNumbers, "{start: 10, step: 10}"), "N words, or null for none")
    )
    decimals: int = field(metadata=option(Number(0, 6, whole=True), "digits after the decimal point of a coordinate"))
    max_line: int = field(metadata=option(Number(80, 252, whole=True), "longest block that the control takes, bytes"))
    verified_by: tuple[str, ...] = field(
        default=(), metadata=option(Blocks(), "outside readers that agree with what is written, none if nobody looked")
    )
    positions: Positions = field(
        default="absolute", metadata=option(Choice(get_args(Positions)), "whether X and Y count from the last position")
    )
    chord_mm: float = field(
        default=0.01, metadata=option(LENGTH, "how far chords may be off an arc, where there are no arcs")
    )
    greatest_sweep_deg: float = field(
        default=180.0,
        metadata=option(Number(1, 180), "how far an arc may turn, in degrees: longer ones are written in equal pieces"),
    )
    feed_alone: bool = field(
        default=False, metadata=option(Flag(), "whether the feed is a block of its own, before the path")
    )
    height_off: tuple[str, ...] = field(
        default=(), metadata=option(Blocks(none=True), "stops height control, in a small hole cut at its own feed")
    )
    height_on: tuple[str, ...] = field(default=(), metadata=option(Blocks(none=True), "starts it again"))
    tab_begin: tuple[str, ...] = field(
        default=(),
        metadata=option(Blocks(none=True), "puts the beam out over a tab, in motion; null for what torch_off says"),
    )
    tab_end: tuple[str, ...] = field(
        default=(),
        metadata=option(
            Blocks(Block(holes=("mm_min", *POWERS)), none=True),
            "lights it again; null for what torch_on says, without its wait",
        ),
    )
    program: ProgramNumber | None = field(
        default=None,
        metadata=option(
            Counted(ProgramNumber, "{number: 1, digits: 8}", (3600, 8)), "the program's number on the control, or null"
        ),
    )

    torch_station: tuple[str, ...] = field(
        default=(),
        metadata=option(Blocks(none=True), "selects the torch, before the first cut and where a mark came before"),
    )
    mark_station: tuple[str, ...] = field(
        default=(), metadata=option(Blocks(none=True), "selects what marks, before a mark where a cut came before")
    )
    torch_select: tuple[str, ...] = field(
        default=(),
        metadata=option(
            Blocks(Block(holes=("torch", "output")), none=True),
            "has a further torch burn with the first: {torch} counts from 2, {output} from 1; null for none",
        ),
    )
    torch_deselect: tuple[str, ...] = field(
        default=(), metadata=option(Blocks(Block(holes=("torch", "output")), none=True), "has it burn no more")
    )
    scale: float = field(
        default=1.0, metadata=option(Number(0.001, 1000), "what 1 mm is in a program: 10 where it counts in 0.1 mm")
    )
    signed: bool = field(
        default=False, metadata=option(Flag(), "whether a coordinate has its sign always, + or -, zero too")
    )
    powers: Powers | None = field(
        default=None,
        metadata=option(
            Counted(Powers, "{cut: 1000, pierce: 1000, mark: 200, full: 1000}", (100_000,) * 4),
            "S words for {power}, {pierce_power}, {mark_power} where a profile says none, and that of 100 %; or null",
        ),
    )

    @property
    def step_mm(self) -> float:
        """The least length that its coordinates tell."""
        return float(10**-self.decimals / self.scale)

    @property
    def says_power(self) -> bool:
        """Whether its programs say with which power they cut."""
        return any("{power}" in block for block in self.torch_on)

    @property
    def marks(self) -> bool:
        """Whether it has words for marking."""
        return bool(self.mark_on)
