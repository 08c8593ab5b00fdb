"""Programs in ESSI (ISO 6582), as plasma and oxyfuel controls without letters read them; a reader of its own.

    71        mm
    81        each move counts from the last
    5         rapid on
    +200+150  20 mm to the right, 15 mm up
    6         rapid off
    53        torch on
    39+2500   feed
    +1000+    100 mm to the right
    54        torch off
    0         end

A block is a number without a sign, or one with a sign and a value behind it, or a move: signed numbers of 0.1 mm. An
arc has five: to its end, to its centre, and a sign (+ counter-clockwise); or to its end, its radius, a sign for the
long way round (+), and one for the direction (+ clockwise). Only its control says which: the two cannot be told apart.
What starts a tool has its own number that stops it, the next. Where the last block is 0, any 0 ends the program; else
it stops it.
What is not known, or shifts the path (kerf, mirrors, subprograms), is refused with the line. Sources: Hypertherm
809550, Thermal Dynamics 0-5399, Plasmatic's Precision Layout; the standard itself is not public.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point, Segment

from .controls import AS_IT_COMES, Control, Setup, in_file, rows_of
from .program import LineEffect, NcProgram, State, Track
from .tools import ToolsOn, finish_program
from .words import Block, arc_by_centre, arc_by_radius

_AUXILIARY = re.compile(r"(?P<code>[0-9]{1,5})(?:(?P<sign>[+-])(?P<value>[0-9]{0,8}))?")
_MOVE = re.compile(r"(?:[+-][0-9]{0,8})+")
_FIELD = re.compile(r"[+-][0-9]{0,8}")
_ENDS = frozenset({0, 63, 64, 90, 99})
_STARTS: Mapping[int, int] = {7: 0, 53: 0, 9: 1, 13: 1}
_STOPS: Mapping[int, int] = {8: 0, 54: 0, 10: 1, 14: 1}
_HEIGHT: Mapping[int, bool] = {47: False, 68: False, 48: True, 67: True}
"""What starts height control, and what stops it."""
_SETS: Mapping[str, str] = {
    "5": "rapid", "6": "rapid", "39": "F", "45": "sensor", "46": "sensor", "47": "height", "48": "height",
    "67": "height", "68": "height", "71": "units", "81": "distance",
}  # fmt: skip
"""What a number sets that stays in force."""
_KERF = "the control would shift the path by its own kerf, which the program does not show; post it with the kerf in it"
_REFUSED: Mapping[int, str] = {
    29: _KERF,
    30: _KERF,
    40: _KERF,
    70: "inches are not checked; post it in mm",
    82: "moves that count from the origin are not checked; post it with each from the last (81)",
    83: "it moves the origin; post it without",
    65: "it loads another program on the control, which is not checked; post it with 0 at its end",
}
OBEYED = frozenset({5, 6, 39, 41, 71, 81, *_ENDS, *_STARTS, *_STOPS, *_REFUSED})
"""Numbers that move, switch, wait, or say how what follows is meant."""
_FEED_MM_MIN = (1.0, 1e6)
_FARTHEST_MM = 2e6
_WAIT_MS = 3_600_000


@dataclass(slots=True)
class _Tools(ToolsOn):
    """Tools that bare numbers switch."""

    def switch(self, block: Block, motion: float | None, modal: float | None) -> None:
        """Nothing: no block of ESSI does two things."""


@dataclass(slots=True)
class _Program:
    """What a program has done and said so far."""

    track: Track
    tools: _Tools
    control: Control
    feed_mm_min: float = 0.0
    rapid: bool | None = None
    said: set[int] = field(default_factory=set)
    lit: dict[int, int] = field(default_factory=dict)
    blocks: int = 0

    def run(self, line: int, text: str) -> None:
        """One block. Raises InputError with the line, for what is malformed, not understood, or not checked."""
        self.blocks += 1
        if any(also.pattern.fullmatch(text) for also in self.control.also):
            return
        if text[0] in "+-":
            if not _MOVE.fullmatch(text):
                raise _refused(line, f"cannot read {text[:40]!r}: expected signed numbers such as +1000-250")
            self._move(line, _FIELD.findall(text))
            return
        found = _AUXILIARY.fullmatch(text)
        if found is None:
            raise _refused(line, f"cannot read {text[:40]!r}: expected a number such as 53, or 39+2500")
        self._auxiliary(line, int(found["code"]), found["sign"], found["value"] or "")

    def _auxiliary(self, line: int, code: int, sign: str | None, value: str) -> None:
        if why := _REFUSED.get(code):
            raise _refused(line, f"{code} is not supported here: {why}")
        if code in (39, 41):
            if sign != "+" or not value:
                raise _refused(line, f"{code} without a value: expected such as {code}+2500")
            self._valued(line, code, int(value))
            return
        if sign is not None:
            raise _refused(line, f"{code}{sign}{value} is not understood, and not supported here")
        if code in _STARTS:
            before = self.lit.setdefault(_STARTS[code], code)
            if before != code:
                raise _refused(line, f"{code} where {before} has started before: two processes are not supported here")
            self.tools.start(_STARTS[code], line)
        elif code in _STOPS:
            if _STOPS[code] in self.tools.on and self.lit[_STOPS[code]] != code - 1:
                raise _refused(line, f"{code} does not stop what {self.lit[_STOPS[code]]} has started")
            self.tools.stop(_STOPS[code])
        elif code in _HEIGHT:
            self.tools.hold(_HEIGHT[code], line)
        elif code in (5, 6):
            self.rapid = code == 5
        elif code in (71, 81):
            self.said.add(code)
        elif code == 0:
            if self.tools.on:
                self.track.fault(line, "torch-off-travel", "0 stops the program while the torch is on")
        elif code == 63:
            self.tools.stop(-1)
        elif code not in (38, 45, 46):
            raise _refused(line, f"{code} is not understood, and not supported here; post the program without")

    def _valued(self, line: int, code: int, value: int) -> None:
        if code == 39:
            low, high = _FEED_MM_MIN
            if not low <= value <= high:
                raise _refused(line, f"a feed of {value} mm/min is not supported here: expected {low:g} to {high:g}")
            self.feed_mm_min = float(value)
        elif value > _WAIT_MS:
            raise _refused(line, f"a wait of {value} ms is not supported here: expected {_WAIT_MS} at most")
        else:
            self.track.wait(value / 1000)

    def _move(self, line: int, fields: list[str]) -> None:
        if len(fields) not in (2, 5):
            raise _refused(line, f"a move of {len(fields)} numbers: expected 2 for a line, 5 for an arc")
        missing = [text for code, text in ((71, "its units (71)"), (81, "how it counts (81)")) if code not in self.said]
        if missing:
            self.said |= {71, 81}
            self.track.fault(line, "program-state", f"it moves before it has said {' and '.join(missing)}")
        step, (x, y) = self.control.step_mm, self.track.at
        dx, dy, *rest = map(_number, fields)
        end = (x + dx * step, y + dy * step)
        if max(abs(end[0]), abs(end[1])) > _FARTHEST_MM:
            raise _refused(line, "the move leads more than 2 km away: not supported here")
        segments: tuple[Segment, ...] = (Segment((x, y), end),)
        if rest:
            segments = self._arc(line, end, fields)
        on = self.track.open is not None
        if self.rapid or (self.rapid is None and not on):
            if rest:
                raise _refused(line, "an arc as a rapid: not supported here; say 6 before it")
            self.track.rapid(end, line)
            return
        if self.feed_mm_min <= 0:
            raise _refused(line, "a line or an arc with no feed; say such as 39+2500 before it")
        for segment in segments:
            self.track.feed(segment, self.feed_mm_min / 60, line)
        self.track.at = end

    def _arc(self, line: int, end: Point, fields: list[str]) -> tuple[Segment, ...]:
        """An arc: its numbers are rounded to whole steps, so that its radius may differ by as much at its ends."""
        step, at, block = self.control.step_mm, self.track.at, Block(line)
        if len(fields[4]) > 1:
            raise _refused(line, f"an arc that ends in {fields[4]}: expected a sign alone, + or -")
        third, fourth = fields[2], fields[3]
        if self.control.arcs == "centre":
            centre = (at[0] + _number(third) * step, at[1] + _number(fourth) * step)
            return arc_by_centre(at, end, centre, fields[4] == "+", block, mismatch_mm=1.5 * step)
        if len(fourth) > 1 or third[0] == "-" or len(third) == 1:
            raise _refused(line, "an arc by its radius: expected two numbers, + and the radius, and two signs")
        radius_mm = _number(third) * step * (-1 if fourth == "+" else 1)
        return arc_by_radius(at, end, radius_mm, fields[4] == "-", block, short_mm=step)


def read_essi(
    text: str,
    control: Control,
    setup: Setup = AS_IT_COMES,
    file: str = "",
    traced: list[LineEffect] | None = None,
) -> NcProgram:
    """Read a program; as `read_nc`, for controls that read ESSI. What each of its lines changes goes into `traced`.

    Raises InputError with the line, for what is malformed, not understood or not checked, and for a program without an
    end.

    Examples
    --------
    >>> from .controls import CONTROLS
    >>> text = "71\\n81\\n5\\n+50+50\\n6\\n53\\n39+600\\n+100+\\n54\\n0\\n"
    >>> (burn,) = read_essi(text, CONTROLS["essi"]).burns
    >>> burn.path.as_rows()
    [[5.0, 5.0], [15.0, 5.0]]
    """
    track = Track(setup.travel_mm_s, setup.home)
    program = _Program(track, _Tools(track, control, setup.held_s), control)
    with in_file(file):
        blocks = list(_blocks(text, control))
        if not blocks or blocks[-1][1] not in map(str, _ENDS):
            last = blocks[-1][0] if blocks else None
            raise InputError("the program has no end: expected 0, 63, 64, 90 or 99 alone in its last line", line=last)
        for line, block in blocks[:-1]:
            if block in ("64", "90", "99", blocks[-1][1]):
                raise _refused(line, "words behind the program's end, which no control runs: not supported here")
            before = track.wait_s
            program.run(line, block)
            if traced is not None:
                state = state_after({} if not traced else traced[-1].state, block)
                travels = block[0] in "+-" and track.open is None
                waits, halts = track.wait_s > before, block == "0"
                traced.append(LineEffect(line, len(track.burns), travels, waits, halts, state))
        line = blocks[-1][0]
        return finish_program(track, program.tools, line, [], program.blocks + 1, control.step_mm)


def state_after(state: State, block: str) -> State:
    """What is in force after a block, given what was before it.

    Examples
    --------
    >>> state_after({"rapid": ("5",), "F": ("39+900",)}, "6")
    {'rapid': ('6',), 'F': ('39+900',)}
    """
    code = block.partition("+")[0]
    return state | {_SETS[code]: (block,)} if code in _SETS else dict(state)


def _blocks(text: str, control: Control) -> Iterator[tuple[int, str]]:
    """The blocks with their lines; a % at the top, and what stands between 3 and 4, are for people."""
    comment_at = 0
    begun = False
    for line, raw in rows_of(text, control.longest):
        row = raw.strip()
        if comment_at:
            comment_at = 0 if row == "4" else comment_at
        elif row == "3":
            comment_at = line
        elif row and not (row == "%" and not begun):
            yield line, row.replace(" ", "")
        begun = begun or bool(row)
    if comment_at:
        raise _refused(comment_at, "the comment is not closed: expected 4 in a line of its own")


def _number(text: str) -> int:
    return int(text + "0" if len(text) == 1 else text)


def _refused(line: int, message: str) -> InputError:
    return InputError(message, line=line)
