"""Words of a line: a letter with a number or an expression, each bounded, and arcs as a program spells them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from types import MappingProxyType
from typing import NamedTuple, Protocol

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point, Segment

from .controls import COMMENT, MISMATCH_MM, Row

_WORD = re.compile(r"(?P<letter>[A-Z$])(?P<number>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_LINE_NUMBER = re.compile(r"N[0-9]{1,9}(?:\.[0-9]{1,9})?(?![0-9.])")
_WHOLE = re.compile(r"[0-9]{1,3}(?:\.0*)?")
_TENTHS = re.compile(r"[0-9]{1,3}(?:\.[0-9]?0*)?")
_PLACE = (-2e6, 2e6)
_ANGLE = (-36e3, 36e3)
BOUNDS: Mapping[str, tuple[float, float]] = {
    "X": _PLACE, "Y": _PLACE, "I": _PLACE, "J": _PLACE, "R": _PLACE,
    "F": (0.0, 1e6), "S": (0.0, 1e6), "P": (0.0, 3600.0), "Q": (0.0, 1e4), "E": (0.0, 63.0), "$": (-1.0, 2.0),
    "D": (0.0, 1e4), "H": (0.0, 1e4), "L": (0.0, 1e4), "T": (0.0, 1e4),
}  # fmt: skip
"""The letters that are read, besides G, M and N, and the least and greatest number of each, in the program's units."""
NOT_READ: Mapping[str, str] = {
    "Z": "the machine keeps its height by itself, and a height in the program is not checked; post the program without",
    "O": "subroutines and loops are not checked; post the program without them, every move written out",
    "/": "whether an optional block (/) runs is set on the machine; delete the line, or its /",
    "#": "parameters are not checked; post the program with plain numbers",
    "=": "parameters are not checked; post the program with plain numbers",
    "[": "expressions are not checked; post the program with plain numbers",
    "@": "polar coordinates are not checked; post the program with X and Y",
    "^": "polar coordinates are not checked; post the program with X and Y",
    "K": "arcs outside the XY plane are not checked; post the program with I and J only",
} | dict.fromkeys("ABCUVW", "only the axes X and Y are checked; post the program for these")  # fmt: skip


class Word(NamedTuple):
    """A letter with its number, as text too, and the column it begins in, from 1."""

    letter: str
    value: float
    text: str
    column: int


class Block(NamedTuple):
    """One line: its G and M words, its other words by letter, and its comments; `line` counts from 1."""

    line: int
    g: tuple[Word, ...] = ()
    m: tuple[Word, ...] = ()
    words: Mapping[str, Word] = MappingProxyType({})
    comments: tuple[str, ...] = ()

    def of(self, letter: str, else_: float = 0.0) -> float:
        """The number of a letter."""
        word = self.words.get(letter)
        return else_ if word is None else word.value

    def has_g(self, *codes: float) -> bool:
        """Whether one of these G words is there."""
        if len(self.g) == 1:  # most blocks
            return self.g[0].value in codes
        return any(word.value in codes for word in self.g)

    def refused(self, message: str, word: Word | None = None) -> InputError:
        """An error with the place of a word, else of the line's first."""
        shown = word or min((*self.g, *self.m, *self.words.values()), key=lambda w: w.column, default=None)
        return InputError(message, line=self.line, column=shown.column if shown else None)


