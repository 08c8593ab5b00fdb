"""A small reader of RS274 programs of its own: what the torch does, line by line, as paths in mm.

It takes nothing from the writer: modal motion G0 to G3, G20 and G21, G90 and G91, arcs by I and J or by R, M3 and M5,
G4, and what each control has of its own (`controls`). It reads what LinuxCNC reads and as LinuxCNC does, or refuses it
with the place: what it does not understand, what it cannot check, and what different programs read differently.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace

from kerfwise.encoder.errors import InputError

from .controls import AS_IT_COMES, QTPLASMAC, Control, Declared, Row, Setup, in_file, row_of, rows_of, without
from .essi import read_essi
from .grammar import ModalState, refuse_conflicts
from .kerf_beside import ENDS, OFF, Beside, Listened, side_of, torch_moves, without_kerf
from .old_words import OldWords
from .program import NcProgram, Track
from .tools import Beam, Tools, ToolsOn, finish_program
from .unfold import UnfoldedRow, at_lines_of, needs_unfolding, unfold
from .words import Block, block_of

_KERF_MM = 0.001
"""By how much a kerf may differ that a program tells the control: it is written with so many digits."""
_M_WORD = re.compile(r"(?<![A-Z])M0*([0-9]+)(?![0-9.])")
_NAMES_CUT = re.compile(r"(?:CUT|MARK|PIERCE) \d+ |STRETCH ", re.IGNORECASE)


def read_nc(text: str, setup: Setup = AS_IT_COMES, file: str = "", control: Control = QTPLASMAC) -> NcProgram:
    """Read a program as the control runs it.

    Raises InputError with line and column, for what is malformed, not understood or not checked, and for a program
    without an end; for several torches, where the control has no words for them.

    Examples
    --------
    >>> program = read_nc("G21 G90\\nG0 X5 Y5\\nM3 $0 S1\\nG1 X15 F600\\nM5 $0\\nM2\\n")
    >>> [(burn.tool, burn.line, burn.path.length_mm) for burn in program.burns]
    [(0, 3, 10.0)]
    """
    expect_words_for(setup.torches, control, file)
    if control.arcs:
        return read_essi(text, control, setup, file)
    machine = Machine(control, setup)
    with in_file(file):
        rows = unfold(text) if control.subprograms and needs_unfolding(text) else None
        with at_lines_of(rows):
            for block in blocks(text if rows is None else "\n".join([*(row.text for row in rows), ""]), machine):
                machine.run(block)
            machine.expect_end()
            return at_lines(machine.done(), rows)


def at_lines(program: NcProgram, rows: Sequence[UnfoldedRow] | None) -> NcProgram:
    """A program that was read unfolded, with the lines that stand in its file."""
    if rows is None:
        return program
    return replace(
        program,
        burns=tuple(replace(burn, line=rows[burn.line - 1].line) for burn in program.burns),
        hot_rapids=tuple(replace(one, line=rows[one.line - 1].line) for one in program.hot_rapids),
        slow_travel=tuple(replace(one, line=rows[one.line - 1].line) for one in program.slow_travel),
        faults=tuple(replace(one, line=rows[one.line - 1].line if one.line else 0) for one in program.faults),
        rapids=tuple((rows[line - 1].line, at) for line, at in program.rapids),
    )


def expect_words_for(torches: int, control: Control, file: str = "") -> None:
    """Refuse several torches where nobody can tell which of them burn."""
    if torches > 1 and control.selects is None:
        text = (
            f"no words by which {control.title} selects torches are known here, and the profile has {torches} torches"
        )
        raise InputError(f"{text}: say machine: {{torches: {{count: 1}}}}", file=file or None)


class Machine:
    """Runs blocks in the order in which the control executes their words; `further` are words it takes besides."""

    def __init__(self, control: Control, setup: Setup, further: OldWords | None = None) -> None:
        self.control = control
        self.further = further
        self.track = Track(setup.travel_mm_s, setup.home, tab_mm=setup.tab_mm, preheat_s=control.preheat_s)
        self.tools: ToolsOn = (
            Beam(self.track, control, setup.held_s)
            if control.beam
            else Tools(self.track, control, setup.held_s, count=setup.torches)
        )
        self.moves = ModalState(self.track, control)
        if further is not None and control.fed_by_chart:
            self.moves.charted = further.charted
        self.filter = Filter(self.track) if control.filtered else None
        self.comments: list[str] = []
        self.line = 0
        self.own_line = 0
        """The last line with words that touch neither path nor torch."""
        self.blocks = 0
        """How many rows so far were more than comments."""
        self._without_conflicts: set[tuple[object, ...]] = set()
        self._named = -1
        self._left: bool | None = None
        self._waiting: list[Block] = []

    def run(self, block: Block) -> None:
        """Run a block; what lies between G41 or G42 and G40, where the control adds the kerf, once that has come."""
        kerf_mm = self.control.kerf_mm
        side = side_of(block) if kerf_mm is not None else None
        if kerf_mm is None or (side is None and self._left is None):
            self._run(block)
            return
        over = any(word.value in OFF for word in block.g) or any(word.value in ENDS for word in block.m)
        if side is not None and self._left is not None:
            raise block.refused("another G41 or G42 before G40: not supported here; write G40 between them")
        if side is not None:
            self._left = side
            self._expect_kerf(block, kerf_mm)
        if not over:
            self._waiting.append(without_kerf(block))
            return
        self._run_beside(self._left is True, kerf_mm / 2)
        self._run(block)

    def _run_beside(self, left: bool, half_mm: float) -> None:
        """Run the blocks that wait, the torch half the kerf beside the path that they name."""
        waiting, self._waiting, self._left = self._waiting, [], None
        moves, named = copy(self.moves), Listened(self.track.at)
        moves.modes = copy(self.moves.modes)
        self.moves.track = named  # type: ignore[assignment]
        for block in waiting:
            motion = self.moves.of(block)
            self.moves.feed(block)
            self.moves.move(block, motion)
        self.moves = moves
        made = torch_moves(named.heard, left, half_mm) if named.heard else []
        self.moves.track = Beside(self.track, self.track.at, made)  # type: ignore[assignment]
        for block in waiting:
            self._run(block)
        self.moves.track = self.track

    def _expect_kerf(self, block: Block, kerf_mm: float) -> None:
        """Note a program that says another kerf (G41.1 D1.5) than the profile has."""
        dynamic = any(word.value in (41.1, 42.1) for word in block.g)
        said_mm = block.of("D") * self.moves.unit_mm if dynamic and "D" in block.words else kerf_mm
        if abs(said_mm - kerf_mm) > _KERF_MM:
            text = f"the control is told a kerf of {said_mm:g} mm, and the profile's is {kerf_mm:g} mm"
            self.track.fault(block.line, "program-state", text)

    def _run(self, block: Block) -> None:
        """Comments, feed, tools, wait, modes, motion, end."""
        self.line = block.line
        self.blocks += bool(block.g or block.m or block.words)
        for text in block.comments:
            self._remember(text)
        if self._names_program(block):
            return
        motion = self.moves.of(block)
        self._refuse_conflicts(block, motion)
        self.moves.feed(block)
        if block.m or self.control.beam:
            self.tools.switch(block, motion, self.moves.modal(block))
        self.moves.wait(block)
        if self.control.bare:  # there the torch, which this very block may have switched, tells a line from travel
            motion = self.moves.of(block)
        self.moves.move(block, motion)
        if block.m:
            self.tools.halt(block)

    def _remember(self, text: str) -> None:
        """Keep a comment; one that names the next cut stays that burn's, whatever is said to the operator behind it."""
        self.comments.append(text)
        burn, names = len(self.track.burns) + (self.track.open is not None), bool(_NAMES_CUT.match(text))
        if names or self._named != burn:
            self.track.comment = text
        if names:
            self._named = burn

    def _refuse_conflicts(self, block: Block, motion: float | None) -> None:
        """See `refuse_conflicts`: whether there are any hangs on words, not on the numbers of those by letter."""
        codes = (tuple([word.value for word in block.g]), tuple([word.value for word in block.m]))
        kind = (motion, *codes, *block.words)
        if kind not in self._without_conflicts:
            refuse_conflicts(block, motion, self.control)
            self._without_conflicts.add(kind)

    def _names_program(self, block: Block) -> bool:
        """Whether a block only gives the program's number, as some controls want it to."""
        if block.g or block.m or self.track.burns or self.track.open is not None:
            return False
        return list(block.words) == [self.control.program]

    def without_own(self, row: Row, line: int) -> Row:
        """A row without words of the control's own: those that mean a known one are spelt so, others are left out.

        Raises InputError with line and column, for a word where it may not stand.
        """
        code, control = row.code, self.control
        if control.decimal != "." and control.decimal in code:
            row = row._replace(code=code.replace(control.decimal, "."))
        if not (self.track.burns or self.track.open) and any(
            name.fullmatch(row.code) for name in control.program_names
        ):
            return Row("", (), row.comments, row.comment_at)
        for also in control.also:
            for found in reversed(list(also.pattern.finditer(row.code))):
                self._expect_there(also, row, found.start(), line)
                if also.sets and self.further is not None:
                    self.further.set_process(found[0])
                else:
                    self.own_line = line
                row = without(row, found)
        self._expect_own(row, line)
        for own, known in control.means:
            for found in reversed(list(own.finditer(row.code))):
                row = without(row, found, known.format(**found.groupdict()))
        self.blocks += bool(code) and not row.code
        return row

    def _expect_own(self, row: Row, line: int) -> None:
        """Refuse a word that the control's family has, and the control itself has not, or for something else."""
        rest = row.code if self.control.foreign else ""
        for own, _ in self.control.means:
            rest = own.sub(" ", rest)
        for found in (one for one in _M_WORD.finditer(rest) if float(one[1]) in self.control.foreign):
            text = f"{found[0]} is not understood, and not supported here, in a program for {self.control.title}"
            why = "its dialect has no such word; name it under also if it neither moves nor switches anything"
            raise InputError(f"{text}: {why}", line=line, column=row.columns[row.code.index(found[0])])

    def _expect_there(self, also: Declared, row: Row, at: int, line: int) -> None:
        """Refuse a word where it may not stand."""
        lit = self.track.open is not None
        begun = lit or bool(self.track.burns)
        if (also.where, lit) in (("off", True), ("on", False)) or (also.where == "header" and begun):
            where = {"header": "before the first cut", "off": "with the torch off", "on": "with the torch on"}
            text = f"{also.words} stands here, and may only stand {where[also.where]}: not supported here"
            raise InputError(text, line=line, column=row.columns[at])

    def expect_end(self) -> None:
        """Refuse a program that has come to no end."""
        if not self.tools.ended:
            raise InputError("the program has no end: expected M2 or M30", line=self.line or None)

    def done(self) -> NcProgram:
        """What the program did."""
        return finish_program(self.track, self.tools, self.line, self.comments, self.blocks)


