"""The beam of a laser under GRBL: lit in moves at a feed alone, and by M3 also at rest between them.

GRBL in laser mode ($32=1) has the beam off in each G0. M3 burns at rest too, where G1, G2 or G3 is the motion in force,
so that a pierce needs it. M4 scales the power with the speed: at rest it is off. S0 is off, and S stays in force
(https://github.com/gnea/grbl/blob/master/doc/markdown/laser_mode.md).
"""

from __future__ import annotations

from dataclasses import dataclass

from .grammar import DWELL
from .tools_on import ToolsOn
from .words import Block

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