def block_of(row: Row, line: int, rotary: str = "") -> Block:
    """The words of a row; `rotary` are the letters of axes that tilt and turn a torch.

    Raises InputError with line and column, for anything that is no word known here, or whose number is out of bounds:
    what the check skipped it would not have checked.

    Examples
    --------
    >>> from .controls import row_of
    >>> block = block_of(row_of("N10 g1 x 10.5 Y-.5", 1), 1)
    >>> [word.text for word in block.g], [word.value for word in block.words.values()]
    (['G1'], [10.5, -0.5])
    """
    g: list[Word] = []
    m: list[Word] = []
    words: dict[str, Word] = {}
    code, at = row.code, 0
    numbered = code.startswith("N") and not (row.comment_at and row.comment_at < row.columns[0])
    if numbered and (own := _LINE_NUMBER.match(code)):
        at = own.end()
    while at < len(code):
        if code[at] == COMMENT:
            at += 1
            continue
        column, found = row.columns[at], _WORD.match(code, at)
        letter, number = found.groups() if found is not None else ("", "")
        if found is None or not (letter in BOUNDS or letter in "GM" or letter in rotary):
            raise InputError(_cannot_read(code, at), line=line, column=column)
        word, at = Word(letter, float(number), found[0], column), found.end()
        if letter in "GM":
            if not _spelt_well(letter, number):
                raise InputError(
                    f"{word.text} spelt so is not supported here; write it as in the control's manual, such as G1 or "
                    "M3",
                    line=line,
                    column=column,
                )
            (g if letter == "G" else m).append(word)
            continue
        if letter in words:
            raise InputError(
                f"two {letter} words in one block: not supported here; delete one", line=line, column=column
            )
        low, high = BOUNDS.get(letter, _ANGLE)
        if not low <= word.value <= high:
            raise InputError(
                f"{word.text} is not supported here: expected {letter} from {low:.10g} to {high:.10g}",
                line=line,
                column=column,
            )
        words[letter] = word
    return Block(line, tuple(g), tuple(m), words, row.comments)


@lru_cache(maxsize=256)
def _spelt_well(letter: str, number: str) -> bool:
    """Whether a G or M word is spelt as controls have it."""
    return (_TENTHS if letter == "G" else _WHOLE).fullmatch(number) is not None


def _cannot_read(code: str, at: int) -> str:
    shown = code[at : at + 20]
    if (why := NOT_READ.get(code[at])) and (code[at] not in "O/" or at == 0):
        return f"'{shown}' is not supported here: {why}"
    if code[at] == "N":
        return (
            f"'{shown}': expected a line number such as N10, at the beginning of the line, whole and of nine digits at "
            "most; any other is not supported here"
        )
    return (
        f"cannot read '{shown}': expected a word such as X12.5, a letter and a plain number; anything else is not "
        "supported here"
    )


# Arcs as a program spells them: end with centre, or end with radius.

SHORT_MM = 0.001
"""How far LinuxCNC (0.00127 mm) lets the ends of an arc by R be further apart than twice its radius, and less."""
_ALL_OR_NOTHING_MM, _ALL_OR_NOTHING_RAD = 0.001, 1e-5
"""Nearer to no turn or a full one, the last digit of a number decides which of the two a control makes."""
_UNCLEAR = (
    "the arc ends so near its start that controls make nothing or a full circle of it: not supported here; write a "
    "line, or for a full circle exactly the same point"
)


def arc_by_centre(
    start: Point, end: Point, centre: Point, ccw: bool, block: Block, mismatch_mm: float = MISMATCH_MM
) -> tuple[Segment, ...]:
    """An arc about a centre, a full circle when it ends where it starts; beyond a half turn it comes in two.

    Its radius may differ by `mismatch_mm` between its ends. Raises InputError if the radius at the end is not that at
    the start within what controls accept.

    Examples
    --------
    >>> [segment.length_mm for segment in arc_by_centre((10, 0), (10, 0), (0, 0), True, Block(1))]
    [31.41592653589793, 31.41592653589793]
    """
    r, r_end = math.dist(start, centre), math.dist(end, centre)
    error = abs(r - r_end)
    if min(r, r_end) < mismatch_mm:
        raise block.refused(f"an arc of no radius ({r:.4f} mm): not supported here; write a line")
    if error > mismatch_mm:
        raise block.refused(
            f"the arc's radius is {r:.4f} mm at its start and {r_end:.4f} mm at its end: not supported here; correct "
            "its centre or its end"
        )
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    turn = math.atan2(end[1] - centre[1], end[0] - centre[0]) - a
    sweep = turn % math.tau if ccw else -(-turn % math.tau)
    if start == end:
        sweep = math.tau if ccw else -math.tau
    elif math.dist(start, end) < _ALL_OR_NOTHING_MM or min(abs(sweep), math.tau - abs(sweep)) < _ALL_OR_NOTHING_RAD:
        raise block.refused(_UNCLEAR)
    if abs(sweep) <= math.pi:
        return (Segment(start, end, math.tan(sweep / 4)),)
    middle = (centre[0] + r * math.cos(a + sweep / 2), centre[1] + r * math.sin(a + sweep / 2))
    bulge = math.tan(sweep / 8)
    return Segment(start, middle, bulge), Segment(middle, end, bulge)