def blocks(text: str, machine: Machine) -> Iterator[Block]:
    """The blocks of a program; behind its end it holds nothing but comments."""
    opened: bool | None = None
    control = machine.control
    for line, raw in rows_of(text, control.longest, control.obeyed):
        row = comment_of_form(raw, control) or row_of(raw, line, control.opens)
        _expect_fit(row, line, control)
        if opened is None and raw.strip():
            opened = row.code == "%" and not row.comments
            if opened:
                continue
        if row.code == "%" and not row.comments and opened and not machine.tools.ended:
            machine.tools.ended = True  # a closing % ends a program as M2 does
        elif row.code == "%" and machine.tools.ended:
            continue
        elif row.code and machine.tools.ended:
            raise InputError(
                "words behind the program's end, which no control runs: not supported here; delete them",
                line=line,
                column=row.columns[0],
            )
        elif row.code or row.comments:
            if control.has_own_words:
                row = machine.without_own(row, line)
            as_written = row
            if machine.further is not None:
                row = machine.further.plain(row, line, machine.moves)
            block = block_of(row, line, control.rotary)
            if machine.filter is not None and (row is as_written or row.code):
                machine.filter.pass_(raw, row, line, machine.moves.absolute)
            if not machine.tools.ended:
                yield block


def comment_of_form(raw: str, control: Control) -> Row | None:
    """A row that is a comment as the control spells it; None for any other."""
    if control.comment_form is None:
        return None
    (begins, ends), text = control.comment_form, _NUMBERED.sub("", raw.strip(), count=1)
    if not text.upper().startswith(begins.upper()) or not text.endswith(ends):
        return None
    body = text[len(begins) : len(text) - len(ends)].strip()
    return Row("", (), (body,), len(raw) - len(raw.lstrip()) + 1)


