"""The controls whose programs the check reads, and how each splits them into lines, words and comments."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import compress, count
from typing import Literal, NamedTuple

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point

LONGEST = 252
"""Bytes of a row without its LF: LinuxCNC stops at a longer one, in the middle of a sheet (`LINELEN` in its source)."""
_NEVER_SHOWN = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories of controls, of marks that turn or join text, of halves of characters, and of separators."""


class Setup(NamedTuple):
    """What a program's path and times depend on besides its control: how the machine stands, and is set.

    Attributes
    ----------
    travel_mm_s
        Speed of its rapids, for the times.
    home
        Where the program finds the torch.
    held_s
        How long the control holds the torch by itself where it starts to cut, and where it starts to mark.
    tab_mm
        A torch that goes off, moves on at a feed for no more than this, and is lit again, burns on.
    torches
        How many stand side by side; words say which of them burn.
    """

    travel_mm_s: float = 100.0
    home: Point = (0.0, 0.0)
    held_s: tuple[float, float] = (0.0, 0.0)
    tab_mm: float = 0.0
    torches: int = 1


AS_IT_COMES = Setup()


@contextmanager
def in_file(file: str) -> Iterator[None]:
    """What is refused meanwhile is refused with the file's name, where it has one."""
    try:
        yield
    except InputError as error:
        place = {"line": error.line, "column": error.column}
        raise InputError(error.message, file=file or None, **place, details=error.details) from None


def rows_of(text: str, longest: int = LONGEST, obeyed: str = "") -> Iterator[tuple[int, str]]:
    """The rows, numbered from 1, without their line ends; none is over `longest` bytes.

    `obeyed` are characters that the control takes for commands wherever they stand. Raises InputError with line and
    column, for a row that is too long, and for characters that programs treat differently.

    Examples
    --------
    >>> list(rows_of("G21\\r\\nM2\\n"))
    [(1, 'G21'), (2, 'M2')]
    """
    rows = text.split("\n")
    if text.isascii() and "".join(rows).isprintable() and len(max(rows, key=len)) <= longest and not obeyed:
        yield from enumerate(rows if rows[-1] else rows[:-1], 1)  # most programs
        return
    for line, row in enumerate(rows, 1):
        if line == len(rows):  # what follows the last LF
            if row:
                yield line, _plain(row, line, 0, longest, obeyed)
        else:
            bare = row.removesuffix("\r")
            yield line, _plain(bare, line, len(row) - len(bare), longest, obeyed)


def _plain(row: str, line: int, cr: int, longest: int, obeyed: str) -> str:
    for column, char in enumerate(row, 1) if obeyed else ():
        if char in obeyed or not char.isascii():
            raise InputError(
                f"'{char}' (U+{ord(char):04X}), which the control takes for a command wherever it stands, comments "
                "included: not supported here; delete it",
                line=line,
                column=column,
            )
    if row.isascii() and row.isprintable() and len(row) + cr <= longest:
        return row
    for column, char in enumerate(row, 1):
        if char != "\t" and unicodedata.category(char) in _NEVER_SHOWN:
            raise InputError(_found(char), line=line, column=column)
    if (size := len(row.encode()) + cr) > longest:
        raise InputError(
            f"the line has {size} bytes: more than {longest} are not supported here, nor by controls; write it shorter",
            line=line,
            column=longest + 1,
        )
    return row


def _found(char: str) -> str:
    if char == "\r":
        return (
            "a carriage return (CR) in the middle of a line: some programs end the line there, the control does not; "
            "not supported here; save the program with line ends LF or CRLF"
        )
    if char == "\ufeff":
        return "a byte order mark (U+FEFF), not supported here; save the program as UTF-8 without it"
    return (
        f"the character U+{ord(char):04X}, which is not shown and which programs treat differently; not supported "
        "here; delete it"
    )


MISMATCH_MM = 0.005
"""Radius at an arc's end against that at its start, at most: LinuxCNC takes 0.0283 mm, and 0.1 % of large radii; what
lies between the two is the control's choice."""

