"""Which words may stand in one block, what a program must say before it moves, and what its moves come to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.geometry.tolerances import TOLERANCE_MM

from .controls import Control
from .program import Track
from .words import SHORT_MM, Block, Word, arc_by_centre, arc_by_radius

MOTION = frozenset({0.0, 1.0, 2.0, 3.0})
ARCS = frozenset({2.0, 3.0})
DWELL, NO_MOTION, ROUNDING, PER_MINUTE = 4.0, 80.0, 64.0, 94.0
UNCHANGING = frozenset({17.0, 40.0, 54.0, 92.1, 94.0, 97.0})
"""Words that all others of their group are refused for, so that nothing of what they say ever changes."""
_KERF = "the control would shift the path by its own kerf, which the program does not show; post the program without"
_PLANE = "arcs outside the XY plane are not checked; post the program with G17"
_REFUSED_G: Mapping[float, str] = {18.0: _PLANE, 19.0: _PLANE, 41.0: _KERF, 42.0: _KERF, 41.1: _KERF, 42.1: _KERF}
_G_GROUPS: Mapping[str, frozenset[float]] = {
    "motion": MOTION | {NO_MOTION},
    "non-modal": frozenset({DWELL}),
    "plane": frozenset({17.0}),
    "units": frozenset({20.0, 21.0, 70.0, 71.0}),
    "kerf": frozenset({40.0}),
    "tool length": frozenset({49.0}),
    "coordinate system": frozenset({54.0}),
    "rounding": frozenset({61.0, 61.1, ROUNDING}),
    "distance": frozenset({90.0, 91.0}),
    "arc centres": frozenset({90.1, 91.1}),
    "offsets": frozenset({92.1}),
    "feed": frozenset({PER_MINUTE}),
    "spindle": frozenset({97.0}),
}
_M_GROUPS: Mapping[str, frozenset[float]] = {
    "stops": frozenset({0.0, 1.0, 2.0, 30.0}),
    "outputs": frozenset({64.0, 65.0, 67.0, 68.0}),
    "torch": frozenset({3.0, 4.0, 5.0}),
    "gas": frozenset({7.0, 8.0, 9.0, 10.0, 13.0, 14.0, 15.0, 16.0}),
    "process": frozenset({36.0}),
    "stations": frozenset({37.0, 38.0}),
    "overrides": frozenset({48.0, 49.0, 50.0, 51.0, 52.0, 53.0}),
}
_GROUP_OF_G = {code: name for name, codes in _G_GROUPS.items() for code in codes}
_GROUP_OF_M = {code: name for name, codes in _M_GROUPS.items() for code in codes}
_USES_M: Mapping[float, str] = {
    3.0: "S$", 4.0: "S", 5.0: "$", 50.0: "P", 51.0: "P", 52.0: "P", 53.0: "P",
    36.0: "T", 37.0: "T", 38.0: "T", 64.0: "P", 65.0: "P", 67.0: "EQ", 68.0: "EQ",
}  # fmt: skip
_USES_MOTION: Mapping[float | None, str] = {None: "", 0.0: "XY", 1.0: "XY", 2.0: "XYIJRP", 3.0: "XYIJRP"}


def refused_g(code: float) -> str | None:
    """Why a G word is refused that changes where the path lies; None for any other."""
    return _REFUSED_G.get(code)


def group_of(word: Word) -> str:
    """The modal group of a G or M word that is known here."""
    return (_GROUP_OF_M if word.letter == "M" else _GROUP_OF_G)[word.value]


def motion_of(block: Block, modal: float | None, control: Control) -> float | None:
    """The motion that a block makes: its own word's, else the one in force, where the block has a word for it."""
    if block.has_g(DWELL):
        return None
    for word in block.g:
        if word.value in MOTION:
            return word.value
        if word.value == NO_MOTION:
            return None
    letters = ("XYIJ" if modal in ARCS and not control.bare else "XY") + control.rotary
    return modal if any(letter in block.words for letter in letters) else None


def refuse_conflicts(block: Block, motion: float | None, control: Control) -> None:
    """Refuse words that do not belong into one block; `motion` is the motion that it makes.

    Raises InputError with line and column.
    """
    _known_once(block, block.g, _GROUP_OF_G, control)
    _known_once(block, block.m, _GROUP_OF_M, control)
    if block.has_g(DWELL):
        moved = any(letter in block.words for letter in "XYIJR" if letter != control.dwell)
        if moved or any(word.value in MOTION for word in block.g):
            raise block.refused("a wait (G4) and a move in one block are not supported here; write them on two lines")
    users: dict[str, list[str]] = {}
    for word in block.g:
        _note(users, word.text, {DWELL: control.dwell, ROUNDING: "PQ"}.get(word.value, ""))
    for word in block.m:
        switches = word.value in control.starts or word.value in control.stops
        letters = "$" * (word.value in control.starts) if switches else _USES_M.get(word.value, "")
        _note(users, word.text, letters.replace("$", "") if control.beam else letters)
    _note(users, "the motion", _USES_MOTION[motion] + ("" if motion is None else control.rotary))
    for letter, word in block.words.items():
        if letter == "F" or (letter == "S" and control.beam):
            continue
        if letter not in users:
            raise block.refused(_unused(letter, control), word)
        if letter == "P" and len(users[letter]) > 1:
            text = f"{word.text} is meant for {' or '.join(users[letter])}: not supported here; write them on two lines"
            raise block.refused(text, word)