_NUMBERED = re.compile(r"N[0-9]+\s*", re.IGNORECASE)


def _expect_fit(row: Row, line: int, control: Control) -> None:
    """Refuse a comment where the control knows none, and more words in a line than it holds."""
    if row.comments and not control.comments:
        text = f"a comment, which {control.title} does not know: not supported here; post the program without"
        raise InputError(text, line=line, column=row.comment_at)
    if len(row.code) > control.longest_code:
        raise InputError(
            f"the line has {len(row.code)} characters without blanks and comments: {control.title} takes "
            f"{control.longest_code}; write it shorter",
            line=line,
            column=row.columns[control.longest_code],
        )


# QtPlasmaC: what its filter makes of a program before it runs, and its words for material, tool and speed.

# What QtPlasmaC's filter makes of a program before it runs: it rewrites lines, and comments some out.
#
# The filter (`qtplasmac_gcode`, part of LinuxCNC) looks for letters anywhere in a line, its comments included. Where
# it would change what a line does, the check has read another program than the one that runs.

_NUMBER = re.compile(r"[Nn](?P<digits>[0-9.\s]*)")
_MAGIC = re.compile(r"\(\s*o\s*=|;conversational block|;qtplasmac filtered G-code file", re.IGNORECASE)
_TAKEN_FOR_WORDS = re.compile(r"z[0-9. \[-]|g2[01]|g4[012]|g9[01]|m66|\[#<")
_MOVES = ("g0x", "g0y", "g1x", "g1y")