# The controls whose programs the check reads, and how each spells them: written apart from the dialects.

_LINUXCNC_G = frozenset(
    {0.0, 1.0, 2.0, 3.0, 4.0, 17.0, 20.0, 21.0, 40.0, 49.0, 54.0, 61.0, 61.1, 64.0, 80.0, 90.0, 90.1, 91.0, 91.1, 92.1}
    | {94.0, 97.0}
)


class Declared(NamedTuple):
    """Words that touch neither path nor torch: their pattern, where they may stand, and how they are told.

    `sets` says that they hold from there on, as words of a process do, until others with the same first number come.
    """

    pattern: re.Pattern[str]
    where: Literal["anywhere", "header", "off", "on"]
    words: str
    sets: bool = False


@dataclass(frozen=True, slots=True)
class Control:
    """How a control spells a program; tool 0 cuts, any other marks.

    `known_g` and `known_m` are the words that it reads, `refused_m` say of others why not. `numbered` says that M3 and
    M5 name their tool by $; else there is only one, which cuts. `marks_by` is the digital output that M64 sets and M65
    clears to mark, None where those words are not for that. `starts` and `stops` are M words that switch a tool of
    their own. `speed_output` is the E of the M67 and M68 that change the speed. `filtered` says that QtPlasmaC's filter
    rewrites a program before it is run.

    `beam` says that it is a laser of GRBL, lit by M3 and M4 with a power S in moves at a feed only. A laser marks up to
    the power `marks_up_to`, `full_power` is 100 %; both are 0 where S says nothing of that. `dwell` is the letter of
    the seconds of G4. `bare` says that X and Y without a motion word are a line with the torch on, and travel with it
    off. `fixed` are G words in force always, which nobody has to say. `program` is the letter of the number that a
    program begins with. `longest` is the greatest number of bytes of a line, `longest_code` that without blanks and
    comments. `obeyed` are characters that it obeys wherever they stand, and with which none beyond ASCII may stand
    either.

    `selects` and `deselects` are the M words, with the letter of the torch's number and what that is less, by which
    further torches burn with the first one, where there are any.

    `process` is the M word that selects by T what `starts` and `stops` switch; the processes `marking` mark.

    `arcs` says that programs are ESSI (ISO 6582), blocks of signed numbers without letters, and how arcs are told
    there, by centre or by radius. `step_mm` is what 1 means there; feeds are whole, in steps of `feed_step_mm_min`.

    `also` are words that touch neither path nor torch, `means` words of its own with the code that they stand for, and
    `program_names` rows that only name a program. `opens` are the characters that begin a comment anywhere in a row,
    `comment_form` is how rows that are comments begin and end besides. `decimal` is the point of its numbers. `dwell_s`
    and `place_mm` are what 1 means in a wait and, in mm or inches, in a place, `feed_mm_min` in a feed, where that does
    not count in the program's units. The radius of an arc may differ by
    `mismatch_mm` between its ends. `halts_lit` says that a program may halt with the torch on, before that moves.
    `subprograms` says that a program of ours may call such by M98.
    Where it starts to cut it stands for `stands_s` by words of its own, for `preheat_s` of these with the torch off;
    where it has stopped it stands for `rests_s`.
    `kerf_mm` is the kerf that it adds itself where a program says so (G41, G42), None where no program may.
    `rotary` are the letters of the axes that tilt and turn a torch, in this order, "" where none does; where these move
    alone F counts degrees a minute, or turns (`turns_rpm`).
    `fed_by_chart` says that a program without F words is cut at the feed of the control's cut chart.
    `foreign` are M words of its family that this control does not have, though words of its own mean them. `heights`
    are the words that stop height control and start it again. `modal` says that a motion word holds until another one.
    """

    title: str
    known_m: frozenset[float]
    known_g: frozenset[float] = _LINUXCNC_G
    refused_m: Mapping[float, str] = field(default_factory=dict)
    numbered: bool = False
    marks_by: int | None = None
    starts: Mapping[float, int] = field(default_factory=dict)
    stops: Mapping[float, int] = field(default_factory=dict)
    speed_output: float | None = None
    filtered: bool = False
    beam: bool = False
    marks_up_to: float = 0.0
    full_power: float = 0.0
    dwell: str = "P"
    bare: bool = False
    centre_absolute: bool = False
    fixed: frozenset[float] = frozenset()
    comments: bool = True
    program: str = ""
    longest: int = LONGEST
    longest_code: int = LONGEST
    obeyed: str = ""
    selects: float | None = None
    deselects: float | None = None
    torch_letter: str = "T"
    torch_less: int = 0
    process: float | None = None
    marking: frozenset[float] = frozenset()
    arcs: Literal["", "centre", "radius"] = ""
    step_mm: float = 0.0
    feed_step_mm_min: float = 0.0
    also: tuple[Declared, ...] = ()
    means: tuple[tuple[re.Pattern[str], str], ...] = ()
    program_names: tuple[re.Pattern[str], ...] = ()
    opens: str = "(;"
    comment_form: tuple[str, str] | None = None
    decimal: str = "."
    dwell_s: float = 1.0
    place_mm: float = 1.0
    mismatch_mm: float = MISMATCH_MM
    feed_mm_min: float | None = None
    subprograms: bool = False
    halts_lit: bool = False
    preheat_s: float = 0.0
    stands_s: float = 0.0
    rests_s: float = 0.0
    kerf_mm: float | None = None
    rotary: str = ""
    turns_rpm: bool = False
    fed_by_chart: bool = False
    foreign: frozenset[float] = frozenset()
    heights: tuple[float, ...] = ()
    modal: bool = True

    @property
    def has_own_words(self) -> bool:
        """Whether a row may hold words that no family of controls has."""
        return bool(self.also or self.means or self.program_names or self.decimal != ".")


