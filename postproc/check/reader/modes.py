"""What a program must say before it moves; else it would run in whatever state the control was left in."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.postproc.check.program_rules import TOLERANCE_MM

from .grammar import ROUNDING
from .words import Block

_ASKED: dict[str, frozenset[float]] = {
    "its units (G21 or G20)": frozenset({20.0, 21.0}),
    "its units (G71 or G70)": frozenset({70.0, 71.0}),
    "how it counts (G90 or G91)": frozenset({90.0, 91.0}),
    "the plane of arcs (G17)": frozenset({17.0}),
    "how it counts their centres (G91.1 or G90.1)": frozenset({90.1, 91.1}),
    "that the control leaves the kerf alone (G40)": frozenset({40.0}),
    "what F means (G94)": frozenset({94.0}),
    f"how near the control keeps to the path (G61, or G64 with P, and Q, of at most {TOLERANCE_MM:g} mm)": frozenset(
        {61.0, 61.1, ROUNDING}
    ),
}


@dataclass(slots=True)
class Modes:
    """What has not been said yet, of what a control with the G words `known` can be told; a program hears it once.

    `fixed` are words that the control is in whatever a program says.
    """

    known: frozenset[float]
    fixed: frozenset[float] = frozenset()
    left: dict[str, frozenset[float]] = field(init=False)

    def __post_init__(self) -> None:
        self.left = {name: codes for name, codes in _ASKED.items() if codes & self.known and not codes & self.fixed}

    def said(self, block: Block, unit_mm: float) -> None:
        """Take note of the G words of a block. G64 that lets the torch round corners off more than is allowed unsays.

        `unit_mm` is the length that P and Q are given in: P is how far it may round a corner, Q how far it may leave
        out points of a nearly straight path.
        """
        if not block.g:
            return
        words = {word.value for word in block.g}
        if ROUNDING in words and not self._near(block, unit_mm):
            words.discard(ROUNDING)
            self.left |= {name: codes for name, codes in _ASKED.items() if ROUNDING in codes}
        self.left = {name: codes for name, codes in self.left.items() if not codes & words}

    @staticmethod
    def _near(block: Block, unit_mm: float) -> bool:
        most = TOLERANCE_MM * (1 + 1e-9)
        return 0 < block.of("P") * unit_mm <= most and block.of("Q") * unit_mm <= most

    def missing(self) -> str:
        """What is missing, as a list for a sentence; empty from then on, until something is unsaid."""
        text = ", ".join(self.left)
        self.left = {}
        return text
