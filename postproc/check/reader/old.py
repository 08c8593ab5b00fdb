"""A whole old program: what it does, and what each line changes, so that its burns can be put in another order."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point

from .controls import QTPLASMAC, Control
from .essi import read_essi
from .grammar import DWELL, MOTION, NO_MOTION, ROUNDING, UNCHANGING, group_of
from .old_words import OldWords
from .program import NcProgram
from .reader import Machine, blocks, expect_words_for
from .rows import in_file
from .tools_on import HALTS
from .traced import State, Traced
from .words import Block, Word


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
    lines: tuple[Traced, ...]
    kerfs_mm: tuple[float, ...]
    fed_by: tuple[int, ...]
    text: str = field(repr=False, default="")
    begin: Point = (0.0, 0.0)


def read_old(
    text: str,
    control: Control = QTPLASMAC,
    feed_mm_min: float | None = None,
    travel_mm_s: float = 100.0,
    file: str = "",
    home: Point = (0.0, 0.0),
    held_s: tuple[float, float] = (0.0, 0.0),
    tab_mm: float = 0.0,
    torches: int = 1,
) -> OldProgram:
    """Read a program that somebody else wrote; `feed_mm_min` is what the machine's material has for a feed.

    `tab_mm` and `torches` are as for `read_nc`.

    Raises
    ------
    InputError
        With line and column, as `read_nc` does; and for a torch that is on in a rapid, or units that nobody states.

    Examples
    --------
    >>> text = "G21\\nG0 X5 Y5\\nF#<_hal[plasmac.cut-feed-rate]>\\nM3 $0 S1\\nG1 X15\\nM5 $0\\nM2\\n"
    >>> old = read_old(text, feed_mm_min=600)
    >>> old.program.burns[0].feeds_mm_s, [row.line for row in old.lines if row.travels]
    ((10.0,), [2])
    """
    expect_words_for(torches, control, file)
    if control.arcs:
        steps: list[Traced] = []
        program = read_essi(text, travel_mm_s, file, home, control, held_s, steps)
        _expect_cold_rapids(program, file)
        return OldProgram(program, tuple(steps), (), (), text, home)
    further = OldWords(control.filtered, feed_mm_min)
    machine = Machine(travel_mm_s, control, held_s, home, tab_mm, further, torches)
    traced: list[Traced] = []
    with in_file(file):
        for block in blocks(text, machine):
            idle_mm, at, waited_s = machine.track.idle_mm, machine.track.at, machine.track.wait_s
            machine.run(block)
            _note(block, further, control)
            if machine.track.at != at:
                _expect_units(block, further.state, control)
            travels = machine.track.idle_mm > idle_mm or _names_place(block, machine)
            traced.append(
                Traced(
                    block.line,
                    len(machine.track.burns),
                    travels,
                    machine.track.wait_s > waited_s,
                    any(word.value in HALTS for word in block.m),
                    dict(further.state),
                    next((word.text for word in block.g if word.value == 0.0), ""),
                )
            )
        machine.expect_end()
        if machine.track.open is not None:
            raise InputError(
                "the program ends with the torch on, and nobody can be sure where it should have gone out; put it out",
                line=machine.line or None,
            )
        program = machine.done()
        _expect_cold_rapids(program, file)
    return OldProgram(program, tuple(traced), tuple(sorted(further.kerfs_mm)), tuple(further.used), text, home)


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
            state[_set_by(word, block)] = (_with(word, block, "P" if group == "overrides" else ""),)
    feed = block.words.get("F")
    waits = control.dwell == "F" and block.has_g(DWELL)
    if feed is not None and not waits and further.fed != block.line:
        state["F"] = (feed.text,)
    if control.beam and "S" in block.words:
        state["power"] = (block.words["S"].text,)


def _set_by(word: Word, block: Block) -> str:
    """What an M word sets: those that undo each other set the same."""
    group = group_of(word)
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
