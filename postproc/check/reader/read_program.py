"""A program read as the control of the profile's machine runs it, whole, in the coordinates of the drawing."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.dialects import fitting_dialect, pierce_dwell_of
from kerfwise.rules.profile.plant_sections import Origin
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.profile.values import Frame

from .controls import AS_IT_COMES, COMMENT, QTPLASMAC, Control, Row, Setup, in_file, row_of, rows_of
from .essi import read_essi
from .grammar import DWELL, MOTION, NO_MOTION, ROUNDING, UNCHANGING, group_of, refused_g
from .old_words import OldWords
from .own_words import control_for
from .program import LineEffect, NcProgram, State, parted_where_leads_cross
from .rs274 import Machine, blocks, comment_of_form, expect_words_for, read_nc
from .tools import HALTS
from .unfold import UnfoldedRow, at_lines_of, needs_unfolding, unfold
from .words import BOUNDS, NOT_READ, Block, Word

_NUMBER = r"-?\d+(?:\.\d+)?"
_ORIGIN = re.compile(
    rf"ORIGIN (?P<origin>DRAWING|SHEET CORNER)(?:, AT X(?P<x>{_NUMBER}) Y(?P<y>{_NUMBER}) OF THE DRAWING)?",
    re.IGNORECASE,
)
_ORIGINS: Mapping[str, Origin] = {"DRAWING": "drawing", "SHEET CORNER": "sheet-corner"}


def read_on_machine(
    text: str, nest: Nest, profile: Technique, file: str = "", trusted: Trusted | None = None
) -> NcProgram:
    """Read a program as the machine runs it; where the control holds the pierce delay itself, its clock has it too.

    Where the machine's zero lies on the drawing the program's own comment says, else the profile. Words that leave the
    feed, and what else a material has, to the machine are refused, unless they are `trusted`. Raises InputError with
    the line, for what is malformed or not understood; for a dialect that does not fit the profile's process.
    """
    machine = profile.machine
    if trusted is None:
        control, setup = _as_set(profile)
        program = read_nc(text, setup, file, control)
    else:
        program = old_on_machine(text, profile, trusted, file).program
    origin, zero = stated_origin(program)
    if zero is None:
        zero = profile.at_origin(origin or machine.origin).frame_on(nest).corner
    return replace(shift_program(program, zero), origin=origin, zero=zero if origin else None)


def old_on_machine(text: str, profile: Technique, trusted: Trusted, file: str = "") -> OldProgram:
    """Read a program of which there is no nest, line by line, in its own coordinates.

    Raises InputError as `read_old` does; for a dialect that does not fit the profile's process.
    """
    control, setup = _as_set(profile)
    return read_old(text, control, trusted.feed_mm_min, setup, file)


def _as_set(profile: Technique) -> tuple[Control, Setup]:
    """The control, and how its machine is set. Raises InputError as `control_of` does."""
    machine, (control, held_s) = profile.machine, control_of(profile)
    return control, Setup(machine.travel_mm_s, machine.home, held_s, _unlit_mm(profile), _torches(profile))


def _torches(profile: Technique) -> int:
    """How many torches words select: with a block the first is that of a machine without one, and never burns."""
    return 4 if profile.cuts.bevel.head == "block" else profile.machine.torches.count


def _unlit_mm(profile: Technique) -> float:
    """How far the torch may move on unlit within a burn: over tabs, where the profile has any but at the end."""
    tabs = profile.tabs()
    return 0.0 if tabs is None or tabs.at_end else tabs.longest_mm


def control_of(profile: Technique) -> tuple[Control, tuple[float, float]]:
    """The control that runs the profile's programs, and how long it holds the torch by itself to cut, and to mark.

    That of a laser tells marks from cuts by the profile's power, where it says one. Raises InputError for a dialect
    that does not fit the profile's process.
    """
    machine, material, dialect = profile.machine, profile.material, fitting_dialect(profile)
    by_machine = pierce_dwell_of(profile, dialect) == "machine"
    control = control_for(dialect, machine.dialect)
    if (bevel := profile.cuts.bevel).head is not None and dialect.rotary:
        control = replace(control, rotary=bevel.tilt + bevel.turn)
    if dialect.kerf is not None:
        control = replace(control, kerf_mm=material.kerf_mm)
    pierce_s = max(machine.pierce_time_s - control.stands_s, 0.0)
    held_s = (pierce_s, machine.mark_time_s) if by_machine else (0.0, 0.0)
    if not control.full_power or material.power is None:
        return control, held_s
    cuts = material.power
    marks = 0.0 if material.mark_power is None else material.mark_power
    marks_up_to = min(control.marks_up_to, (cuts + marks) / 200 * control.full_power)
    return replace(control, marks_up_to=marks_up_to), held_s


def with_program_origin(program: NcProgram, profile: Technique) -> Technique:
    """The profile with the origin that the program says it has."""
    return profile if program.origin is None else profile.at_origin(program.origin)


def origin_warning(program: NcProgram, profile: Technique) -> Iterator[str]:
    """A warning where a program says another origin than the profile."""
    if program.origin is not None and program.origin != profile.machine.origin:
        origin = profile.machine.origin
        yield f"the program's origin is {program.origin}, the profile says {origin}: the program's counts"


def stated_origin(program: NcProgram) -> tuple[Origin | None, Point | None]:
    """The origin that a program states, and the point of the drawing that is its zero."""
    found = next(filter(None, map(_ORIGIN.fullmatch, program.comments)), None)
    if found is None:
        return None, None
    origin = _ORIGINS[found["origin"].upper()]
    if found["x"] is None:
        return origin, (0.0, 0.0) if origin == "drawing" else None
    return origin, (float(found["x"]), float(found["y"]))


def shift_program(program: NcProgram, zero: Point) -> NcProgram:
    """The program in the coordinates of a drawing, a point of which is its zero."""
    frame = Frame(zero)
    if frame.corner == (0.0, 0.0):
        return program
    return replace(
        program,
        burns=tuple(replace(burn, path=burn.path.moved(*frame.corner)) for burn in program.burns),
        rapids=tuple((line, frame.on_drawing(at)) for line, at in program.rapids),
        end=frame.on_drawing(program.end),
    )


# A whole old program: what it does, and what each line changes, so that its burns can be put in another order.


@dataclass(frozen=True, slots=True)
class Trusted:
    """Words that leave something to the machine are taken: `feed_mm_min` is the feed of its material, where known."""

    feed_mm_min: float | None = None


@dataclass(frozen=True, eq=False, slots=True)
class OldProgram:
    """What a program does, line by line, in its own coordinates.

    `kerfs_mm` are those of the materials that it describes. `fed_by` are the lines where a feed was needed that the
    program does not say. `begin` is where it finds the torch.
    """

    program: NcProgram
    lines: tuple[LineEffect, ...]
    kerfs_mm: tuple[float, ...]
    fed_by: tuple[int, ...]
    text: str = field(repr=False, default="")
    begin: Point = (0.0, 0.0)
    source: str = field(repr=False, default="")
    notes: tuple[str, ...] = ()

    @property
    def newline(self) -> str:
        """How its lines end."""
        return "\r\n" if "\r\n" in self.source else "\n"


def read_old(
    text: str,
    control: Control = QTPLASMAC,
    feed_mm_min: float | None = None,
    setup: Setup = AS_IT_COMES,
    file: str = "",
) -> OldProgram:
    """Read a program that somebody else wrote; `feed_mm_min` is what the machine's material has for a feed.

    Raises InputError with line and column, as `read_nc` does; and for a torch that is on in a rapid, or units that
    nobody states.

    Examples
    --------
    >>> text = "G21\\nG0 X5 Y5\\nF#<_hal[plasmac.cut-feed-rate]>\\nM3 $0 S1\\nG1 X15\\nM5 $0\\nM2\\n"
    >>> old = read_old(text, feed_mm_min=600)
    >>> old.program.burns[0].feeds_mm_s, [row.line for row in old.lines if row.travels]
    ((10.0,), [2])
    """
    expect_words_for(setup.torches, control, file)
    if control.arcs:
        steps: list[LineEffect] = []
        program = read_essi(text, control, setup, file, steps)
        _expect_cold_rapids(program, file)
        return OldProgram(program, tuple(steps), (), (), text, setup.home, text)
    with in_file(file):
        rows = unfold(text, control.filtered) if needs_unfolding(text) else None
    source, text = text, text if rows is None else "\n".join([*(row.text for row in rows), ""])
    further = OldWords(control, feed_mm_min)
    machine = Machine(control, setup, further)
    with in_file(file), at_lines_of(rows):
        try:
            traced = list(_traced(text, machine, further, control))
        except InputError as error:
            raise told_together(error, text, control, [row.line for row in rows or ()]) from None
        machine.expect_end()
        if machine.track.open is not None:
            raise InputError(
                "the program ends with the torch on, and nobody can be sure where it should have gone out; put it out",
                line=machine.line or None,
            )
        program = machine.done()
        _expect_cold_rapids(program, file)
    program = replace(program, burns=tuple(map(parted_where_leads_cross, program.burns)))
    if further.kept_kerf and control.kerf_mm is not None:
        raise InputError(
            "the dialect has its control add the kerf, from a run-up on: another order would need other run-ups, and "
            "is not made here; plan the nest again, or read the program by a dialect without kerf",
            file=file or None,
        )
    kerfs, notes = tuple(sorted(further.kerfs_mm)), tuple(_notes(further, rows))
    return OldProgram(program, tuple(traced), kerfs, tuple(further.used), text, setup.home, source, notes)


def _traced(text: str, machine: Machine, further: OldWords, control: Control) -> Iterator[LineEffect]:
    """Run the program, and say of each line what it does."""
    for block in blocks(text, machine):
        idle_mm, at, waited_s = machine.track.idle_mm, machine.track.at, machine.track.wait_s
        modal, further.lit = machine.moves.motion, machine.track.open is not None
        machine.run(block)
        further.lit = machine.track.open is not None
        _note(block, further, control)
        if machine.track.at != at:
            _expect_units(block, further.state, control)
        travels = machine.track.idle_mm > idle_mm or _names_place(block, machine)
        yield LineEffect(
            block.line,
            len(machine.track.burns),
            travels,
            machine.track.wait_s > waited_s,
            any(word.value in HALTS for word in block.m),
            dict(further.state),
            _travel_word(block, machine) if travels else "",
            _implied(block, modal, control),
            block.has_g(*MOTION),
            block.line in (further.carried, machine.own_line),
        )


def _notes(further: OldWords, rows: Sequence[UnfoldedRow] | None) -> Iterator[str]:
    """What a reader of the program should know of it."""
    if rows is not None:
        yield (
            f"its parameters and loops are worked out: it is {len(rows)} plain lines, and lines are told by their "
            "place in these"
        )
    if further.kept_kerf:
        yield (
            "the control adds the kerf (G41, G42): the paths are those that the program names, and rules are judged as "
            "if the kerf had no width"
        )
    if further.header:
        line, code = further.header[0]
        more = f", and {len(further.header) - 1} more" if len(further.header) > 1 else ""
        yield f"line {line}: {code} is not known here, and stays at the program's top{more}"


def _travel_word(block: Block, machine: Machine) -> str:
    """The word by which a block travels, said or in force; by an arc it does so no second time."""
    spelt = next((word.text for word in block.g if word.value in (0.0, 1.0)), "")
    return spelt or _implied(block, machine.moves.motion, machine.control)


def _implied(block: Block, modal: float | None, control: Control) -> str:
    """The motion word that a block moves by, where it leans on one in force."""
    if control.bare or modal is None or block.has_g(*MOTION, DWELL, NO_MOTION):
        return ""
    return f"G{modal:g}" if any(letter in block.words for letter in "XYIJR") else ""


def _names_place(block: Block, machine: Machine) -> bool:
    """Whether it names a place for the torch, off, to go to, though it may be there already."""
    named = any(letter in block.words for letter in "XY")
    return named and machine.track.open is None and not block.has_g(DWELL)


def _expect_units(block: Block, state: State, control: Control) -> None:
    """Refuse to guess what a number of the first move counts."""
    if control.known_g & {20.0, 21.0, 70.0, 71.0} and "units" not in state:
        raise block.refused(
            "it moves before it has said its units (G21 for mm, G20 for inches), and nobody can be sure of them; "
            "write them at its top"
        )


def _note(block: Block, further: OldWords, control: Control) -> None:
    """Keep note of what the words of a block have set."""
    state = further.state
    for word in block.g:
        if word.value not in MOTION | UNCHANGING | {DWELL, NO_MOTION}:
            with_it = "PQ" if word.value == ROUNDING else ""
            state[group_of(word)] = (_with(word, block, with_it),)
    for word in block.m:
        switches = word.value in control.starts or word.value in control.stops
        group = group_of(word)
        if group not in ("stops", "outputs") and not switches and (group != "torch" or control.beam):
            state[_set_by(word, block, control)] = (_with(word, block, _BESIDE.get(group, "")),)
    feed = block.words.get("F")
    waits = control.dwell == "F" and block.has_g(DWELL)
    if feed is not None and not waits and further.fed != block.line:
        state["F"] = (feed.text,)
    if control.beam and "S" in block.words:
        state["power"] = (block.words["S"].text,)


_BESIDE = {"overrides": "P", "process": "T", "stations": "T"}
"""Letters of numbers that belong to M words of a group."""


def _set_by(word: Word, block: Block, control: Control) -> str:
    """What an M word sets: those that undo each other set the same."""
    group = group_of(word)
    if group == "stations":
        return f"station {block.of(control.torch_letter):g}"
    if word.value in (14.0, 15.0) or (word.value in (50.0, 51.0) and "P" not in block.words):
        return "height"
    return f"override {max(word.value, 49.0):g}" if group == "overrides" else group


def _with(word: Word, block: Block, letters: str) -> str:
    return " ".join((word.text, *(block.words[letter].text for letter in letters if letter in block.words)))


def _expect_cold_rapids(program: NcProgram, file: str) -> None:
    if program.hot_rapids:
        raise InputError(
            "a rapid with the torch on: nobody can be sure what it cuts; post the program without",
            file=file or None,
            line=program.hot_rapids[0].line,
        )


# All words of an old program that nobody here knows, each with its line, its count, and what would settle it.

_TOKEN = re.compile(r"(?P<letter>[A-Z$#@^=])(?P<number>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))?")
_MOST_NAMED = 6


@dataclass(slots=True)
class UnknownWord:
    """A word, the line where it stands first, how often it stands, and what to do about it."""

    word: str
    line: int
    settles: str
    count: int = 1

    def __str__(self) -> str:
        times = "once" if self.count == 1 else f"{self.count} times"
        return f"line {self.line}: {self.word} ({times}): {self.settles}"


def unknown_words(text: str, control: Control) -> list[UnknownWord]:
    """The words of a program that are not known for a control, in the order in which they come first."""
    found: dict[str, UnknownWord] = {}
    machine, further = Machine(control, AS_IT_COMES), OldWords(control, 1000.0)
    for line, raw in rows_of(text, control.longest, control.obeyed):
        for word, settles in _of_row(raw, line, control, machine, further):
            if word in found:
                found[word].count += 1
            else:
                found[word] = UnknownWord(word, line, settles)
    return list(found.values())


def _of_row(raw: str, line: int, control: Control, machine: Machine, further: OldWords) -> Sequence[tuple[str, str]]:
    try:
        row = comment_of_form(raw, control) or row_of(raw, line, control.opens)
        row = machine.without_own(row, line) if control.has_own_words else row
    except InputError:
        return []
    before = row
    try:
        row = further.plain(row, line, machine.moves)
    except InputError:
        row = before
    return [] if row.code == "%" else _words(row, control)


def _words(row: Row, control: Control) -> list[tuple[str, str]]:
    """The unknown words of a row, and what settles each."""
    pairs = []
    code = re.sub(r"^N[0-9.]+", "", row.code.replace(COMMENT, ""))
    for found in _TOKEN.finditer(code):
        letter, number = found["letter"], found["number"]
        if letter in "GM":
            value = float(number or -1)
            known = control.known_g if letter == "G" else control.known_m
            if value in known:
                continue
            why = refused_g(value) if letter == "G" else control.refused_m.get(value)
            pairs.append((found[0], why or _advice(found[0])))
        elif letter not in BOUNDS and letter != "N":
            pairs.append((f"{letter}…", NOT_READ.get(letter) or _advice(f"{letter}{{n}}")))
    return pairs


def _advice(word: str) -> str:
    return (
        f"if it touches neither the path nor the torch, name it in the dialect, also: ['{word}']; if it is the "
        f"control's own word for one that is known, reads: {{means: {{{word}: …}}}}; else post the program without"
    )


def told_together(error: InputError, text: str, control: Control, lines: Sequence[int]) -> InputError:
    """The error that a program is refused with; one of an unknown word tells all that are.

    `lines` are those of the program that the rows of `text` stand for, none where they are the same.
    """
    try:
        words = unknown_words(text, control)
    except InputError:
        return error
    if error.line not in [word.line for word in words]:
        return error
    for word in words:
        word.line = lines[word.line - 1] if lines else word.line
    names = ", ".join(word.word for word in words[:_MOST_NAMED]) + (", …" if len(words) > _MOST_NAMED else "")
    times = sum(word.count for word in words)
    what = "1 word is" if len(words) == 1 else f"{len(words)} words are"
    message = (
        f"{what} not known in a program for {control.title}, the control of the profile's dialect, and not supported "
        f"here ({names}; {times} in all): {error.message}"
    )
    details = tuple(map(str, words)) if len(words) > 1 else ()
    return InputError(message, file=error.file, line=error.line, column=error.column, details=details)