def arc_by_radius(
    start: Point, end: Point, radius_mm: float, ccw: bool, block: Block, short_mm: float = SHORT_MM
) -> tuple[Segment, ...]:
    """An arc by its radius: the shorter way round, or the longer one when the radius is negative.

    Its ends may be further apart than twice the radius by twice `short_mm`. Raises InputError if the ends are the same
    point, or further apart than the radius allows.

    Examples
    --------
    >>> [round(arc.sweep_rad, 4) for arc in arc_by_radius((0, 0), (10, 10), -10, True, Block(1))]
    [4.7124]
    """
    half = math.dist(start, end) / 2
    if half == 0:
        raise block.refused("an arc by R that ends where it starts; write its centre as I and J", block.words.get("R"))
    if half < _ALL_OR_NOTHING_MM or abs(radius_mm) > half / _ALL_OR_NOTHING_RAD:
        raise block.refused(_UNCLEAR)
    if half > abs(radius_mm) + short_mm:
        raise block.refused(
            f"R{radius_mm:g} is too small, the arc's ends are {2 * half:.4f} mm apart: not supported here; correct it",
            block.words.get("R"),
        )
    quarter = math.asin(min(half / abs(radius_mm), 1.0)) / 2
    bulge = math.tan(quarter if radius_mm > 0 else math.pi / 2 - quarter)
    return (Segment(start, end, bulge if ccw else -bulge),)


_NUMBER = re.compile(r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)")
_SAME = 1e-4


class Parameters(Protocol):
    """What a program has set."""

    def get(self, name: str, line: int) -> float:
        """The value of a parameter: by its number, or its name in < >."""

    def knows(self, name: str) -> bool:
        """Whether a named parameter exists."""


def _mod(left: float, right: float) -> float:
    rest = math.fmod(left, right)
    return rest + abs(right) if rest < 0 else rest


_OPERATORS: Mapping[str, tuple[int, Callable[[float, float], float]]] = {
    "**": (6, lambda a, b: a**b),
    "*": (5, lambda a, b: a * b),
    "/": (5, lambda a, b: a / b),
    "MOD": (5, _mod),
    "+": (4, lambda a, b: a + b),
    "-": (4, lambda a, b: a - b),
    "EQ": (3, lambda a, b: float(abs(a - b) < _SAME)),
    "NE": (3, lambda a, b: float(abs(a - b) >= _SAME)),
    "GT": (3, lambda a, b: float(a > b)),
    "GE": (3, lambda a, b: float(a >= b)),
    "LT": (3, lambda a, b: float(a < b)),
    "LE": (3, lambda a, b: float(a <= b)),
    "AND": (2, lambda a, b: float(a != 0 and b != 0)),
    "OR": (2, lambda a, b: float(a != 0 or b != 0)),
    "XOR": (2, lambda a, b: float((a != 0) != (b != 0))),
}
_FUNCTIONS: Mapping[str, Callable[[float], float]] = {
    "ABS": abs,
    "ACOS": lambda v: math.degrees(math.acos(v)),
    "ASIN": lambda v: math.degrees(math.asin(v)),
    "COS": lambda v: math.cos(math.radians(v)),
    "EXP": math.exp,
    "FIX": lambda v: float(math.floor(v)),
    "FUP": lambda v: float(math.ceil(v)),
    "LN": math.log,
    "ROUND": lambda v: float(math.trunc(v + math.copysign(0.5, v))),
    "SIN": lambda v: math.sin(math.radians(v)),
    "SQRT": math.sqrt,
    "TAN": lambda v: math.tan(math.radians(v)),
}


