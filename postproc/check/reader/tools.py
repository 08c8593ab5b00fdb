"""What M words switch: the torch, the tool that marks, the laser's beam; and what halts and ends make of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

from .controls import Control
from .grammar import DWELL
from .program import NcProgram, Track
from .words import Block, Word

ALL = -1
_NO_WAIT_S = 1e-6
HALTS = frozenset({0.0, 1.0})
ENDS = frozenset({2.0, 30.0})


@dataclass(slots=True)
class ToolsOn(ABC):
    """The tools that are on; the control holds the torch for `held_s` where it starts to cut, and to mark.

    `held_from` is the line where height control was stopped in a cut, 0 where it is on; `held` the line where a tool
    was started without it.
    """

    track: Track
    control: Control
    held_s: tuple[float, float]
    on: list[int] = field(default_factory=list)
    ended: bool = False
    held_from: int = 0
    held: int = 0

    @abstractmethod
    def switch(self, block: Block, motion: float | None, modal: float | None) -> None:
        """Do what comes before a block's wait and motion.

        `motion` is the motion that it makes, None for none, and `modal` the one in force from this block on.
        """

    def halt(self, block: Block) -> None:
        """Do what comes after its motion: halts and the program's end."""
        for word in block.m:
            waits = self.control.halts_lit and self.track.open is not None and not self.track.open.rows
            if word.value in HALTS and self.on and not waits:
                self.track.fault(
                    block.line, "torch-off-travel", f"{word.text} halts the program while tool ${self.on[0]} is on"
                )
            self.ended = self.ended or word.value in ENDS

    def start(self, tool: int, line: int) -> None:
        """Start a tool where the torch stands."""
        if self.on:
            self.track.fault(line, "torch-off-travel", f"tool ${tool} is started while ${self.on[0]} is on")
        self.held = line if self.held_from else 0
        if tool not in self.on:
            self.on.append(tool)
        if self.track.open is None:
            self.track.begin(tool, line, self.held_s[0] if tool == 0 else self.held_s[1])

    def hold(self, stops: bool, line: int) -> None:
        """Stop height control, or start it again."""
        if stops:
            self.held_from = line if self.on and not self.held else self.held_from
        else:
            self.held_from = self.held = 0

    def stop(self, tool: int) -> None:
        """Stop a tool, or all; before, height control is on again, though perhaps only since the pierce was done."""
        if self.held and self.on:
            text = f"tool ${self.on[0]} burns without height control, stopped in the cut on line {self.held_from}"
            self.track.fault(self.held, "program-state", text)
            self.held_from = self.held = 0
        self.on = [] if tool == ALL else [t for t in self.on if t != tool]
        if self.track.open is not None and self.track.open.tool not in self.on:
            self.track.close()


def finish_program(
    track: Track, tools: ToolsOn, line: int, comments: Sequence[str], blocks: int, step_mm: float = 0.0
) -> NcProgram:
    """The whole program, once its last line has been run."""
    track.close()
    if tools.on:
        track.fault(line, "torch-off-travel", "the program ends with the torch on")
    if track.torches:
        text = f"the program ends with torch {track.torches[0]} selected: it would burn in the next program, too"
        track.fault(line, "program-state", text)
    if track.wait_s > tools.control.rests_s + _NO_WAIT_S:
        track.fault(line, "pierce-delay", f"the torch stands still for {track.wait_s:g} s after the last cut")
    return NcProgram(
        tuple(track.burns),
        tuple(track.hot_rapids),
        tuple(track.slow_travel),
        tuple(track.faults),
        tuple(comments),
        track.idle_mm,
        tuple(track.travels_mm),
        track.at,
        blocks,
        track.moving_s,
        tuple(track.rapids),
        step_mm=step_mm,
    )


_SET_BIT, _CLEAR_BIT, _START, _STOP = 64.0, 65.0, 3.0, 5.0
_OUTPUTS = frozenset({67.0, 68.0})


