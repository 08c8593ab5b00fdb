"""Plain moves, run row by row without a block made of each: most rows of a program are."""

from __future__ import annotations

import re
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Segment

from .arcs import arc_by_centre
from .grammar import MOTION
from .moves import FEED_MM_MIN, ModalState
from .words import PLAIN_NUMBER, Block

_RAPID, _ARC_CCW = "0", "3"
_MOVE = re.compile(
    rf"(?:N[0-9]{{1,9}} )?G([0-3]) X{PLAIN_NUMBER} Y{PLAIN_NUMBER}(?: I{PLAIN_NUMBER} J{PLAIN_NUMBER})?"
    r"(?: F([0-9]{1,6}(?:\.[0-9]{1,9})?))?"
)
"""A move to a place as most rows spell it; no number of so few digits is out of bounds."""
_NO_PLACE = Block(0)


@dataclass(slots=True)
class PlainMoves:
    """Runs moves in mm that count from the origin, once a program has said all that it must.

    These are lines and arcs with the torch lit, and rapids with it off. Whatever else a row is, it is left to the way
    for all blocks, and so is what that refuses: it says where.
    """

    moves: ModalState

    @property
    def may_run(self) -> bool:
        """Whether the control has the words, and they do nothing but move."""
        control = self.moves.control
        return control.known_g >= MOTION and not control.beam and not control.bare

    def run(self, row: str, line: int) -> bool:
        """Run a row; False, and nothing is done, where it is not as usual."""
        moves, track = self.moves, self.moves.track
        if not moves.usual or (found := _MOVE.fullmatch(row)) is None:
            return False
        code, x, y, i, j, f = found.groups()
        end = (float(x), float(y))
        if code == _RAPID:
            if track.open is not None or i is not None or f is not None:
                return False
            moves.motion = 0.0
            track.rapid(end, line)
            return True
        feed = moves.feed_mm_min if f is None else float(f)
        if track.open is None or (i is None) != (code == "1") or not FEED_MM_MIN[0] <= feed <= FEED_MM_MIN[1]:
            return False
        at = track.at
        segments: tuple[Segment, ...]
        if i is None:
            segments = (Segment(at, end),)
        else:
            try:
                centre = (at[0] + float(i), at[1] + float(j))
                segments = arc_by_centre(at, end, centre, code == _ARC_CCW, _NO_PLACE)
            except InputError:
                return False
        moves.motion, moves.feed_mm_min = float(code), feed
        for segment in segments:
            track.feed(segment, feed * moves.share / 60, line)
        track.at = end
        return True