@dataclass(slots=True)
class ExpressionReader:
    """Reads names and values off the code of a row; `at` is the place that comes next."""

    code: str
    line: int
    run: Parameters
    at: int = 0

    def take(self, text: str) -> bool:
        """Go on behind a text, if it comes next."""
        if self.code.startswith(text, self.at):
            self.at += len(text)
            return True
        return False

    def letter(self) -> str:
        """The letter of a word."""
        char = self.code[self.at]
        if not (char.isalpha() or char in "$@^"):
            raise self._unread()
        self.at += 1
        return char

    def name(self) -> str:
        """The name or the number of the parameter that comes next, behind its #."""
        self.take("#")
        if self.code.startswith("<", self.at):
            end = self.code.find(">", self.at)
            if end < 0:
                raise self._unread()
            name = self.code[self.at : end + 1]
            self.at = end + 1
            return name
        return str(round(self.value()))

    def value(self) -> float:
        """A number, a parameter, a function, or an expression in brackets, with its sign."""
        if self.take("-"):
            return -self.value()
        if self.take("+"):
            return self.value()
        if self.take("["):
            return self._expression()
        if self.code.startswith("#", self.at):
            return self.run.get(self.name(), self.line)
        if found := _NUMBER.match(self.code, self.at):
            self.at = found.end()
            return float(found[0])
        return self._function()

    def _function(self) -> float:
        if self.take("EXISTS["):
            name = self.name()
            if not self.take("]"):
                raise self._unread()
            return float(self.run.knows(name))
        if self.take("ATAN"):
            rise = self.value()
            if not self.take("/"):
                raise self._unread()
            return math.degrees(math.atan2(rise, self.value()))
        for name, function in _FUNCTIONS.items():
            if self.code.startswith(f"{name}[", self.at):
                self.at += len(name)
                value = self.value()
                return self._worked_out(partial(function, value))
        raise self._unread()

    def _expression(self) -> float:
        """What stands up to the closing bracket: operators of one precedence from left to right."""
        values, waiting = [self.value()], list[str]()
        while True:
            sign = next((name for name in _OPERATORS if self.code.startswith(name, self.at)), "")
            sign = "**" if self.code.startswith("**", self.at) else sign
            ends = not sign and self.take("]")
            if not sign and not ends:
                raise self._unread()
            while waiting and (ends or _OPERATORS[waiting[-1]][0] >= _OPERATORS[sign][0]):
                right, left = values.pop(), values.pop()
                operator = _OPERATORS[waiting.pop()][1]
                values.append(self._worked_out(partial(operator, left, right)))
            if ends:
                return values[0]
            self.at += len(sign)
            waiting.append(sign)
            values.append(self.value())

    def _worked_out(self, work: Callable[[], float]) -> float:
        try:
            value = work()
        except (ArithmeticError, ValueError):
            value = math.nan
        if isinstance(value, complex) or not math.isfinite(value):
            why = "it divides by zero, or has a root or an angle that is none"
            raise _wrong(self.line, f"'{self.code}' cannot be worked out: {why}")
        return value

    def _unread(self) -> InputError:
        shown = self.code[self.at : self.at + 20]
        return _wrong(self.line, f"cannot read '{shown or self.code}' in '{self.code[:60]}': not supported here")


def _wrong(line: int, message: str) -> InputError:
    return InputError(message, line=line)