@dataclass(slots=True)
class Tools(ToolsOn):
    """The tools of a control that starts and stops each by M words; `marking` says that a process that marks is on,
    `torch_marks` that the torch itself was started to mark.

    Of `count` torches those beside the first are selected and deselected by words; `said` are those that were.
    """

    marking: bool = False
    torch_marks: bool = False
    count: int = 1
    said: set[int] = field(default_factory=set)

    def start(self, tool: int, line: int) -> None:
        """Start a tool; with several torches each must have been selected or deselected before."""
        if unsaid := sorted(set(range(2, self.count + 1)) - self.said):
            text = f"a tool starts before it is said whether torch {unsaid[0]} burns too"
            self.track.fault(line, "program-state", text)
            self.said.update(unsaid)
        if tool and self.track.torches:
            text = f"tool ${tool} marks with torch {self.track.torches[0]} selected: marks are made by one"
            self.track.fault(line, "program-state", text)
        ToolsOn.start(self, tool, line)

    def switch(self, block: Block, motion: float | None, modal: float | None) -> None:
        """Do what comes before a block's wait and motion, outputs first, as the control does.

        Raises InputError with line and column, for outputs and tools that this control does not have or that are not
        checked.
        """
        for word in sorted(block.m, key=lambda word: -word.value if word.value >= _SET_BIT else 0.0):
            if word.value in (self.control.selects, self.control.deselects) and self._stations(word, block):
                continue
            if word.value in (_SET_BIT, _CLEAR_BIT):
                self._bit(word, block)
            elif word.value in _OUTPUTS:
                self._output(word, block)
            elif word.value == self.control.process:
                self._process(word, block)
            elif word.value in self.control.heights and "P" not in block.words:
                self.hold(word.value == self.control.heights[0], block.line)
            elif word.value in self.control.starts:
                self._start(word, block)
            elif word.value in self.control.stops:
                tool = self.control.stops[word.value]
                self.stop(1 if self.marking or (self.torch_marks and tool == 0) else tool)
            elif word.value in (_START, _STOP):
                self._torch(word, block)

    def _start(self, word: Word, block: Block) -> None:
        """Start what a word of its own starts; the torch marks where words behind that say so (`means`)."""
        tool, named = self.control.starts[word.value], block.words.get("$")
        if named is not None and named.column != word.column:
            raise block.refused(f"{named.text}: {self.control.title} knows no tools by number; delete it", named)
        self.torch_marks = named is not None and tool == 0
        self.start(1 if self.marking or self.torch_marks else tool, block.line)

    def _stations(self, word: Word, block: Block) -> bool:
        """Select or deselect a torch; whether the word does that."""
        letter, less = self.control.torch_letter, self.control.torch_less
        if self.count == 1 and (less or self._of_one(word, block)):
            return False
        if letter not in block.words:
            raise block.refused(f"{word.text} without {letter} is not supported here: expected the torch", word)
        named = block.words[letter]
        torch, selects = int(named.value) + less, word.value == self.control.selects
        if named.value != int(named.value) or torch > self.count or torch < 1:
            most = f"{letter}{self.count - less}"
            have = "the profile has one torch" if self.count == 1 else f"the profile has {self.count} torches"
            text = f"{word.text} {named.text} is for another torch, {have}: expected {letter} up to {most}"
            raise block.refused(f"{text}; it is not supported here", named)
        if torch == 1:
            if less:  # the first output is for something else
                return False
            if not selects:
                self.track.fault(block.line, "program-state", f"{word.text} {named.text} deselects the first torch")
            return True
        if self.on:
            self.track.fault(block.line, "program-state", f"{word.text} {named.text} selects torches while one is on")
        self.said.add(torch)
        torches = set(self.track.torches) - {torch} | ({torch} if selects else set())
        self.track.torches = tuple(sorted(torches))
        return True

    def _of_one(self, word: Word, block: Block) -> bool:
        """Whether a word changes nothing where the profile has one torch: that is selected, or another one is not."""
        named = block.words.get(self.control.torch_letter)
        if named is None:
            return False
        return (named.value == 1) == (word.value == self.control.selects) or self.marking

    def _process(self, word: Word, block: Block) -> None:
        """Select what the words that start and stop tools switch from here on."""
        if "T" not in block.words:
            raise block.refused(f"{word.text} without T is not supported here: expected a process, such as T1", word)
        if self.on:
            self.track.fault(block.line, "program-state", f"{word.text} selects another process while a tool is on")
        self.marking = block.of("T") in self.control.marking

    def _torch(self, word: Word, block: Block) -> None:
        named = block.words.get("$")
        if named is not None and not self.control.numbered:
            raise block.refused(
                f"{named.text}: tools by number are not supported here in a program for {self.control.title}, the "
                "control of the profile's dialect; post it for that control",
                named,
            )
        if named is not None and named.value != int(named.value):
            raise block.refused(f"{named.text} is not supported here: expected a whole number", named)
        tool = 0 if named is None else int(named.value)
        if word.value == _START:
            if tool == ALL:
                raise block.refused("all tools at once are not supported here: start one, such as $0", named)
            if block.of("S") <= 0:
                self.track.fault(block.line, "program-state", f"tool ${tool} is started without S1, which turns it on")
            if 0 < block.of("S") <= self.control.marks_up_to:
                tool = 1
            self.start(tool, block.line)
            if self.control.full_power and self.track.open is not None:
                self.track.open.powers.add(block.of("S"))
            return
        if named is None and self.control.marks_up_to:
            tool = ALL
        if named is None and any(on != 0 for on in self.on) and self.control.numbered:
            raise block.refused(
                f"{word.text} without $ while tool ${self.on[0]} is on is not supported here: one version of the "
                "control stops all tools, another only $0; name the tool",
                word,
            )
        self.stop(tool)

    def _bit(self, word: Word, block: Block) -> None:
        output = block.words.get("P")
        if output is None or output.value != self.control.marks_by:
            raise block.refused(
                f"{word.text} of another output than P{self.control.marks_by}, which marks, is not supported here",
                output or word,
            )
        if word.value == _SET_BIT:
            self.start(1, block.line)
        else:
            self.stop(1)

    def _output(self, word: Word, block: Block) -> None:
        if "E" not in block.words or "Q" not in block.words:
            raise block.refused(f"{word.text} without E and Q is not supported here: expected both", word)
        output, share = block.words["E"], block.words["Q"].value
        if self.control.speed_output is None:
            return  # an analogue output of the plant's own: a power, a gas
        if output.value != self.control.speed_output:
            raise block.refused(
                f"{word.text} {output.text} is not supported here: only E{self.control.speed_output:g}, the speed, is "
                "checked",
                output,
            )
        if share not in (0.0, 100.0):
            text = f"{word.text} E3 Q{share:g} has the torch move at {share:g} % of its feed"
            self.track.fault(block.line, "feeds", text)


