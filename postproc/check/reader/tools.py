"""What the M words of a block switch: the torch, the tool that marks, and the speed."""

from __future__ import annotations

from dataclasses import dataclass, field

from .controls import Control
from .track import Track
from .words import Block, Word

_HALTS = frozenset({0.0, 1.0})
_ENDS = frozenset({2.0, 30.0})
_SET_BIT, _CLEAR_BIT, _START, _STOP, _ALL = 64.0, 65.0, 3.0, 5.0, -1
_OUTPUTS = frozenset({67.0, 68.0})


@dataclass(slots=True)
class Tools:
    """The tools that are on; the control holds the torch for `held_s` where it starts to cut, and to mark."""

    track: Track
    control: Control
    held_s: tuple[float, float]
    on: list[int] = field(default_factory=list)
    ended: bool = False

    def switch(self, block: Block) -> None:
        """Do what comes before a block's wait and motion, outputs first, as the control does.

        Raises
        ------
        InputError
            With line and column, for outputs and tools that this control does not have or that are not checked.
        """
        for word in sorted(block.m, key=lambda word: -word.value if word.value >= _SET_BIT else 0.0):
            if word.value in (_SET_BIT, _CLEAR_BIT):
                self._bit(word, block)
            elif word.value in _OUTPUTS:
                self._output(word, block)
            elif word.value in (_START, _STOP):
                self._torch(word, block)

    def halt(self, block: Block) -> None:
        """Do what comes after its motion: halts and the program's end."""
        for word in block.m:
            if word.value in _HALTS and self.on:
                self.track.fault(
                    block.line, "torch-off-travel", f"{word.text} halts the program while tool ${self.on[0]} is on"
                )
            self.ended = self.ended or word.value in _ENDS

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
            if tool == _ALL:
                raise block.refused("all tools at once are not supported here: start one, such as $0", named)
            if block.of("S") <= 0:
                self.track.fault(block.line, "program-state", f"tool ${tool} is started without S1, which turns it on")
            self._start(tool, block.line)
            return
        if named is None and any(on != 0 for on in self.on) and self.control.numbered:
            raise block.refused(
                f"{word.text} without $ while tool ${self.on[0]} is on is not supported here: one version of the "
                "control stops all tools, another only $0; name the tool",
                word,
            )
        self._stop(tool)

    def _bit(self, word: Word, block: Block) -> None:
        output = block.words.get("P")
        if output is None or output.value != self.control.marks_by:
            raise block.refused(
                f"{word.text} of another output than P{self.control.marks_by}, which marks, is not supported here",
                output or word,
            )
        if word.value == _SET_BIT:
            self._start(1, block.line)
        else:
            self._stop(1)

    def _output(self, word: Word, block: Block) -> None:
        if "E" not in block.words or "Q" not in block.words:
            raise block.refused(f"{word.text} without E and Q is not supported here: expected both", word)
        output, share = block.words["E"], block.words["Q"].value
        if output.value != self.control.speed_output:
            raise block.refused(
                f"{word.text} {output.text} is not supported here: only E{self.control.speed_output:g}, the speed, is "
                "checked",
                output,
            )
        if share not in (0.0, 100.0):
            text = f"{word.text} E3 Q{share:g} has the torch move at {share:g} % of its feed"
            self.track.fault(block.line, "feeds", text)

    def _start(self, tool: int, line: int) -> None:
        if self.on:
            self.track.fault(line, "torch-off-travel", f"tool ${tool} is started while ${self.on[0]} is on")
        if tool not in self.on:
            self.on.append(tool)
        if self.track.open is None:
            self.track.begin(tool, line, self.held_s[0] if tool == 0 else self.held_s[1])

    def _stop(self, tool: int) -> None:
        self.on = [] if tool == _ALL else [t for t in self.on if t != tool]
        if self.track.open is not None and self.track.open.tool not in self.on:
            self.track.close()