MARKS_UP_TO = 0.4
"""The share of full power up to which a laser's beam marks, where a profile does not say its powers."""
_COMMON_M = frozenset({0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 9.0, 30.0, 48.0, 49.0, 50.0, 51.0, 53.0})
_MATERIAL = "it selects another material on the machine than the profile's; select it by hand and post without"
_WAITS = "how long it waits for the machine is not known; post the program without"
_MID_CUT = "it can stop the torch while the path goes on; post the program without"
_LOADS = "it loads another program on the control, which is not checked; post the program with M02 at its end"


def _essi(title: str, arcs: Literal["centre", "radius"]) -> Control:
    none: frozenset[float] = frozenset()
    return Control(title, known_m=none, known_g=none, comments=False, arcs=arcs, step_mm=0.1, feed_step_mm_min=1.0)


_SECONDS = r"-?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_ON_START = rf"(?:HS|TH|O2S|(?:AVO|AVD|CCO|CHD|CHT|MAF|MHF|MNF|PCF|PHT|PJH|PTO|SCF|SPF|THT){_SECONDS})"
"""What stands behind M07 in Hypertherm's programs (809550, tables 1 and 2): values in place of the cut chart's."""
_ON_STOP = f"(?:T{_SECONDS}(?:R[TF])?|R[TF](?:{_SECONDS})?)"
"""What stands behind M08, M10 and M14: how much earlier or later, and how high the torch is lifted."""

