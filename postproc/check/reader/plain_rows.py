"""Plain rows, run at once without a block made of each: moves, a torch on or off, and what is said of a cut."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Segment

from .arcs import arc_by_centre
from .filtering import Filter
from .grammar import MOTION
from .moves import FEED_MM_MIN, ModalState
from .tools_on import ToolsOn
from .words import PLAIN_NUMBER, Block

_RAPID, _LINE, _ARC_CCW = "0", "1", "3"
_MOVE = re.compile(
    rf"(?:N[0-9]{{1,9}} )?G([0-3]) X{PLAIN_NUMBER} Y{PLAIN_NUMBER}(?: I{PLAIN_NUMBER} J{PLAIN_NUMBER})?"
    r"(?: F([0-9]{1,6}(?:\.[0-9]{1,9})?))?"
)
"""A move to a place as most rows spell it; no number of so few digits is out of bounds."""
_TORCH = re.compile(r"(?:N[0-9]{1,9} )?(?:(M3) \$0 S1|M5 \$0)")
_COMMENT = re.compile(r"\(((?:CUT|MARK) [A-Za-z0-9 ._-]*)\)")
"""No control and no filter obeys such a comment."""
_NO_PLACE = Block(0)


@dataclass(slots=True)
class PlainRows:
    """Runs moves in mm that count from the origin, once a program has said all that it must, and what is between them.

    Moves are lines and arcs with the torch lit, and rapids with it off. Whatever else a row is, it is left to the way
    for all blocks, and so is what that refuses or finds fault with: it says where.
    """

    moves: ModalState
    tools: ToolsOn
    filter: Filter | None
    comments: list[str]
    blocks: int = field(default=0, init=False)

    @property
    def may_run(self) -> bool:
        """Whether the control has the words, and they do nothing but move."""
        control = self.moves.control
        return control.known_g >= MOTION and control.comments and not control.beam and not control.bare

    def run(self, row: str, line: int) -> bool:
        """Run a row; False, and nothing is done, where it is not as usual."""
        if self.filter is not None and not self.filter.raised:
            return False
        return self._move(row, line) or self._torch(row, line) or self._comment(row)

    def _move(self, row: str, line: int) -> bool:
        moves, track = self.moves, self.moves.track
        if not moves.usual or (found := _MOVE.fullmatch(row)) is None:
            return False
        code, x, y, i, j, f = found.groups()
        at, end = track.at, (float(x), float(y))
        if code == _RAPID:
            if track.open is not None or i is not None or f is not None:
                return False
            track.rapid(end, line)
        else:
            feed = moves.feed_mm_min if f is None else float(f)
            if track.open is None or (i is None) != (code == _LINE) or not FEED_MM_MIN[0] <= feed <= FEED_MM_MIN[1]:
                return False
            segments: tuple[Segment, ...] = (Segment(at, end),)
            if i is not None:
                try:
                    centre = (at[0] + float(i), at[1] + float(j))
                    segments = arc_by_centre(at, end, centre, code == _ARC_CCW, _NO_PLACE)
                except InputError:
                    return False
            moves.feed_mm_min = feed
            for segment in segments:
                track.feed(segment, feed * moves.share / 60, line)
            track.at = end
        moves.motion = float(code)
        self.blocks += 1
        if self.filter is not None and code in (_RAPID, _LINE):
            self.filter.moved = True
        return True

    def _torch(self, row: str, line: int) -> bool:
        if not self.moves.control.numbered or (found := _TORCH.fullmatch(row)) is None:
            return False
        if found[1] is None:
            self.tools.stop(0)
            if self.filter is not None:
                self.filter.moved = False
        elif self.filter is not None and not self.filter.moved:
            return False
        else:
            self.tools.start(0, line)
        self.blocks += 1
        return True

    def _comment(self, row: str) -> bool:
        found = _COMMENT.fullmatch(row)
        if found is None:
            return False
        self.moves.track.comment = text = found[1].strip()
        self.comments.append(text)
        return True
