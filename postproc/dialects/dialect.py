"""A dialect: how one family of controls wants its program spelt. Data, a file each; `load.py` reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Flag, Number, Text
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.profile.machine_section import PROCESSES, PierceDwell, Process

from .kinds import DWELL, POWERS, Assumptions, Block, Blocks, Counted, LineNumbers, Powers, ProgramNumber, Words

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