CONTROLS: Mapping[str, Control] = {
    "linuxcnc-qtplasmac": Control(
        "LinuxCNC with QtPlasmaC",
        numbered=True,
        known_m=_COMMON_M | {52.0, 67.0, 68.0},
        speed_output=3.0,
        filtered=True,
        refused_m={190.0: _MATERIAL, 66.0: _WAITS} | dict.fromkeys((62.0, 63.0, 64.0, 65.0), _MID_CUT),
    ),
    "linuxcnc": Control(
        "LinuxCNC",
        marks_by=0,
        selects=64.0,
        deselects=65.0,
        torch_letter="P",
        torch_less=1,
        known_m=_COMMON_M | {64.0, 65.0, 67.0, 68.0},
        refused_m={66.0: _WAITS} | dict.fromkeys((62.0, 63.0), _MID_CUT),
    ),
    "grbl": Control(
        "GRBL in laser mode",
        known_g=_LINUXCNC_G - {61.1, 64.0, 90.1, 97.0},
        known_m=frozenset({0.0, 2.0, 3.0, 4.0, 5.0, 8.0, 9.0, 30.0}),
        fixed=frozenset({61.0, 91.1}),
        beam=True,
        marks_up_to=MARKS_UP_TO * 1000.0,
        full_power=1000.0,
        longest=127,
        longest_code=79,
        obeyed="!?~",
    ),
    "eia": Control(
        "Hypertherm EDGE with Phoenix",
        known_g=frozenset({0.0, 1.0, 2.0, 3.0, 4.0, 20.0, 21.0, 40.0, 90.0, 91.0}),
        known_m=frozenset(
            {0.0, 1.0, 2.0, 7.0, 8.0, 9.0, 10.0, 13.0, 14.0, 15.0, 16.0, 30.0, 36.0, 37.0, 38.0, 48.0, 49.0, 50.0, 51.0}
        ),
        also=(
            Declared(re.compile(r"G59V5[0-9]{2}F[0-9.]+"), "off", "G59 V502 F34", sets=True),  # the cut chart's process
            Declared(re.compile(r"M(?:17|18|19|28|31)(?![0-9.])"), "off", "M19"),  # oxygen, stations, follower, reset
            Declared(re.compile(f"(?<=M07){_ON_START}+"), "off", "M07 HS"),  # height sensing, other values of the chart
            Declared(re.compile(r"(?<=M09)HS"), "off", "M09 HS"),
            Declared(re.compile(f"(?<=M(?:08|10|14)){_ON_STOP}"), "anywhere", "M08 RT"),
            Declared(re.compile(rf"(?<=M50)(?:H{_SECONDS}|N(?![0-9]))"), "anywhere", "M50 H-0.02"),
            Declared(re.compile(rf"(?<=M51)T{_SECONDS}"), "anywhere", "M51 T0.5"),
        ),
        means=((re.compile(f"M07(?:HS)?(?:N2(?![0-9])|AR){_ON_START}*"), "M07$1"),),  # the torch itself marks (XPR)
        turns_rpm=True,
        fed_by_chart=True,
        heights=(50.0, 51.0),
        selects=37.0,
        deselects=38.0,
        process=36.0,
        marking=frozenset({3.0, 4.0}),
        refused_m={65.0: _LOADS},
        starts={7.0: 0, 15.0: 0, 9.0: 1, 13.0: 1},
        stops={8.0: 0, 16.0: 0, 10.0: 1, 14.0: 1},
        dwell="X",
    ),
    "burny": Control(
        "Burny",
        known_g=frozenset({2.0, 3.0, 4.0, 40.0, 70.0, 71.0, 90.0}),
        known_m=frozenset({0.0, 1.0, 3.0, 4.0, 14.0, 15.0, 30.0}),
        starts={4.0: 0},
        stops={3.0: 0},
        heights=(14.0, 15.0),
        dwell="F",
        bare=True,
        centre_absolute=True,
        comments=False,
        program="P",
    ),
    "essi": _essi("ESSI, arcs by their centre", "centre"),
    "essi-radius": _essi("ESSI, arcs by their radius", "radius"),
}
"""By the name that a dialect gives as its `control`."""
QTPLASMAC = CONTROLS["linuxcnc-qtplasmac"]


# Comments of a row apart from its words; those that a control obeys are refused.