@dataclass(slots=True)
class Filter:
    """Follows the filter; it starts no tool before it has seen a line that begins with a move of X or Y."""

    track: Track
    moved: bool = False
    raised: bool = False

    def pass_(self, raw: str, row: Row, line: int, absolute: bool) -> None:
        """Pass a row on; `absolute` is how the program counts before it (G90).

        Raises InputError with line and column, for a row that the filter would change, or obey.
        """
        if ("(" in raw or ";" in raw) and (found := _MAGIC.search(raw)):
            raise InputError(
                f"QtPlasmaC obeys '{found[0]}' in a comment: not supported here; take it out",
                line=line,
                column=found.start() + 1,
            )
        text = raw.strip()
        if row.code.startswith("N"):
            text = self._without_number(raw, line)
        if not text or text[0] in "(;" or row.code == "%":
            return
        if not text[0].isalpha():
            raise InputError(
                f"a line that begins with {text[0]}, which QtPlasmaC makes a comment of: not supported here; write "
                "its G or M word first",
                line=line,
                column=row.columns[0],
            )
        if row.trailing:
            self._comment(raw, text, row, line)
        self._starts(text, line, absolute)

    def _without_number(self, raw: str, line: int) -> str:
        text = raw.strip()
        found = _NUMBER.match(text)
        if found is None or not found["digits"] or not (found["digits"][0].isdigit() or found["digits"][0] == "."):
            raise InputError(
                "N apart from its number, which QtPlasmaC makes a comment of: not supported here; write such as N10",
                line=line,
                column=raw.index(text[0]) + 1,
            )
        return text[found.end() :].lstrip()

    def _comment(self, raw: str, text: str, row: Row, line: int) -> None:
        """A comment behind words: one at the line's end, with nothing that the filter takes for a word."""
        column = min(raw.index(char) for char in "(;" if char in raw) + 1
        if row.columns[-1] > column:
            why = "words behind a comment"
        elif ("(" in text) != (text.rstrip(". ")[-1:] == ")"):
            why = "a '(' or ')' in a comment behind words"
        elif "(" in text and ";" in text and text.index("(") < text.index(";"):
            why = "two comments behind words"
        elif found := _TAKEN_FOR_WORDS.search(text, text.index(raw[column - 1])):
            why = f"'{found[0]}' in a comment behind words"
        else:
            return
        raise InputError(
            f"{why}, which QtPlasmaC's filter misreads: not supported here; give the comment a line of its own",
            line=line,
            column=column,
        )

    def _starts(self, text: str, line: int, absolute: bool) -> None:
        if self.raised and self.moved and text[0] not in "Mm":  # most lines: they change nothing
            return
        code = text.lower().replace(" ", "")
        if code[1:2] == "0":
            code = re.sub(r"^([gm])0+(?=[0-9])", r"\1", code)
        if not self.raised and re.search("g0|g1|m3", code):
            self.raised = True
            if not absolute:
                raise InputError(
                    "the first move of a program that counts from place to place (G91): QtPlasmaC raises the torch "
                    "before it by G53, at which the control stops; not supported here; write G90 first, G91 later",
                    line=line,
                )
        if code.startswith(_MOVES):
            self.moved = True
        if "m3" in code and "m30" not in code and not self.moved:
            self.track.fault(
                line, "program-state", "QtPlasmaC starts no tool before a line that begins with G0 or G1 and X or Y"
            )
        if code.startswith("m5") and re.match(r"m5(?![0-9])", code):
            self.moved = False
