"""A strict reader of the programs that kerfwise writes: what burns, in order. Written apart from the project's own.

It knows the words of LinuxCNC, with and without QtPlasmaC, that occur in such programs and refuses every other one. A
test holds it against LinuxCNC's own interpreter. Where the control is to add the kerf (G41, G42), it is added here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

import numpy as np

from kerfwise.tests.metal.arcs import Floats, Point, chords, sweep_rad
from kerfwise.tests.metal.beside import Move, NoRoom, torch_ways

_COMMENT = re.compile(r"\(([^()]*)\)")
_WORD = re.compile(r"([A-Z$])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
_CUT = re.compile(r"^(?:CUT|MARK|SPOT) (\d+) (.+?)(?: ZONE .*)?$")
_STRETCH = re.compile(r"STRETCH \S")
_RESUMED = re.compile(r"^RESUME AFTER CUT (\d+)")
_CORNER = re.compile(r"^ORIGIN SHEET CORNER\b")
_HARMLESS = {
    "G": {"4", "17", "21", "40", "49", "64", "61", "80", "94"},
    "M": {"2", "30", "66", "67", "68", "190"},
}
"""Words that move nothing and burn nothing. G20, offsets and M62 to M65 (torch off while the path goes on) are not
among them: the project never writes them, but for M64 P0 and M65 P0, which mark where M3 has but one tool."""
_ADDED = {"41": 1.0, "41.1": 1.0, "42": -1.0, "42.1": -1.0}
"""Words by which the control adds the kerf: to the left, or to the right."""


class UnreadableProgram(AssertionError):
    """A block that this reader does not know; the message has its line and text."""


@dataclass(frozen=True, eq=False, slots=True)
class Path:
    """One stretch with a tool on: `points` is an array (n, 2), mm; `tool` 0 is the torch, 1 the scribe.

    `order` and `label` are those of the comment before it (CUT n contour), else its place in the program and nothing.
    One that `goes_on` is lit again after the path before, to which only a move at a feed leads, as over a tab.
    `later` are the comments within it, as where the torch stays on from one cut to the next: the number of the cut, and
    the number of the point from which on it is. Further `torches` of the gantry burn the same, elsewhere.
    """

    order: int
    label: str
    tool: int
    points: Floats
    line: int
    goes_on: bool = False
    later: tuple[tuple[int, int], ...] = ()
    torches: frozenset[int] = frozenset()

    @property
    def burns(self) -> bool:
        """Whether the torch is the tool."""
        return self.tool == 0

    def upto(self, order: int) -> Path | None:
        """What of it was made once the cut of that number was; None for nothing."""
        if self.order > order:
            return None
        stop = next((at for number, at in self.later if number > order), len(self.points) - 1)
        return replace(self, points=self.points[: stop + 1])


@dataclass(frozen=True, eq=False, slots=True)
class Program:
    """What a program does: its torch-on paths in order, its idle moves, and after which cut it takes up the work.

    `from_corner` says that the machine counts from the lower left corner round the sheet, not as the drawing does.
    """

    paths: tuple[Path, ...]
    idle: tuple[tuple[Point, Point], ...]
    resumed_after: int | None
    from_corner: bool = False


def read_program(text: str, kerf_mm: float | None = None) -> Program:
    """Read a program; coordinates are absolute, mm. The control adds this kerf, if any, where the program asks for it.

    Raises
    ------
    UnreadableProgram
        At the first block that this reader does not know, or if the torch, or the kerf beside it, is still on at the
        end.
    """
    reader = _Reader(kerf_mm=kerf_mm)
    for number, line in enumerate(text.splitlines(), 1):
        reader.block(number, line)
    if reader.on is not None:
        raise UnreadableProgram("the program ends with the torch on")
    if reader.held is not None:
        raise UnreadableProgram("the program ends before G40")
    return Program(tuple(reader.paths), tuple(reader.idle), reader.resumed_after, reader.from_corner)


@dataclass(slots=True)
class _Reader:
    at: Point = (0.0, 0.0)
    on: int | None = None
    started: int = 0
    points: list[Floats] = field(default_factory=list)
    order: int = 0
    last: int = 0
    label: str = ""
    later: list[tuple[int, int]] = field(default_factory=list)
    paths: list[Path] = field(default_factory=list)
    idle: list[tuple[Point, Point]] = field(default_factory=list)
    resumed_after: int | None = None
    from_corner: bool = False
    ended: bool = False
    centres_absolute: bool = False
    stepwise: bool = False
    unlit: bool = False
    torches: frozenset[int] = frozenset()
    kerf_mm: float | None = None
    aside_mm: float = 0.0
    held: list[tuple[int, str]] | None = None
    """The blocks since G41 or G42: they are run when G40 comes, once all moves between are known."""
    named: list[Move] | None = None
    """Where moves are only to be heard: what they name."""
    beside: tuple[Point, list[Floats]] | None = None
    """While held blocks are run: where the named path is, and the torch's ways of the moves to come."""

    def block(self, number: int, line: str) -> None:
        if self.held is None:
            self._block(number, line)
        elif not any(
            letter == "G" and _plain(value) == "40" for letter, value in _WORD.findall(_COMMENT.sub(" ", line))
        ):
            self.held.append((number, line))
        else:
            self._beside(number)
            self._block(number, line)

    def _beside(self, number: int) -> None:
        """Run the blocks that were held, the torch half the kerf beside what they name."""
        held, self.held = self.held or [], None
        listener = _Reader(
            self.at, centres_absolute=self.centres_absolute, stepwise=self.stepwise, named=[], torches=self.torches
        )
        for at, line in held:
            listener._block(at, line)
        try:
            ways = torch_ways(listener.named, self.aside_mm) if listener.named else []
        except NoRoom as error:
            raise UnreadableProgram(f"the blocks before line {number}: {error}") from error
        self.beside = self.at, ways
        for at, line in held:
            self._block(at, line)
        self.beside = None

    def _block(self, number: int, line: str) -> None:
        for said in _COMMENT.findall(line):
            self._comment(said.strip())
        code = _COMMENT.sub(" ", line).strip()
        if not code or code == "%" or self.ended:
            return
        words = _WORD.findall(code)
        if "".join(letter + value for letter, value in words) != code.replace(" ", ""):
            raise UnreadableProgram(f"line {number}: not understood: {line.strip()}")
        self._words(number, line, [(letter, value) for letter, value in words if letter != "N"])

    def _comment(self, said: str) -> None:
        if found := _CUT.match(said):
            if self.on is None:
                self.order, self.label = int(found[1]), found[2]
            else:
                self.later.append((int(found[1]), sum(map(len, self.points)) - 1))
            self.last = int(found[1]) if " ZONE " in said else self.last  # and not the length that the header tells
        elif _STRETCH.match(said) and self.on is None:
            self.order = self.last + 1
        elif found := _RESUMED.match(said):
            self.resumed_after = self.last = int(found[1])
        elif _CORNER.match(said):
            self.from_corner = True

    def _words(self, number: int, line: str, words: list[tuple[str, str]]) -> None:
        codes = [(letter, _plain(value)) for letter, value in words if letter in "GM"]
        values = {letter: float(value) for letter, value in words if letter not in "GM"}
        for letter, value in codes:
            if letter == "G" and value in "0123":
                self._move(int(value), values)
            elif letter == "M" and value == "3":
                self._start(number, int(values.get("$", 0)))
            elif letter == "M" and value == "64" and values.get("P") == 0:  # an output of the machine: the marking tool
                self._start(number, 1)
            elif letter == "M" and value == "65" and values.get("P") == 0:
                self._stop(1)
            elif letter == "M" and value in ("64", "65") and self.on is None:  # an output each for the second torch on
                torch = {int(values["P"]) + 1}
                self.torches = self.torches | torch if value == "64" else self.torches - torch
            elif letter == "M" and value == "5":
                self._stop(int(values.get("$", 0)))
            elif value in _ADDED and self.kerf_mm is not None and self.on is None and len(codes) == 1:
                width_mm = values.get("D", 0.0) if value.endswith(".1") else self.kerf_mm
                self.aside_mm, self.held = _ADDED[value] * width_mm / 2, []
            elif letter == "G" and value in ("90", "91"):
                self.stepwise = value == "91"
            elif letter == "G" and value in ("90.1", "91.1"):
                self.centres_absolute = value == "90.1"
            elif value not in _HARMLESS[letter]:
                raise UnreadableProgram(f"line {number}: {letter}{value} is not known here: {line.strip()}")
            self.ended = self.ended or (letter == "M" and value in ("2", "30"))
        if not codes and set(values) - {"F", "S"}:
            raise UnreadableProgram(f"line {number}: expected a G or M word: {line.strip()}")

    def _move(self, code: int, values: dict[str, float]) -> None:
        start = self.at if self.beside is None else self.beside[0]
        base = start if self.stepwise else (0.0, 0.0)
        end = (
            base[0] + values["X"] if "X" in values else start[0],
            base[1] + values["Y"] if "Y" in values else start[1],
        )
        self.unlit = self.unlit and code != 0
        way, move = np.array([end]), Move(start, end)
        if code >= 2:
            base = (0.0, 0.0) if self.centres_absolute else start
            centre = (base[0] + values.get("I", 0.0), base[1] + values.get("J", 0.0))
            way = chords(start, centre, sweep_rad(start, centre, end, ccw=code == 3), end)
            move = Move.arc(start, centre, end, ccw=code == 3)
        if self.named is not None and (code >= 2 or start != end):
            self.named.append(move)
        if self.beside is not None:
            ways = self.beside[1]
            way = ways.pop(0) if code >= 2 or start != end else np.array([self.at])
            self.beside = end, ways
        begun, (x, y) = self.at, way[-1].tolist()
        self.at = (x, y) if self.beside is not None else end
        if self.on is not None:
            self.points.append(way)
        elif begun != self.at:
            self.idle.append((begun, self.at))

    def _start(self, number: int, tool: int) -> None:
        if self.on is not None:
            raise UnreadableProgram(f"line {number}: tool ${tool} comes on while ${self.on} is on")
        self.on, self.started, self.points = tool, number, [np.array([self.at])]
        if self.unlit and not self.order and self.paths and self.paths[-1].tool == tool:
            self.order, self.label = self.paths[-1].order, self.paths[-1].label
        else:
            self.unlit = False

    def _stop(self, tool: int) -> None:
        if self.on is None or tool not in (self.on, -1):
            return
        points = np.concatenate(self.points)
        moves = np.concatenate([[True], np.any(np.diff(points, axis=0) != 0, axis=1)])
        order = self.order or len(self.paths) + 1
        kept = np.cumsum(moves) - 1
        later = tuple((number, int(kept[at])) for number, at in self.later)
        self.paths.append(
            Path(order, self.label, self.on, points[moves], self.started, self.unlit, later, self.torches)
        )
        self.on, self.order, self.label, self.later, self.unlit = None, 0, "", [], True


def _plain(value: str) -> str:
    """Digits without leading zeros or an empty fraction: 01 and 1.0 are 1."""
    return f"{float(value):g}"
