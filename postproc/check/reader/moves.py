"""What the F and G words of a block move: units, counting, and lines and arcs in mm."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.geometry.segment import Point, Segment

from .arcs import arc_by_centre, arc_by_radius
from .controls import Control
from .grammar import DWELL, MOTION, NO_MOTION, PER_MINUTE, motion_of
from .modes import Modes
from .track import Track
from .words import Block

INCH_MM = 25.4
_FARTHEST_MM = 2e6
FEED_MM_MIN = (1.0, 1e6)


@dataclass(slots=True)
class ModalState:
    """Modal state: motion, feed, units and how the program counts.

    `share` is the share of its feed that an old program has the torch move at (`old_words`).
    """

    track: Track
    control: Control
    unit_mm: float = 1.0
    absolute: bool = True
    centre_absolute: bool = False
    motion: float | None = None
    feed_mm_min: float = 0.0
    share: float = 1.0
    modes: Modes = field(init=False)

    def __post_init__(self) -> None:
        self.modes = Modes(self.control.known_g, self.control.fixed)
        self.centre_absolute = self.control.centre_absolute

    def of(self, block: Block) -> float | None:
        """The motion that a block makes, None for none; with no motion word, a line or travel as the torch is."""
        if self.control.bare and any(letter in block.words for letter in "XY") and not block.g:
            return 0.0 if self.track.open is None else 1.0
        return motion_of(block, self.motion, self.control)

    def modal(self, block: Block) -> float | None:
        """The motion in force from a block on."""
        said = [word.value for word in block.g if word.value in MOTION or word.value == NO_MOTION]
        return self.motion if not said else None if said[0] == NO_MOTION else said[0]

    def feed(self, block: Block) -> None:
        """An F word counts in the units before its block, as the control has it; G94 forgets the F before it."""
        if block.has_g(PER_MINUTE):
            self.feed_mm_min = 0.0
        if "F" in block.words and not (self.control.dwell == "F" and block.has_g(DWELL)):
            self.feed_mm_min = block.of("F") * self.unit_mm

    def wait(self, block: Block) -> None:
        """G4.

        Raises
        ------
        InputError
            Where its time is missing.
        """
        if block.has_g(DWELL):
            letter = self.control.dwell
            if letter not in block.words:
                raise block.refused(f"G4 without its time: expected {letter} and seconds, such as G4 {letter}0.5")
            self.track.wait(block.of(letter))

    def move(self, block: Block, motion: float | None) -> None:
        """Set modes, then make the block's motion, if any.

        Raises
        ------
        InputError
            With line and column, for a move without feed, an arc that is none, and a place far off every machine.
        """
        self._modes(block)
        self.modes.said(block, self.unit_mm)
        if motion is None:
            return
        self.motion = motion
        if not any(letter in block.words for letter in "XYIJR"):
            if motion > 1:
                raise block.refused("an arc without its end, I, J or R; write at least I and J")
            if motion == 1:
                self._feed_mm_s(block)
            return
        if missing := self.modes.missing():
            self.track.fault(block.line, "program-state", f"it moves before it has said {missing}")
        end = self._end(block)
        if motion == 0.0:
            self.track.rapid(end, block.line)
            return
        feed_mm_s = self._feed_mm_s(block)
        for segment in (Segment(self.track.at, end),) if motion == 1.0 else self._arc(end, block):
            self.track.feed(segment, feed_mm_s, block.line)
        self.track.at = end

    def _modes(self, block: Block) -> None:
        for word in block.g:
            code = word.value
            if code in (20.0, 21.0, 70.0, 71.0):
                self.unit_mm = INCH_MM if code in (20.0, 70.0) else 1.0
            elif code in (90.0, 91.0):
                self.absolute = code == 90.0
            elif code in (90.1, 91.1):
                self.centre_absolute = code == 90.1
            elif code == NO_MOTION:
                self.motion = None
            elif code in MOTION:
                self.motion = code

    def _end(self, block: Block) -> Point:
        unit, (x, y) = self.unit_mm, self.track.at
        base = (0.0, 0.0) if self.absolute else (x, y)
        x = base[0] + block.of("X") * unit if "X" in block.words else x
        y = base[1] + block.of("Y") * unit if "Y" in block.words else y
        if max(abs(x), abs(y)) > _FARTHEST_MM:
            raise block.refused(
                f"the move leads to ({x:g}, {y:g}) mm, more than {_FARTHEST_MM / 1000:g} m away: not supported here"
            )
        return x, y

    def _feed_mm_s(self, block: Block) -> float:
        feed, (least, most) = self.feed_mm_min, FEED_MM_MIN
        if feed <= 0:
            raise block.refused("a line or an arc with no feed; write an F word before it or in it")
        if not least <= feed <= most:
            raise block.refused(
                f"a feed of {feed:g} mm/min is not supported here: expected {least:g} to {most:g}",
                block.words.get("F"),
            )
        return feed * self.share / 60

    def _arc(self, end: Point, block: Block) -> tuple[Segment, ...]:
        ccw, at, unit = self.motion == 3.0, self.track.at, self.unit_mm
        given = [letter for letter in "IJ" if letter in block.words]
        if block.of("P", 1.0) != 1.0:
            raise block.refused("an arc of several turns is not supported here; write each turn out", block.words["P"])
        if "R" in block.words:
            if given:
                raise block.refused("an arc with both R and I or J; write one of the two", block.words["R"])
            if "X" not in block.words and "Y" not in block.words:
                raise block.refused("an arc by R without its end; write X and Y", block.words["R"])
            return arc_by_radius(at, end, block.of("R") * unit, ccw, block)
        if not given:
            raise block.refused("an arc without I, J or R; write its centre as I and J")
        if self.centre_absolute and len(given) < 2:
            raise block.refused("an arc with an absolute centre (G90.1) needs both I and J; write both")
        base = (0.0, 0.0) if self.centre_absolute else at
        return arc_by_centre(at, end, (base[0] + block.of("I") * unit, base[1] + block.of("J") * unit), ccw, block)
