"""A small reader of RS274 programs of its own: what the torch does, line by line, as paths in mm.

It takes nothing from the writer: modal motion G0 to G3, G20 and G21, G90 and G91, arcs by I and J or by R, M3 and M5,
G4, and what each control has of its own (`nc_controls.py`). What it does not understand it refuses, with the line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment

from .arcs import arc_by_centre, arc_by_radius
from .controls import QTPLASMAC, Control
from .modes import Modes
from .program import Burn, Fault, NcProgram, Stretch
from .words import Block, read_blocks

_MOTION = {0.0, 1.0, 2.0, 3.0, 80.0}
_SILENT_G = {17.0, 40.0, 49.0, 54.0, 61.0, 61.1, 64.0, 92.1, 94.0, 97.0}
_HALTS = {0.0, 1.0}
_OUTPUTS = {67.0, 68.0}
_SPEED_OUTPUT = 3.0
_REFUSED_G = {
    18.0: "arcs outside the XY plane are not checked",
    19.0: "arcs outside the XY plane are not checked",
    41.0: "the control would shift the path by its own kerf, which the program does not show",
    42.0: "the control would shift the path by its own kerf, which the program does not show",
    41.1: "the control would shift the path by its own kerf, which the program does not show",
    42.1: "the control would shift the path by its own kerf, which the program does not show",
}
_SET_BIT = 64.0
_BITS = {64.0, 65.0}
_TORCH_BITS = {62.0, 63.0, 64.0, 65.0}


def read_nc(
    text: str,
    travel_mm_s: float = 100.0,
    file: str = "",
    home: Point = (0.0, 0.0),
    control: Control = QTPLASMAC,
    held_s: tuple[float, float] = (0.0, 0.0),
) -> NcProgram:
    """Read a program; `travel_mm_s` is the speed of its rapids, for the times, `home` where it finds the torch.

    The control holds the torch for `held_s` by itself where it starts to cut, and where it starts to mark.

    Raises
    ------
    InputError
        With the line, for what is malformed or not understood, and for a program without an end.

    Examples
    --------
    >>> program = read_nc("G21 G90\\nG0 X5 Y5\\nM3 $0 S1\\nG1 X15 F600\\nM5 $0\\nM2\\n")
    >>> [(burn.tool, burn.line, burn.path.length_mm) for burn in program.burns]
    [(0, 3, 10.0)]
    """
    machine = _Machine(travel_mm_s, control, held_s, home)
    line = 0
    try:
        for block in read_blocks(text):
            line = block.line
            machine.run(block)
            if machine.ended:
                break
    except InputError as error:
        raise InputError(error.message, file=file or None, line=error.line or line) from None
    if not machine.ended:
        raise InputError("the program has no end: expected M2 or M30", file=file or None, line=line or None)
    machine.close()
    if machine.on:
        machine.fault(line, "torch-off-travel", "the program ends with the torch on")
    if machine.wait_s > 0:
        machine.fault(line, "pierce-delay", f"the torch stands still for {machine.wait_s:g} s after the last cut")
    return NcProgram(
        tuple(machine.burns),
        tuple(machine.hot_rapids),
        tuple(machine.slow_travel),
        tuple(machine.faults),
        tuple(machine.comments),
        machine.idle_mm,
        tuple(machine.travels_mm),
        machine.at,
        machine.blocks,
        machine.moving_s,
        tuple(machine.rapids),
    )


@dataclass(slots=True)
class _Open:
    """A burn that has not ended yet."""

    tool: int
    line: int
    start_s: float
    rows: list[tuple[float, float, float]]
    comment: str
    travels_mm: tuple[float, ...]
    pierce_s: float = 0.0
    paused_s: float = 0.0
    feeds_mm_s: set[float] = field(default_factory=set)
    wait_s: float = 0.0
    held_s: float = 0.0


@dataclass(slots=True)
class _Machine:
    """Modal state, in the order RS274 executes a block: feed, torch, dwell, units, distance mode, motion, end."""

    travel_mm_s: float
    control: Control
    held_s: tuple[float, float]
    at: Point = (0.0, 0.0)
    unit_mm: float = 1.0
    absolute: bool = True
    centre_absolute: bool = False
    motion: float | None = None
    feed_mm_s: float = 0.0
    on: list[int] = field(default_factory=list)
    clock_s: float = 0.0
    idle_mm: float = 0.0
    moving_s: float = 0.0
    blocks: int = 0
    ended: bool = False
    comment: str = ""
    open: _Open | None = None
    burns: list[Burn] = field(default_factory=list)
    hot_rapids: list[Stretch] = field(default_factory=list)
    slow_travel: list[Stretch] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    modes: Modes = field(default_factory=Modes)
    comments: list[str] = field(default_factory=list)
    travels_mm: list[float] = field(default_factory=list)
    rapids: list[tuple[int, Point]] = field(default_factory=list)
    wait_s: float = 0.0

    def run(self, block: Block) -> None:
        self.blocks += bool(block.g or block.m or block.words)
        for text in block.comments:
            self.comment = text
            self.comments.append(text)
        words = block.words
        if "F" in words:
            self.feed_mm_s = words["F"] * self.unit_mm / 60
        for code in block.m:
            self._tool(code, block)
        if 4.0 in block.g:
            self._dwell(block)
        motions = [g for g in block.g if g in _MOTION]
        if len(motions) > 1:
            raise InputError("two motion words in one block", line=block.line)
        for code in block.g:
            self._mode(code, block)
        if motions:
            self.motion = None if motions[0] == 80.0 else motions[0]
        self.modes.said(block, self.unit_mm)
        if any(letter in words for letter in "XYIJR") and 4.0 not in block.g:
            if missing := self.modes.missing():
                self.fault(block.line, "program-state", f"it moves before it has said {missing}")
            self._move(block)
        if 2.0 in block.m or 30.0 in block.m:
            self.ended = True

    def fault(self, line: int, rule: str, text: str) -> None:
        """Note what the program does wrong."""
        self.faults.append(Fault(line, rule, text))

    def _tool(self, code: float, block: Block) -> None:
        tool = int(block.words.get("$", 0))
        if "$" in block.words and not self.control.numbered:
            raise InputError(
                f"tools by number ($) are not a word of {self.control.title}, for which the profile's dialect is",
                line=block.line,
            )
        if code == 3.0:
            if block.words.get("S", 0.0) <= 0:
                self.fault(block.line, "program-state", f"tool ${tool} is started without S1, which turns it on")
            self._on(tool, block.line)
        elif code == 5.0:
            self._off(tool)
        elif code in _BITS and self.control.marks_by is not None:
            if block.words.get("P") != self.control.marks_by:
                raise InputError(f"M{code:g} of another output than {self.control.marks_by}", line=block.line)
            if code == _SET_BIT:
                self._on(1, block.line)
            else:
                self._off(1)
        elif code in _HALTS and self.open is not None:
            self.fault(block.line, "torch-off-travel", f"M{code:g} halts the program while tool ${self.on[0]} is on")
        elif code in _OUTPUTS and self.control.speed_outputs:
            self._output(code, block)
        elif code in _TORCH_BITS:
            raise InputError(
                f"M{code:g} can stop the torch while the path goes on; this is not checked", line=block.line
            )
        elif code not in self.control.silent_m and code not in (2.0, 30.0):
            of = "" if self.control is QTPLASMAC else f" in a program for {self.control.title}, the profile's dialect"
            raise InputError(f"M{code:g} is not understood{of}", line=block.line)

    def _on(self, tool: int, line: int) -> None:
        if self.on:
            self.fault(line, "torch-off-travel", f"tool ${tool} is started while ${self.on[0]} is on")
        if tool not in self.on:
            self.on.append(tool)
        if self.open is None:
            begun = self._begin(tool, line)
            begun.held_s = self.held_s[0] if tool == 0 else self.held_s[1]
            self.clock_s += begun.held_s

    def _off(self, tool: int) -> None:
        self.on = [] if tool == -1 else [t for t in self.on if t != tool]
        if self.open is not None and self.open.tool not in self.on:
            self.close()

    def _dwell(self, block: Block) -> None:
        if "P" not in block.words or block.words["P"] < 0:
            raise InputError("G4 without its time: expected P and seconds", line=block.line)
        wait_s = block.words["P"]
        self.clock_s += wait_s
        if self.open is not None and self.open.rows:
            self.open.paused_s += wait_s
        elif self.open is not None:
            self.open.pierce_s += wait_s
        else:
            self.wait_s += wait_s

    def _output(self, code: float, block: Block) -> None:
        if "E" not in block.words or "Q" not in block.words:
            raise InputError(f"M{code:g} without E and Q", line=block.line)
        share = block.words["Q"]
        if block.words["E"] == _SPEED_OUTPUT and share not in (0.0, 100.0):
            self.fault(block.line, "feeds", f"M{code:g} E3 Q{share:g} has the torch move at {share:g} % of its feed")

    def _mode(self, code: float, block: Block) -> None:
        if code in _REFUSED_G:
            raise InputError(f"G{code:g}: {_REFUSED_G[code]}", line=block.line)
        if code in (20.0, 21.0):
            self.unit_mm = 25.4 if code == 20.0 else 1.0
        elif code in (90.0, 91.0):
            self.absolute = code == 90.0
        elif code in (90.1, 91.1):
            self.centre_absolute = code == 90.1
        elif code not in _SILENT_G and code not in _MOTION and code != 4.0:
            raise InputError(f"G{code:g} is not understood", line=block.line)

    def _move(self, block: Block) -> None:
        if self.motion is None:
            raise InputError("X, Y, I, J or R without a motion word (G0, G1, G2 or G3)", line=block.line)
        unit, words = self.unit_mm, block.words
        base = (0.0, 0.0) if self.absolute else self.at
        x = base[0] + words["X"] * unit if "X" in words else self.at[0]
        y = base[1] + words["Y"] * unit if "Y" in words else self.at[1]
        if self.motion == 0.0:
            self._rapid((x, y), block)
            return
        if self.feed_mm_s <= 0:
            raise InputError(f"G{self.motion:g} with no feed: expected an F word before", line=block.line)
        for segment in (Segment(self.at, (x, y)),) if self.motion == 1.0 else self._arc((x, y), block):
            if segment.length_mm > 0:
                self._feed(segment, block.line)
        self.at = (x, y)

    def _rapid(self, end: Point, block: Block) -> None:
        length = math.dist(self.at, end)
        self.clock_s += length / self.travel_mm_s
        tool = self.open.tool if self.open is not None else None
        if tool is not None and length > 0:
            self.hot_rapids.append(Stretch(block.line, length))
            self.close()
        self.at = end
        if tool is None:
            self._idle(length)
            self.rapids.append((block.line, end))
        elif self.open is None:
            self._begin(tool, block.line)

    def _feed(self, segment: Segment, line: int) -> None:
        self.clock_s += segment.length_mm / self.feed_mm_s
        if self.open is None:
            self._idle(segment.length_mm)
            self.rapids.append((line, segment.end))
            self.slow_travel.append(Stretch(line, segment.length_mm))
        else:
            self.moving_s += segment.length_mm / self.feed_mm_s
            self.open.feeds_mm_s.add(self.feed_mm_s)
            self.open.rows.append((*segment.start, segment.bulge))

    def _idle(self, length_mm: float) -> None:
        self.idle_mm += length_mm
        self.travels_mm.append(length_mm)

    def _begin(self, tool: int, line: int) -> _Open:
        self.open = _Open(tool, line, self.clock_s, [], self.comment, tuple(self.travels_mm), wait_s=self.wait_s)
        self.travels_mm.clear()
        self.wait_s = 0.0
        return self.open

    def close(self) -> None:
        """End the burn that is going on, if any; one that did not move is a hole and is kept."""
        if self.open is not None:
            path = Curve.of([*self.open.rows, (*self.at, 0.0)], closed=False)
            o = self.open
            feeds_mm_s = tuple(sorted(o.feeds_mm_s))
            self.burns.append(
                Burn(
                    o.tool, o.line, path, o.start_s, self.clock_s, o.comment, o.travels_mm, o.pierce_s, o.paused_s,
                    feeds_mm_s, o.wait_s, o.held_s,
                )
            )  # fmt: skip
            self.open = None

    def _arc(self, end: Point, block: Block) -> tuple[Segment, ...]:
        ccw = self.motion == 3.0
        words, unit = block.words, self.unit_mm
        if words.get("P", 1.0) != 1.0:
            raise InputError("an arc of several turns is not checked", line=block.line)
        if "R" in words:
            return arc_by_radius(self.at, end, words["R"] * unit, ccw, block.line)
        if "I" not in words and "J" not in words:
            raise InputError("an arc without I, J or R", line=block.line)
        base = (0.0, 0.0) if self.centre_absolute else self.at
        centre = (base[0] + words.get("I", 0.0) * unit, base[1] + words.get("J", 0.0) * unit)
        return arc_by_centre(self.at, end, centre, ccw, block.line)