def _note(users: dict[str, list[str]], user: str, letters: str) -> None:
    for letter in letters:
        users.setdefault(letter, []).append(user)


def _known_once(block: Block, words: tuple[Word, ...], groups: Mapping[float, str], control: Control) -> None:
    seen: dict[str, Word] = {}
    for word in words:
        if word.letter == "G" and word.value in _REFUSED_G:
            raise block.refused(f"{word.text} is not supported here: {_REFUSED_G[word.value]}", word)
        if word.letter == "M" and (why := control.refused_m.get(word.value)):
            raise block.refused(f"{word.text} is not supported here: {why}", word)
        group = groups.get(word.value)
        if group is None or word.value not in (control.known_m if word.letter == "M" else control.known_g):
            raise block.refused(
                f"{word.text} is not understood, and not supported here, in a program for {control.title}, the control "
                "of the profile's dialect; post the program without",
                word,
            )
        if group in seen:
            first = seen[group].text
            raise block.refused(
                f"{first} and {word.text} are of one group ({group}), of which a block holds one; not supported here; "
                "write them on two lines",
                word,
            )
        seen[group] = word


def _unused(letter: str, control: Control) -> str:
    expected = {
        "S": "M3: another change of the torch's power is not checked, and not supported here",
        "$": "M3 or M5: not supported here",
        "P": "G4, G64 or an arc",
        "Q": "G64, M67 or M68",
        "E": "M67 or M68",
    }
    expected |= dict.fromkeys("XY", "a motion word (G0, G1, G2 or G3)")
    if control.dwell != "P":
        expected["P"] = f"none; the time of a wait is given by {control.dwell} here, such as G04 {control.dwell}0.5"
    expected |= dict.fromkeys("IJR", "an arc (G2 or G3)")
    expected |= dict.fromkeys("DHLT", "none, what it chooses is not supported here")
    return f"{letter} without a word that uses it: expected {expected[letter]}"


# What a program must say before it moves; else it would run in whatever state the control was left in.

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
        if not block.g or not (self.left or block.has_g(ROUNDING)):
            return
        words = {word.value for word in block.g}
        if ROUNDING in words and not self._near(block, unit_mm):
            words.discard(ROUNDING)
            self.left |= {name: codes for name, codes in _ASKED.items() if ROUNDING in codes}
        self.forgive(*words)

    def forgive(self, *words: float) -> None:
        """Ask no more for what these words say."""
        self.left = {name: codes for name, codes in self.left.items() if not codes & {*words}}

    @staticmethod
    def _near(block: Block, unit_mm: float) -> bool:
        most = TOLERANCE_MM * (1 + 1e-9)
        return 0 < block.of("P") * unit_mm <= most and block.of("Q") * unit_mm <= most

    def missing(self) -> str:
        """What is missing, as a list for a sentence; empty from then on, until something is unsaid."""
        text = ", ".join(self.left)
        self.left = {}
        return text


# What the F and G words of a block move: units, counting, and lines and arcs in mm.

INCH_MM = 25.4
_PLACING = frozenset("XYIJR")
_FARTHEST_MM = 2e6
FEED_MM_MIN = (1.0, 1e6)


