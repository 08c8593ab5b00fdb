"""A dialect: how one family of controls wants its program spelt. Data, a file each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from kerfwise.rules.options.kind import Choice, Flag, Number, Pairs, Text, TextOrWord
from kerfwise.rules.options.option import option, setting
from kerfwise.rules.options.quantities import LENGTH, OrWord, positive
from kerfwise.rules.profile.plant_sections import PROCESSES, PierceDwell, Process

from .blocks import (
    DWELL,
    MOST_COUNT,
    POWERS,
    Also,
    AlsoList,
    Assumptions,
    Block,
    Blocks,
    Counted,
    Group,
    Keyed,
    LineNumbers,
    Powers,
    ProgramNumber,
    SomeOrAll,
    Words,
)

ControlName = Literal["linuxcnc-qtplasmac", "linuxcnc", "grbl", "eia", "burny", "essi", "essi-radius"]
ArcCentre = Literal["relative", "absolute", "radius", "none"]
Positions = Literal["absolute", "incremental"]
INCH_MM = 25.4
Modal = Literal["motion", "x", "y", "feed"]
Rotary = Literal["A", "B", "C"]
FEEDS = ("mm_min", "m_min", "in_min", "mm_s", "cm_s")
"""The names of a feed in a block, by its unit."""
PLANT = ("material", "thickness", "kerf", "amps", "volts", "gas", "pierce_height", "cut_height", "process")
"""The names of what a profile, or its chart's row, says of the material."""
_TEXT, _BLOCK = Text(), Block()
_WORD = Block(holes=(*POWERS, *PLANT))
_TOOL = Blocks(Block(holes=(DWELL, *FEEDS, *POWERS, *PLANT)), some=True)
_LINE, _ARC = Block(holes=("x", "y"), empty=True), Block(holes=("x", "y", "i", "j", "r"))


@dataclass(frozen=True, slots=True)
class Dwell:
    """How a control is told to wait: by which letter of G4, in seconds or in milliseconds."""

    letter: str = setting("P", Choice(("P", "X", "F", "S", "U", "K", "R", "H")), "its letter")
    unit: Literal["s", "ms"] = setting("s", Choice(("s", "ms")), "what it counts")


@dataclass(frozen=True, slots=True)
class Reads:
    """What a control makes of its programs otherwise than `control`, which it is like."""

    title: str | None = setting(None, TextOrWord("unknown"), "the control's own name")
    means: tuple[tuple[str, str], ...] = setting(
        (),
        Pairs(),
        "words of its own, each with what `control` calls the same: {M70: M07, CR=: R, 'PU{x},{y};': 'G0 X{x} Y{y}'}",
    )
    fixed: tuple[str, ...] = setting((), Blocks(), "G words that are in force without being said, such as G21 or G91")
    dwell: Dwell | None = setting(None, Group(Dwell), "how a wait is told")
    step_mm: float | None = setting(None, LENGTH, "what 1 is in its coordinates, where that is no mm and no inch")
    feed: Literal["units_min", "mm_min", "m_min", "in_min", "mm_s", "cm_s"] = setting(
        "units_min",
        Choice(("units_min", *FEEDS)),
        "what F counts (units_min: its units a minute, mm or inches, as most do)",
    )
    longest: int | None = setting(None, Number(10, 252, whole=True), "bytes of the longest line that it takes")
    modal: bool = setting(True, Flag(), "whether a motion word holds until another comes: else each move says its")


@dataclass(frozen=True, slots=True)
class Turning:
    """How a control has the head of a tilted torch turn, where that is not simply an axis with X and Y.

    With the torch off it turns in a block of its own, behind the one that travels; it does not tilt while it turns.
    """

    before: tuple[str, ...] = setting(
        (), Blocks(none=True), "leaves the turning to the program, before the first such cut"
    )
    feed: Literal["rpm", "deg_min"] = setting(
        "rpm", Choice(("rpm", "deg_min")), "what F counts where the head moves on the spot"
    )


@dataclass(frozen=True, slots=True)
class Subprogram:
    """How a path that comes again and again is written once, counting from where it begins, and called."""

    call: str = setting("M98 P{sub}", Block(needs=("sub",)), "calls it, by its number {sub}")
    begin: str = setting("O{sub}", Block(needs=("sub",)), "begins it, behind the program's end")
    end: str = setting("M99", _BLOCK, "ends it")
    first: int = setting(9001, Number(1, 99999, whole=True), "the number of the first")
    stepwise: str = setting("G91", _BLOCK, "places count from the last one")
    from_zero: str = setting("G90", _BLOCK, "places count from zero again")