_OBEYED = re.compile(
    r"\s*(?P<word>abort,|debug,|print,|log,|logopen,|logappend,|logclose\s*$|py,|pyrun,|pyreload|probeopen|probeclose)",
    re.IGNORECASE,
)
"""What LinuxCNC's interpreter and its machine do not pass over; `msg,` only shows its text."""
_COMMENTED = re.compile(r"[();]")
_NO_BLANKS = str.maketrans("", "", " \t")
_SOLID = bytes(chr(k) not in " \t" for k in range(256))
"""For each byte whether it is no blank."""
COMMENT = " "
"""Stands for a comment between words: no number goes on behind it."""


class Row(NamedTuple):
    """A row of a program: `code` are its characters outside comments, without blanks, in capitals; a comment between
    words is one `COMMENT`.

    `columns` are the places of these characters, from 1, `comment_at` that of the first comment, if any.
    """

    code: str
    columns: tuple[int, ...]
    comments: tuple[str, ...]
    comment_at: int | None = None

    @property
    def trailing(self) -> bool:
        """Whether a comment stands behind words."""
        return self.comment_at is not None and bool(self.columns) and self.columns[0] < self.comment_at


def row_of(text: str, line: int, opens: str = "(;") -> Row:
    """Take the comments off a row; `opens` are the characters that begin one.

    Raises InputError with line and column, for a comment that is not closed, is in another, or that the control obeys;
    for characters that are not ASCII outside comments.

    Examples
    --------
    >>> row_of("g1 x 10.5 (to the corner)", 1).code
    'G1X10.5'
    """
    if text.isascii() and not _COMMENTED.search(text):  # most rows
        solid = tuple(compress(count(1), text.encode().translate(_SOLID)))
        return Row(text.translate(_NO_BLANKS).upper(), solid, ())
    code: list[str] = []
    columns: list[int] = []
    comments: list[str] = []
    at, comment_at = 0, None
    while at < len(text):
        char, start = text[at], at
        at += 1
        if char in opens:
            at = _end(text, start, line)
            body = text[start + 1 : at - 1] if char == "(" else text[start + 1 :]
            _harmless(body, line, start + 1)
            if char == "(" or body.strip():
                comments.append(body.strip())
            comment_at = comment_at or start + 1
            code.append(COMMENT)
            columns.append(start + 1)
        elif char == ")" and "(" in opens:
            raise InputError("a ')' that closes no comment: not supported here; delete it", line=line, column=at)
        elif char not in " \t":
            if not char.isascii():
                raise InputError(
                    f"'{char}' (U+{ord(char):04X}) outside a comment: not supported here; write it in ASCII",
                    line=line,
                    column=at,
                )
            code.append(char.upper())
            columns.append(at)
    kept = len("".join(code).rstrip(COMMENT))
    begin = kept - len("".join(code[:kept]).lstrip(COMMENT))
    return Row("".join(code[begin:kept]), tuple(columns[begin:kept]), tuple(comments), comment_at)


def _end(text: str, start: int, line: int) -> int:
    """Where the comment that begins at `start` has ended."""
    if text[start] == ";":
        return len(text)
    end, inner = text.find(")", start), text.find("(", start + 1)
    if 0 <= inner < end or (end < 0 and inner >= 0):
        raise InputError(
            "a comment inside a comment: not supported here; take the inner ( and ) out",
            line=line,
            column=inner + 1,
        )
    if end < 0:
        raise InputError(
            "the comment is not closed: not supported here; write ) at its end", line=line, column=start + 1
        )
    return end + 1


def _harmless(body: str, line: int, column: int) -> None:
    if found := _OBEYED.match(body):
        raise InputError(
            f"the comment '{body.strip()[:40]}' is a command to the control ({found['word'].strip(' ,').upper()}), not "
            "supported here; take it out, or begin the comment with another word",
            line=line,
            column=column,
        )


def without(row: Row, found: re.Match[str], instead: str = "") -> Row:
    """The row with some of its characters replaced; all that takes their place stands in their first column."""
    begin, end = found.span()
    columns = (*row.columns[:begin], *[row.columns[begin]] * len(instead), *row.columns[end:])
    code = row.code[:begin] + instead + row.code[end:]
    return Row(code, columns, row.comments, row.comment_at)