@dataclass(slots=True)
class ModalState:
    """Modal state: motion, feed, units and how the program counts.

    `share` is the share of its feed that an old program has the torch move at (`old_words`), `charted` gives the feed
    of the control's cut chart at a line that needs one, mm/min.
    """

    track: Track
    control: Control
    unit_mm: float = 1.0
    absolute: bool = True
    centre_absolute: bool = False
    motion: float | None = None
    feed_mm_min: float = 0.0
    share: float = 1.0
    charted: Callable[[int], float] | None = None
    modes: Modes = field(init=False)

    def __post_init__(self) -> None:
        self.modes = Modes(self.control.known_g, self.control.fixed)
        self.centre_absolute = self.control.centre_absolute or 90.1 in self.control.fixed
        self.unit_mm = INCH_MM if self.control.fixed & {20.0, 70.0} else 1.0
        self.absolute = 91.0 not in self.control.fixed

    def of(self, block: Block) -> float | None:
        """The motion that a block makes, None for none; with no motion word, a line or travel as the torch is."""
        if self.control.bare and any(letter in block.words for letter in "XY") and not block.g:
            return 0.0 if self.track.open is None else 1.0
        return motion_of(block, self.motion if self.control.modal else None, self.control)

    def modal(self, block: Block) -> float | None:
        """The motion in force from a block on."""
        motions = [word.value for word in block.g if word.value in MOTION or word.value == NO_MOTION]
        return self.motion if not motions else None if motions[0] == NO_MOTION else motions[0]

    def feed(self, block: Block) -> None:
        """An F word counts in the units before its block, as the control has it; G94 forgets the F before it."""
        if block.has_g(PER_MINUTE):
            self.feed_mm_min = 0.0
        if "F" in block.words and not (self.control.dwell == "F" and block.has_g(DWELL)):
            self.feed_mm_min = block.of("F") * (self.control.feed_mm_min or self.unit_mm)

    def wait(self, block: Block) -> None:
        """G4. Raises InputError where its time is missing."""
        if block.has_g(DWELL):
            letter = self.control.dwell
            if letter not in block.words:
                raise block.refused(f"G4 without its time: expected {letter} and seconds, such as G4 {letter}0.5")
            self.track.wait(block.of(letter) * self.control.dwell_s)

    def move(self, block: Block, motion: float | None) -> None:
        """Set modes, then make the block's motion, if any.

        Raises InputError with line and column, for a move without feed, an arc that is none, and a place far off every
        machine.
        """
        self._modes(block)
        self.modes.said(block, self.unit_mm)
        if motion is None:
            return
        self.motion = motion
        if _PLACING.isdisjoint(block.words) and not any(letter in block.words for letter in self.control.rotary):
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
            if self.control.rotary:
                self.track.axes = self._turned(block)
            return
        feed_mm_s = self._feed_mm_s(block)
        if self.control.rotary:
            self._feed_turning(block, end, feed_mm_s)
            return
        for segment in (Segment(self.track.at, end),) if motion == 1.0 else self._arc(end, block):
            self.track.feed(segment, feed_mm_s, block.line)
        self.track.at = end

    def _feed_turning(self, block: Block, end: Point, feed_mm_s: float) -> None:
        """A line or an arc in which the torch tilts and turns evenly; without either it does so on the spot."""
        before, turned = self.track.axes or (0.0, 0.0), self._turned(block)
        if self.motion == 1.0 and end == self.track.at:
            said = feed_mm_s * 60 / self.unit_mm
            self.track.turn(turned, said * 360 if self.control.turns_rpm else said, block.line)
            return
        pieces = (Segment(self.track.at, end),) if self.motion == 1.0 else self._arc(end, block)
        for count, segment in enumerate(pieces, 1):
            share = count / len(pieces)  # an arc of more than half a turn comes in two halves
            there = tuple(a + (b - a) * share for a, b in zip(before, turned, strict=True))
            self.track.feed(segment, feed_mm_s, block.line, there)
        self.track.at = end

    def _turned(self, block: Block) -> tuple[float, ...]:
        """Where the axes that tilt and turn the torch are after a block, degrees."""
        before = self.track.axes or (0.0, 0.0)
        return tuple(
            (at if letter not in block.words else block.of(letter) + (0.0 if self.absolute else at))
            for letter, at in zip(self.control.rotary, before, strict=True)
        )

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
        unit, (x, y) = self.unit_mm * self.control.place_mm, self.track.at
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
        if feed <= 0 and self.charted is not None:
            feed = self.charted(block.line)
        if feed <= 0:
            raise block.refused("a line or an arc with no feed; write an F word before it or in it")
        if not least <= feed <= most:
            raise block.refused(
                f"a feed of {feed:g} mm/min is not supported here: expected {least:g} to {most:g}",
                block.words.get("F"),
            )
        return feed * self.share / 60

    def _arc(self, end: Point, block: Block) -> tuple[Segment, ...]:
        ccw, at, unit = self.motion == 3.0, self.track.at, self.unit_mm * self.control.place_mm
        letters = [letter for letter in "IJ" if letter in block.words]
        if block.of("P", 1.0) != 1.0:
            raise block.refused("an arc of several turns is not supported here; write each turn out", block.words["P"])
        if "R" in block.words:
            if letters:
                raise block.refused("an arc with both R and I or J; write one of the two", block.words["R"])
            if "X" not in block.words and "Y" not in block.words:
                raise block.refused("an arc by R without its end; write X and Y", block.words["R"])
            short_mm = SHORT_MM if self.control.place_mm == 1.0 else self.control.mismatch_mm
            return arc_by_radius(at, end, block.of("R") * unit, ccw, block, short_mm)
        if not letters:
            raise block.refused("an arc without I, J or R; write its centre as I and J")
        if self.centre_absolute and len(letters) < 2:
            raise block.refused("an arc with an absolute centre (G90.1) needs both I and J; write both")
        base = (0.0, 0.0) if self.centre_absolute else at
        centre = base[0] + block.of("I") * unit, base[1] + block.of("J") * unit
        return arc_by_centre(at, end, centre, ccw, block, self.control.mismatch_mm)