@dataclass(frozen=True, slots=True)
class KerfByControl:
    """How a control is told to keep half the kerf beside the contour, which then stands in the program itself.

    The torch runs up to each pierce in the direction of its lead-in, as controls ask for.
    """

    left: str = setting("G41 D1", _WORD, "the torch keeps to the left of the path; {kerf} is the whole kerf")
    right: str = setting("G42 D1", _WORD, "the torch keeps to the right of the path")
    off: str = setting("G40", _BLOCK, "the torch is on the path again, from the next move on")
    run_up_mm: float = setting(
        5.0, positive(LENGTH), "how far the torch runs up to the pierce, off; half the kerf at least"
    )


@dataclass(frozen=True, slots=True)
class Around:
    """Blocks before what cuts a kind of contour starts, and behind where it stops."""

    before: tuple[str, ...] = setting((), Blocks(_WORD, none=True), "before it starts")
    after: tuple[str, ...] = setting((), Blocks(_WORD, none=True), "after it has stopped")


NOTHING_AROUND = Around()
KINDS = ("outer", "hole", "small_hole", "slit", "scrap", "mark")
"""What cuts may differ in: contours of parts, holes that are cut slower, slots of one pass, the skeleton, and marks."""


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
            Assumptions((*PROCESSES, "marks", "torches", "bevels", "block")),
            "what each program assumes of the machine, a comment each",
        )
    )
    header: tuple[str, ...] = field(
        metadata=option(
            Blocks(Block(holes=("program", *PLANT))),
            "blocks before the first cut, with {program} for the program's number, and of the material "
            + ", ".join(f"{{{name}}}" for name in PLANT),
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
    feed: str = field(
        metadata=option(Block(needs=FEEDS), "the feed word, with {mm_min}, {m_min}, {in_min}, {mm_s} or {cm_s}")
    )
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
        metadata=option(
            Counted(
                LineNumbers, "{start: 10, step: 10}, with highest: 9999 where there is one", (*(MOST_COUNT,) * 2, 10**9)
            ),
            "N words, or null for none",
        )
    )
    decimals: int = field(metadata=option(Number(0, 6, whole=True), "digits after the decimal point of a coordinate"))
    max_line: int = field(metadata=option(Number(80, 252, whole=True), "longest block that the control takes, bytes"))
    verified_by: tuple[str, ...] = setting(
        (), Blocks(), "outside readers that agree with what is written, none if nobody looked"
    )
    positions: Positions = setting(
        "absolute", Choice(get_args(Positions)), "whether X and Y count from the last position"
    )
    chord_mm: float = setting(0.01, LENGTH, "how far chords may be off an arc, where there are no arcs")
    greatest_sweep_deg: float = setting(
        180.0, Number(1, 180), "how far an arc may turn, in degrees: longer ones are written in equal pieces"
    )
    feed_alone: bool = setting(False, Flag(), "whether the feed is a block of its own, before the path")
    height_off: tuple[str, ...] = setting(
        (), Blocks(none=True), "stops height control, in a small hole cut at its own feed"
    )
    height_on: tuple[str, ...] = setting((), Blocks(none=True), "starts it again")
    tab_begin: tuple[str, ...] = setting(
        (), Blocks(none=True), "puts the beam out over a tab, in motion; null for what torch_off says"
    )
    tab_end: tuple[str, ...] = setting(
        (),
        Blocks(Block(holes=(*FEEDS, *POWERS)), none=True),
        "lights it again; null for what torch_on says, without its wait",
    )
    program: ProgramNumber | None = setting(
        None,
        Counted(ProgramNumber, "{number: 1, digits: 8}", (3600, 8)),
        "the program's number on the control, or null",
    )

    torch_station: tuple[str, ...] = setting(
        (), Blocks(none=True), "selects the torch, before the first cut and where a mark came before"
    )
    mark_station: tuple[str, ...] = setting(
        (), Blocks(none=True), "selects what marks, before a mark where a cut came before"
    )
    torch_select: tuple[str, ...] = setting(
        (),
        Blocks(Block(holes=("torch", "output")), none=True),
        "has a further torch burn with the first: {torch} counts from 2, {output} from 1; null for none",
    )
    torch_deselect: tuple[str, ...] = setting(
        (), Blocks(Block(holes=("torch", "output")), none=True), "has it burn no more"
    )
    scale: float = setting(1.0, Number(0.001, 1000), "what 1 mm is in a program: 10 where it counts in 0.1 mm")
    signed: bool = setting(False, Flag(), "whether a coordinate has its sign always, + or -, zero too")
    powers: Powers | None = setting(
        None,
        Counted(Powers, "{cut: 1000, pierce: 1000, mark: 200, full: 1000}", (100_000,) * 4),
        "S words for {power}, {pierce_power}, {mark_power} where a profile says none, and that of 100 %; or null",
    )

    also: tuple[Also, ...] = setting(
        (), AlsoList(), "words that its control knows besides, which touch neither the path nor the torch"
    )
    reads: Reads | None = setting(None, Group(Reads), "what its control makes of words otherwise than `control` does")
    around: tuple[tuple[str, Around], ...] = setting((), Keyed(KINDS, Group(Around)), "blocks around a kind of contour")
    units: Literal["mm", "inch"] = setting(
        "mm", Choice(("mm", "inch")), "units of lengths and feeds; header says them, too"
    )
    newline: Literal["lf", "crlf"] = setting("lf", Choice(("lf", "crlf")), "how a line ends")
    modal: tuple[Modal, ...] = setting(
        (), SomeOrAll(get_args(Modal)), "words that are said only where they change; true for all"
    )
    blanks: bool = setting(True, Flag(), "whether blanks stand between words")
    trailing_zeros: bool = setting(False, Flag(), "whether numbers have all their decimals, zeros too")
    whole_digits: int = setting(1, Number(1, 8, whole=True), "digits before the decimal point at least: 4 for X0010.5")
    whole_point: bool = setting(False, Flag(), "whether whole numbers end in a point: X10.")
    decimal: Literal[".", ","] = setting(".", Choice((".", ",")), "the decimal point, or comma")
    feed_decimals: int | None = setting(
        None, OrWord(Number(0, 6, whole=True), none="auto"), "digits after the decimal point of a feed"
    )
    subprogram: Subprogram | None = setting(
        None, Group(Subprogram), "paths of copies are written once, and called; {} for M98"
    )
    kerf: KerfByControl | None = setting(
        None,
        Group(KerfByControl, "control"),
        "control: contours themselves are written and the control adds the kerf (G41, G42); else it is in the path",
    )
    builders_choice: tuple[str, ...] = setting(
        (),
        SomeOrAll(("torch_on", "torch_off", "dwell")),
        "keys whose words each machine builder chooses: a copy has them changed, and this key deleted",
    )
    rotary: tuple[Rotary, ...] = setting(
        (), SomeOrAll(get_args(Rotary)), "letters of axes that tilt and turn a torch, which it moves with X and Y"
    )
    no_marking: str | None = setting(
        None, TextOrWord("unsaid"), "why there are no words for marking, and how a plant states its own"
    )
    turning: Turning | None = setting(
        None, Group(Turning), "the head turns by blocks of its own while the torch is off; null: with X and Y"
    )
    greatest_radius_mm: float | None = setting(
        None, OrWord(positive(LENGTH), none="any"), "arcs of more are written as chords"
    )

    @property
    def inch(self) -> bool:
        """Whether its programs are in inches."""
        return self.units == "inch" or abs(self.scale * INCH_MM - 1) < 1e-5

    @property
    def per_mm(self) -> float:
        """What 1 mm is in a program."""
        by_scale = abs(self.scale * INCH_MM - 1) < 1e-5  # the scale says that it is in inches, rounded
        return 1 / INCH_MM if by_scale else self.scale / INCH_MM if self.inch else self.scale

    @property
    def step_mm(self) -> float:
        """The least length that its coordinates tell."""
        return float(10**-self.decimals / self.per_mm)

    def around_kind(self, kind: str) -> Around:
        """The blocks around a kind of contour."""
        return dict(self.around).get(kind, NOTHING_AROUND)

    @property
    def travels_as_line(self) -> bool:
        """Whether it travels by lines at a feed, the torch being off."""
        return bool(re.match(r"G0*1(?![0-9])", self.rapid))

    @property
    def says_power(self) -> bool:
        """Whether its programs say with which power they cut."""
        return any("{power}" in block for block in self.torch_on)

    @property
    def marks(self) -> bool:
        """Whether it has words for marking."""
        return bool(self.mark_on)
