"""What the torch has done so far: its burns, its ways between them, and the time that took."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.meetings import MOST_MEETINGS, meets_itself_too_often
from kerfwise.encoder.geometry.segment import Point, Segment

from .program import Burn, Fault, MoveStretch

_NOTHING_MM = 1e-9
"""A curve leaves out segments no longer than this."""


@dataclass(slots=True)
class _Open:
    """A burn that has not ended yet."""

    tool: int
    line: int
    start_s: float
    rows: list[tuple[float, float, float]]
    comment: str
    travels_mm: tuple[float, ...]
    wait_s: float
    held_s: float = 0.0
    pierce_s: float = 0.0
    paused_s: float = 0.0
    step_feeds_mm_s: list[float] = field(default_factory=list)
    powers: set[float] = field(default_factory=set)
    pierce_powers: set[float] = field(default_factory=set)
    unlit: list[tuple[float, float]] = field(default_factory=list)
    torches: tuple[int, ...] = ()


@dataclass(slots=True)
class Track:
    """Where the torch is and has been; `travel_mm_s` is the speed of rapids.

    A torch that goes off, moves on at a feed for no more than `tab_mm`, and is lit again at once, burns on: it has gone
    over a tab, where the same torches are lit again. `torches` are the further ones that are selected. `_closed` is the
    burn that may go on so, `_over` what it has gone since, unlit.
    """

    travel_mm_s: float
    at: Point = (0.0, 0.0)
    clock_s: float = 0.0
    idle_mm: float = 0.0
    moving_s: float = 0.0
    wait_s: float = 0.0
    comment: str = ""
    open: _Open | None = None
    burns: list[Burn] = field(default_factory=list)
    hot_rapids: list[MoveStretch] = field(default_factory=list)
    slow_travel: list[MoveStretch] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    travels_mm: list[float] = field(default_factory=list)
    rapids: list[tuple[int, Point]] = field(default_factory=list)
    tab_mm: float = 0.0
    torches: tuple[int, ...] = ()
    _closed: _Open | None = None
    _over: list[tuple[Segment, float]] = field(default_factory=list)

    def fault(self, line: int, rule: str, text: str) -> None:
        """Note what the program does wrong."""
        self.faults.append(Fault(line, rule, text))

    def begin(self, tool: int, line: int, held_s: float = 0.0) -> None:
        """A tool starts where the torch stands; the control holds it there for `held_s`."""
        if self._goes_on(tool):
            return
        self.open = _Open(
            tool,
            line,
            self.clock_s,
            [],
            self.comment,
            tuple(self.travels_mm),
            self.wait_s,
            held_s=held_s,
            torches=self.torches,
        )
        self.clock_s += held_s
        self.travels_mm.clear()
        self.wait_s = 0.0

    def close(self) -> None:
        """End the burn that is going on, if any; one that did not move is a hole and is kept."""
        if self.open is None:
            return
        o, path = self.open, Curve.of([*self.open.rows, (*self.at, 0.0)], closed=False)
        if meets_itself_too_often(path.vertices[:, :2], closed=False, most=MOST_MEETINGS):
            raise InputError(
                f"the path that is cut from here on crosses or touches itself more than {MOST_MEETINGS} times: not "
                "supported here; put the torch out where a cut ends",
                line=o.line,
            )
        self.burns.append(
            Burn(
                o.tool, o.line, path, o.start_s, self.clock_s, o.comment, o.travels_mm, o.pierce_s, o.paused_s,
                tuple(o.step_feeds_mm_s), o.wait_s, o.held_s,
                tuple(sorted(o.powers)), tuple(sorted(o.pierce_powers)), tuple(o.unlit), o.torches,
            )
        )  # fmt: skip
        self._closed, self._over = (o, []) if self.tab_mm > 0 and o.tool == 0 and o.rows else (None, [])
        self.open = None

    def _goes_on(self, tool: int) -> bool:
        """Take up the burn before, where the torch has only gone over a tab since."""
        length_mm = sum(segment.length_mm for segment, _ in self._over)
        before, self._closed = self._closed, None
        if before is None or (tool, self.torches) != (before.tool, before.torches):
            return False
        if not 0 < length_mm <= self.tab_mm or self.wait_s > 0:
            return False
        lit = self.burns.pop()
        before.unlit.append((lit.path.length_mm, lit.path.length_mm + length_mm))
        before.rows += [(*segment.start, segment.bulge) for segment, _ in self._over]
        before.step_feeds_mm_s += [feed_mm_s for _, feed_mm_s in self._over]
        self.idle_mm -= length_mm
        del self.travels_mm[-len(self._over) :], self.rapids[-len(self._over) :], self.slow_travel[-len(self._over) :]
        self.open = before
        return True

    def wait(self, seconds: float) -> None:
        """Stand still."""
        self.clock_s += seconds
        if self.open is None:
            self.wait_s += seconds
        elif self.open.rows:
            self.open.paused_s += seconds
        else:
            self.open.pierce_s += seconds

    def rapid(self, end: Point, line: int) -> None:
        """Travel; with a tool on that ends a burn and begins another."""
        length = math.dist(self.at, end)
        self._closed = None
        self.clock_s += length / self.travel_mm_s
        tool = None if self.open is None else self.open.tool
        if tool is not None and length > 0:
            self.hot_rapids.append(MoveStretch(line, length))
            self.close()
        self.at = end
        if tool is None:
            self._idle(length, line)
        elif self.open is None:
            self.begin(tool, line)

    def feed(self, segment: Segment, feed_mm_s: float, line: int) -> None:
        """Move along a line or an arc at cutting feed; one of no length is no move."""
        length_mm = segment.length_mm
        if length_mm <= 0:
            return
        seconds = length_mm / feed_mm_s
        self.clock_s += seconds
        self.at = segment.end
        if self.open is None:
            self._over.append((segment, feed_mm_s))
            self._idle(length_mm, line)
            self.slow_travel.append(MoveStretch(line, length_mm))
        else:
            self.moving_s += seconds
            if length_mm > _NOTHING_MM:
                self.open.step_feeds_mm_s.append(feed_mm_s)
            self.open.rows.append((*segment.start, segment.bulge))

    def _idle(self, length_mm: float, line: int) -> None:
        self.idle_mm += length_mm
        self.travels_mm.append(length_mm)
        self.rapids.append((line, self.at))