# The beam of a laser under GRBL: lit in moves at a feed alone, and by M3 also at rest between them.
#
# GRBL in laser mode ($32=1) has the beam off in each G0. M3 burns at rest too, where G1, G2 or G3 is the motion in
# force, so that a pierce needs it. M4 scales the power with the speed: at rest it is off. S0 is off, and S stays in
# force (https://github.com/gnea/grbl/blob/master/doc/markdown/laser_mode.md).

_CONSTANT, _SCALED, _OFF = 3.0, 4.0, 5.0
_CUTTING = frozenset({1.0, 2.0, 3.0})


@dataclass(slots=True)
class Beam(ToolsOn):
    """Whether the beam is lit: by which of M3 and M4, and with which power S."""

    mode: float = _OFF
    power: float = 0.0

    def switch(self, block: Block, motion: float | None, modal: float | None) -> None:
        """Take note of M3, M4, M5 and S, and light the beam or put it out, as the block's motion asks for it."""
        self.power = block.of("S", self.power)
        for word in block.m:
            if word.value in (_CONSTANT, _SCALED, _OFF):
                self.mode = word.value
                if word.value != _OFF and self.power <= 0:
                    text = f"{word.text} lights nothing: no S word has given the beam a power"
                    self.track.fault(block.line, "program-state", text)
        ready = self.mode != _OFF and self.power > 0
        tool = 0 if self.power > self.control.marks_up_to else 1
        self.on = [tool] if ready else []
        moves = motion is not None and any(letter in block.words for letter in "XYIJR")
        if moves:
            lit = ready and motion in _CUTTING
        elif self.mode == _SCALED and not block.has_g(DWELL):
            lit = ready and self.track.open is not None and modal in _CUTTING
        else:
            lit = ready and self.mode == _CONSTANT and modal in _CUTTING
        burning = self.track.open
        if burning is not None and (not lit or burning.tool != tool):
            self.track.close()
        if lit and self.track.open is None:
            self.track.begin(tool, block.line, self.held_s[0] if tool == 0 else self.held_s[1])
        if self.track.open is not None and (moves or block.has_g(DWELL)):
            (self.track.open.powers if moves else self.track.open.pierce_powers).add(self.power)
